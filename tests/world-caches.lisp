;;;; world-caches.lisp -- the files in which built maps are kept.

(in-package :ars-magna.tests)

(in-suite world)

(defun cache-file () (base:path-of-name (format nil "~Aars-magna-tests/[world]*cache"
                                                 (uiop:temporary-directory))))

(defun cached-map (&rest clauses)
  (eval `(world:defmap cached-map (20 20 :cache ,(cache-file)) ,@clauses))
  (world:find-map 'cached-map))

(defun grid-of (map)
  (list (world:map-flags map) (world:map-parameters map) (world:map-substances map)
        (world:map-substance-types map) (world:map-places map) (world:map-directions map)
        (world:map-least-parameter map) (world:map-greatest-parameter map)))

(defmacro with-fresh-cache (&body body)
  `(with-own-definitions
     (flet ((clean () (when (probe-file (cache-file)) (delete-file (cache-file)))))
       (clean)
       (unwind-protect (progn ,@body) (clean)))))

(defparameter *cached-clauses*
  '((rect (0 0) (20 20) bricks -1 10 30 25) (wall (5 5) (5 15) slate 3) (wall (5 5) (9 5) wood 4)))

(test cache.restores-the-grid-and-not-by-building
  (with-fresh-cache
    (let ((built (grid-of (apply #'cached-map *cached-clauses*))))
      (is (probe-file (cache-file)))
      (let* ((map (world::%make-map :name 'cached-map :width 20 :height 20
                                    :clauses *cached-clauses*))
             (key (world::cache-key map)))
        (is (world::restore-from-cache map (cache-file) key))
        (is (equalp built (grid-of map))))
      (is (equalp built (grid-of (apply #'cached-map *cached-clauses*))))
      (is (null (message-texts))))))

(test cache.is-rebuilt-with-a-warning-when-stale
  (with-fresh-cache
    (apply #'cached-map *cached-clauses*)
    (let ((map (cached-map '(wall (1 1) (2 2) bricks 1))))
      (is (= 2 (count 1 (world:map-flags map))))
      (is (search "is stale" (first (message-texts)))))
    (cached-map '(wall (1 1) (2 2) bricks 1))
    (is (null (message-texts)) "the file was rewritten")
    (eval '(world:def-place-type nook (cell) :check-matchers ((((*)) 0))))
    (cached-map '(wall (1 1) (2 2) bricks 1))
    (is (search "is stale" (first (message-texts))) "place types count too")))

(test cache.is-stale-when-what-clauses-stand-for-changes
  (with-fresh-cache
    (flet ((define-post (x)
             (eval `(world:define-map-clause post (map y) "(post y)"
                     :clauses (list (list 'wall (list ,x y) (list ,x y) 'bricks 1))))))
      (define-post 3)
      (let ((built (grid-of (cached-map '(post 4)))))
        (is (equalp built (grid-of (cached-map '(post 4)))))
        (is (null (message-texts)) "it was kept, and read")
        (define-post 5)
        (is (world:wall-at-p (cached-map '(post 4)) 5 4))
        (is (search "is stale" (first (message-texts))))))))

(defun damage-cache (position byte)
  (with-open-file (file (cache-file) :direction :io :if-exists :overwrite
                                     :element-type '(unsigned-byte 8))
    (file-position file position)
    (write-byte byte file)))

(test cache.is-not-read-when-it-is-too-large
  (with-fresh-cache
    (apply #'cached-map *cached-clauses*)
    (damage-cache (expt 2 36) 1)        ; 64 GB of which next to nothing is on the disk
    (apply #'cached-map *cached-clauses*)
    (is (search "is damaged" (first (message-texts))))
    (apply #'cached-map *cached-clauses*)
    (is (null (message-texts)) "the file was rewritten")))

(test cache.is-rebuilt-with-a-warning-when-damaged
  (with-fresh-cache
    (let ((built (grid-of (apply #'cached-map *cached-clauses*))))
      (loop for position in '(17 33 40 100 300)
            do (damage-cache position 99)
               (is (equalp built (grid-of (apply #'cached-map *cached-clauses*))))
               (is (search "is damaged" (first (message-texts))) "byte ~D" position))
      (loop for size in '(0 8 104)
            do (let ((octets (with-open-file (in (cache-file) :element-type '(unsigned-byte 8))
                               (let ((v (make-array size :element-type '(unsigned-byte 8))))
                                 (read-sequence v in)
                                 v))))
                 (with-open-file (out (cache-file) :direction :output :if-exists :supersede
                                                   :element-type '(unsigned-byte 8))
                   (write-sequence octets out)))
               (is (equalp built (grid-of (apply #'cached-map *cached-clauses*))))
               (is (search "is damaged" (first (message-texts))) "~D bytes" size)))))

(test cache.leaves-files-alone-that-are-write-protected
  (with-fresh-cache
    (let ((built (grid-of (apply #'cached-map *cached-clauses*))))
      (damage-cache 40 99)
      (let ((octets (cache-octets)))
        (sb-posix:chmod (cache-file) #o444)
        (is (equalp built (grid-of (apply #'cached-map *cached-clauses*))))
        (is (search "cannot be written: it is write-protected"
                    (format nil "~{~A~}" (message-texts))))
        (is (equalp octets (cache-octets)))
        (sb-posix:chmod (cache-file) #o644)))))

(test cache.leaves-files-alone-that-are-none
  (with-fresh-cache
    (with-open-file (out (ensure-directories-exist (cache-file)) :direction :output)
      (write-string "Chapter one of a thesis." out))
    (let ((built (grid-of (apply #'cached-map *cached-clauses*))))
      (is (search " is no map cache" (first (message-texts))))
      (is (string= "Chapter one of a thesis." (base:read-file-into-string (cache-file))))
      (is (equalp built (grid-of (apply #'cached-map *cached-clauses*))))))
  (with-own-definitions
    (dolist (name '("/tmp/"))
      (eval `(world:defmap test-map (3 3 :cache ,name)))
      (is (search " is no map cache" (first (message-texts))) "~A" name))))

(test cache.leaves-short-files-alone-too
  (with-fresh-cache
    (loop for length from 1 to 7
          for octets = (make-array length :element-type '(unsigned-byte 8) :initial-element 65)
          do (ensure-directories-exist (cache-file))
             (write-octets octets)
             (apply #'cached-map *cached-clauses*)
             (is (equalp octets (cache-octets)) "~D" length)
             (base:take-messages))))

(test cache.is-stale-when-a-direction-has-another-value
  (with-own-definitions
    (with-fresh-cache
      (flet ((direction (value)
               (eval `(world:def-place-type cranny (cell)
                        :before t
                        :check-matchers ((((x x x) (x - x) (x x x)) ,value))))
               (let ((map (cached-map '(rect (0 0) (8 8) bricks 1)
                                      '(rect (3 3) (5 5) bricks 4))))
                 (aref (world:map-directions map)
                       (world:map-index map 4.5 4.5)))))
        (is (= 0 (direction 0)))
        (is (= 1.5 (direction '(progn 1.5))))
        (is (= 2 (direction '(+ 1 1))))
        (is (= 3 (direction '(let ((x 3)) x))))))))

(defun cache-octets ()
  (coerce (with-open-file (in (cache-file) :element-type '(unsigned-byte 8))
            (loop for octet = (read-byte in nil) while octet collect octet))
          '(simple-array (unsigned-byte 8) (*))))

(defun write-octets (octets &optional (path (cache-file)))
  (with-open-file (out path :direction :output :if-exists :supersede
                            :element-type '(unsigned-byte 8))
    (write-sequence octets out)))

(defun cache-directory () (uiop:pathname-directory-pathname (cache-file)))

(test cache.header-counts-word-by-word
  (with-fresh-cache
    (let ((built (grid-of (apply #'cached-map *cached-clauses*))) (octets (cache-octets)))
      (loop for word below world::+cache-header-size+
            for damaged = (copy-seq octets)
            do (setf (aref damaged (* 8 word)) (logxor 1 (aref damaged (* 8 word))))
               (write-octets damaged)
               (is (equalp built (grid-of (apply #'cached-map *cached-clauses*))) "word ~D" word)
               (is (= 1 (length (message-texts))) "word ~D" word)
               (is (equalp (if (zerop word) damaged octets) (cache-octets)) "word ~D" word)))))

(test cache.is-rebuilt-when-cut-anywhere
  (with-fresh-cache
    (let ((built (grid-of (apply #'cached-map *cached-clauses*))) (octets (cache-octets)))
      (loop for size from 8 below (length octets) by 57
            do (write-octets (subseq octets 0 size))
               (is (equalp built (grid-of (apply #'cached-map *cached-clauses*))) "~D" size)
               (is (search "is damaged" (first (message-texts))) "~D" size)
               (is (equalp octets (cache-octets)) "~D" size)))))

(test cache.is-not-used-with-a-checker
  "A checker is code, which may look at anything."
  (with-fresh-cache
    (apply #'cached-map *cached-clauses*)
    (let ((octets (cache-octets)) (calls 0))
      (world:define-place-type 'tried :checker (lambda (cell)
                                                 (declare (ignore cell))
                                                 (incf calls)
                                                 nil))
      (dotimes (time 2)
        (setf calls 0)
        (apply #'cached-map *cached-clauses*)
        (is (= 400 calls)))
      (is (null (message-texts)))
      (is (equalp octets (cache-octets)) "nor is it written"))))

(test cache.is-not-written-when-code-of-a-place-type-fails
  (with-fresh-cache
    (let ((fails nil))
      (world:define-place-type 'frail :directions (lambda (cell)
                                                    (declare (ignore cell))
                                                    (if fails (error "frail") (values 0 1)))
                                      :rules (list (world::make-rule '((nil)) 0d0 0 0)))
      (setf fails t)
      (warnings-of (lambda () (apply #'cached-map *cached-clauses*)))
      (is (null (probe-file (cache-file)))))))

(defun link-cache (target)
  "Let the cache file be a symbolic link to TARGET."
  (sb-posix:symlink (uiop:native-namestring target) (uiop:native-namestring (cache-file))))

(test cache.is-not-written-through-links
  (with-fresh-cache
    (let ((thesis (merge-pathnames "thesis" (ensure-directories-exist (cache-directory))))
          (new (uiop:parse-native-namestring
                (format nil "~A.new" (uiop:native-namestring (cache-file))))))
      (flet ((unharmed-p ()
               (string= "Chapter one." (base:read-file-into-string thesis))))
        (with-open-file (out thesis :direction :output :if-exists :supersede)
          (write-string "Chapter one." out))
        (unwind-protect
             (progn
               (sb-posix:symlink (uiop:native-namestring thesis) (uiop:native-namestring new))
               (apply #'cached-map *cached-clauses*)
               (is-true (probe-file (cache-file)))
               (is-true (unharmed-p) "by the name of an unfinished cache")
               (delete-file (cache-file))
               (link-cache thesis)
               (apply #'cached-map *cached-clauses*)
               (is (search " is no map cache" (first (message-texts))))
               (is-true (unharmed-p) "by the name of the cache"))
          (sb-posix:unlink (uiop:native-namestring (cache-file)))
          (sb-posix:unlink (uiop:native-namestring new))
          (delete-file thesis))))
    (is (notany (lambda (file) (search "ars-magna" (file-namestring file)))
                (uiop:directory-files (cache-directory)))
        "nothing is left behind")))

(test cache.leaves-a-directory-alone
  (with-own-definitions
    (let ((name (uiop:native-namestring (cache-file))))
      (ensure-directories-exist (cache-file))
      (sb-posix:mkdir name #o700)
      (unwind-protect
           (let ((map (apply #'cached-map *cached-clauses*)))
             (is (search " is no map cache" (first (message-texts))))
             (is (= 20 (world:map-width map)))
             (is-true (uiop:directory-exists-p (cache-file))))
        (sb-posix:rmdir name)))))

(test cache.that-cannot-be-written-is-no-error
  (with-own-definitions
    (eval '(world:defmap test-map (3 3 :cache "/dev/null/nowhere/file")))
    (let ((messages (message-texts)))
      (is (some (lambda (text) (search "cannot be written" text)) messages) "~A" messages))
    (is (= 3 (world:map-width (world:find-map 'test-map))))))

(test cache.tilde-is-home
  (is (equal (namestring (merge-pathnames "cache/x" (user-homedir-pathname)))
             (namestring (base:path-of-name "~/cache/x")))))

(defun call-with-map-file (function)
  "Call FUNCTION with a file that has a map with the cache cellar.map, and with the name of that."
  (let ((file (base:path-of-name (format nil "~Aars-magna-tests/[maps]/cellar.lisp"
                                         (uiop:temporary-directory)))))
    (ensure-directories-exist file)
    (unwind-protect
         (progn (rewrite file "(world:defmap cellar (9 9 :cache \"cellar.map\"))")
                (funcall function file (make-pathname :type "map" :defaults file)))
      (mapc #'delete-file (uiop:directory-files (uiop:pathname-directory-pathname file))))))

(test cache.is-beside-the-file-of-its-map
  "Wherever Lisp happens to be."
  (with-own-definitions
    (call-with-map-file
     (lambda (file cache)
       (load-here file)
       (is-true (probe-file cache))
       (delete-file cache)
       (world:rebuild-map 'cellar)
       (is-true (probe-file cache) "also when it is built again")))))

(test cache.of-a-map-that-was-typed-is-where-lisp-is
  (with-own-definitions
    (call-with-map-file
     (lambda (file cache)
       (uiop:with-current-directory ((uiop:pathname-directory-pathname file))
         (eval '(world:defmap cellar (9 9 :cache "cellar.map"))))
       (is-true (probe-file cache))))))
