;;;; world.lisp -- maps: walls, clauses and their errors, caches.

(in-package :ars-magna.tests)

(def-suite* world :in ars-magna)

;;; The place types as shipped come back after a test that defines others.

(defun call-with-own-definitions (function)
  "Call FUNCTION; what it defines (maps, place types, attributes ...) is forgotten afterwards."
  (let ((base:*message-queue* (base:make-message-queue)))
    (base:call-with-own-definitions function)))

(defmacro with-own-definitions (&body body)
  `(call-with-own-definitions (lambda () ,@body)))

(defmacro with-only ((registry &rest names) &body body)
  "Run BODY where REGISTRY knows what is called NAMES, forms, and nothing else."
  `(base:with-own-definitions ()
     (base::set-entries
      ,registry
      (remove-if-not (lambda (definition)
                       (member (base:entry-name definition) (list ,@names)
                               :test #'base:same-name-p))
                     (base::registry-entries ,registry)))
     ,@body))

(defun map-of (width height &rest clauses)
  "Return a map with CLAUSES of walls."
  (eval `(world:defmap test-map (,width ,height) ,@clauses))
  (world:find-map 'test-map))

(defun wall-picture (map)
  "Return the walls of MAP as a list of strings."
  (loop for y below (world:map-height map)
        collect (coerce (loop for x below (world:map-width map)
                              collect (if (world:wall-at-p map x y) #\* #\-))
                        'string)))

(defun parameter-at (map x y) (world:cell-substance-parameter (world:map-cell map x y)))
(defun substance-at (map x y) (world:cell-substance-type (world:map-cell map x y)))

(defun complaint-about (form)
  "Return the text of the MALFORMED-DEFINITION that evaluating FORM signals, or NIL."
  (handler-case (with-own-definitions (eval form) nil)
    (base:malformed-definition (condition) (princ-to-string condition))))

(defun warnings-of (function)
  "Call FUNCTION; return the texts of the warnings about definitions that it signals."
  (let ((texts '()))
    (handler-bind ((base:definition-warning
                     (lambda (warning)
                       (push (princ-to-string warning) texts)
                       (muffle-warning warning))))
      (funcall function))
    (nreverse texts)))

(defun message-texts ()
  (mapcar #'base:message-text (base:take-messages)))

;;; Walls.

(test wall.is-bresenham-with-both-ends
  (with-own-definitions
    (is (equal '("*-----" "-**---" "---**-" "-----*")
               (wall-picture (map-of 6 4 '(wall (0 0) (5 3) bricks 1)))))
    (is (equal '("-----" "-*---" "-----")
               (wall-picture (map-of 5 3 '(wall (1 1) (1.9 1.5) bricks 1)))))))

(test wall.parameter-is-linear-in-steps
  (with-own-definitions
    (let ((map (map-of 9 3 '(wall (0 1) (8 1) slate 10 30))))
      (loop for x to 8
            do (is (= (+ 10 (* 2.5 x)) (parameter-at map x 1))))
      (is (base:same-name-p 'slate (substance-at map 3 1)))
      (is (null (substance-at map 3 0)))
      (is (= 0 (parameter-at map 3 0)))
      (is (= 10 (world:map-least-parameter map)))
      (is (= 30 (world:map-greatest-parameter map))))))

(test rect.is-an-outline-clamped-into-the-map
  "Manual 5.1: big-room's rect, whose corner lies outside, is its room."
  (with-own-definitions
    (let ((map (map-of 5 4 '(rect (0 0) (5 4) bricks 0 10 30 25))))
      (is (equal '("*****" "*---*" "*---*" "*****") (wall-picture map)))
      (is (equalp '(0 10 30 25)
                  (list (parameter-at map 0 0) (parameter-at map 4 0)
                        (parameter-at map 4 3) (parameter-at map 0 3))))
      (is (= 5 (parameter-at map 2 0)))
      (is (< 10 (parameter-at map 4 1) (parameter-at map 4 2) 30))
      (is (< 0 (parameter-at map 0 1) (parameter-at map 0 2) 25)))))

(test circle.is-a-closed-symmetric-outline
  (with-own-definitions
    (is (equal '("---------" "---***---" "--*---*--" "-*-----*-" "-*-----*-" "-*-----*-"
                 "--*---*--" "---***---" "---------")
               (wall-picture (map-of 9 9 '(circle (4 4) 3 bricks 7)))))
    (let ((map (map-of 9 9 '(circle (4.5 4.2) 0 bricks 7))))
      (is (= 1 (count 1 (world:map-flags map))))
      (is (= 7 (parameter-at map 4 4))))))

(test clauses.later-ones-overwrite
  (with-own-definitions
    (let ((map (map-of 5 5 '(wall (0 2) (4 2) bricks 1) '(wall (2 0) (2 4) slate 9))))
      (is (= 9 (parameter-at map 2 2)))
      (is (base:same-name-p 'slate (substance-at map 2 2)))
      (is (= 1 (parameter-at map 1 2))))))

(test map.is-solid-outside
  (with-own-definitions
    (let ((map (map-of 3 3)))
      (is (not (world:wall-at-p map 0 0)))
      (is (not (world:wall-at-p map 2.999 2.999)))
      (loop for (x y) in '((-0.001 1) (1 -5) (3 1) (1 3) (1e20 1))
            do (is (world:wall-at-p map x y))
               (is (null (world:map-index map x y))))
      (is (= 0 (parameter-at map -1 7))))))

(test occupancy-window.is-centred
  (with-own-definitions
    (let ((map (map-of 4 4 '(wall (2 1) (2 1) bricks 1))))
      (is (equal '((nil nil nil) (nil nil t) (nil nil nil))
                 (world:cell-occupancy-window (world:map-cell map 1.5 1.5) 3 3)))
      (is (equal '((t t t t t) (t t nil nil nil) (t t nil nil t))
                 (world:cell-occupancy-window (world:map-cell map 0 0) 5 3))))))

(test defmap.binds-and-registers
  (with-own-definitions
    (eval '(world:defmap test-place (4 5)))
    (let ((first (symbol-value 'test-place)))
      (is (eq first (world:find-map "test-place")))
      (is (eq first (world:find-map :test-place)))
      (eval '(world:defmap test-place (4 5) (wall (0 0) (1 1) bricks 1)))
      (is (not (eq first (world:find-map 'test-place))))
      (is (= 1 (count 'test-place (world:all-maps) :key #'world:map-name))))
    (signals base:unknown-name (world:find-map 'no-such-map))))

;;; Malformed clauses.

(test defmap.rejects-malformed-clauses
  "The complaint shows the clause and what was expected."
  (loop for (clause . expected)
          in '(((wall (0 0) (1 1)) . "(wall (x0 y0)")
               ((wall (0 0) (1 1) bricks) . "parameter")
               ((wall (0 0) (1 1) bricks 1 2 3) . "(wall (x0 y0)")
               ((wall (0 0) 1 bricks 1) . "(wall (x0 y0)")
               ((wall (0 a) (1 1) bricks 1) . "numbers")
               ((wall (0 0) (1 1) "bricks" 1) . "substance")
               ((rect (0 0) (1 1) bricks 1 2) . "(rect (x0 y0)")
               ((rect (0 0) (1 1) bricks 1 2 3 4 5) . "three parameters more")
               ((circle (0 0) bricks 1) . "(circle (x y)")
               ((circle (0 0) -1 bricks 1) . "radius not below 0")
               ((circle (0 0) 1 bricks 1 2) . "(circle (x y)")
               ((door (0 0)) . "wall, rect, circle or obj")
               (17 . "wall, rect, circle or obj")
               ((wall . 3) . "wall, rect, circle or obj")
               ((obj lamp) . "(obj name (x y) descriptor")
               ((obj lamp (1 2)) . "(obj name (x y) descriptor")
               ((obj lamp 1 ()) . "a position")
               ((obj lamp (4 1) ()) . "from 0 to below 4 and 4")
               ((obj lamp (-1 1) ()) . "in the map")
               ((obj "lamp" (1 1) ()) . "a name")
               ((obj (lamp :proto box) (1 1) ()) . ":prototype")
               ((obj (lamp :prototype) (1 1) ()) . "pairs")
               ((obj (lamp :kickers jump) (1 1) ()) . ":kickers (name ...)")
               ((obj (lamp :kickers (no-such-kicker)) (1 1) ()) . "no kicker called")
               ((obj (lamp :prototype 3) (1 1) ()) . "made by NEW-THING")
               ((obj lamp (1 1) (:size 2)) . "object descriptor")
               ((obj lamp (1 1) ((:size 2) (:size 3))) . "each attribute once")
               ((obj lamp (1 1) ((:size red))) . "a number")
               ((obj lamp (1 1) ((:size -1))) . "not below 0")
               ((obj lamp (1 1) ((:color purple))) . "red, green, blue")
               ((obj lamp (1 1) ((:obsview 7))) . "one of")
               ((obj lamp (1 1) ((:substance "wood"))) . "substance's name")
               ((obj lamp (1 1) () pen) . "contents: (name descriptor")
               ((obj lamp (1 1) () (pen)) . "contents: (name descriptor")
               ((obj lamp (1 1) () (pen ((:size big)))) . "a number"))
        for complaint = (complaint-about `(world:defmap test-map (4 4) ,clause))
        do (is (and complaint (search expected complaint)) "~S: ~A" clause complaint)
           (is (search "defmap test-map" complaint))))

(test defmap.rejects-malformed-heads
  (loop for (form . expected)
          in '(((world:defmap "room" (4 4)) . "a symbol")
               ((world:defmap nil (4 4)) . "a symbol")
               ((world:defmap test-map 4) . "(width height)")
               ((world:defmap test-map (4)) . "(width height)")
               ((world:defmap test-map (4 0)) . "integers from 1")
               ((world:defmap test-map (4 5.5)) . "integers from 1")
               ((world:defmap test-map (4 4 :cash "x")) . ":cache")
               ((world:defmap test-map (4 4 :cache)) . "pairs")
               ((world:defmap test-map (4 4 :cache 7)) . "a file"))
        for complaint = (complaint-about form)
        do (is (and complaint (search expected complaint)) "~S: ~A" form complaint)))

(test defmap.shows-the-clause
  (is (search "(wall (0 0) 1 bricks 1)"
              (complaint-about '(world:defmap test-map (4 4) (wall (0 0) 1 bricks 1))))))

;;; The cache.

(defun cache-file () (world::cache-path (format nil "~Aars-magna-tests/[world]*cache"
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

(defun damage-cache (position byte)
  (with-open-file (file (cache-file) :direction :io :if-exists :overwrite
                                     :element-type '(unsigned-byte 8))
    (file-position file position)
    (write-byte byte file)))

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

(test cache.leaves-files-alone-that-are-none
  (with-fresh-cache
    (with-open-file (out (ensure-directories-exist (cache-file)) :direction :output)
      (write-string "Chapter one of a thesis." out))
    (let ((built (grid-of (apply #'cached-map *cached-clauses*))))
      (is (search "is no cache" (first (message-texts))))
      (is (string= "Chapter one of a thesis." (base:read-file-into-string (cache-file))))
      (is (equalp built (grid-of (apply #'cached-map *cached-clauses*))))))
  (with-own-definitions
    (dolist (name '("/dev/null" "/tmp/"))
      (eval `(world:defmap test-map (3 3 :cache ,name)))
      (is (search "is no cache" (first (message-texts))) "~A" name))))

(test cache.that-cannot-be-written-is-no-error
  (with-own-definitions
    (eval '(world:defmap test-map (3 3 :cache "/dev/null/nowhere/file")))
    (let ((messages (message-texts)))
      (is (some (lambda (text) (search "cannot be written" text)) messages) "~A" messages))
    (is (= 3 (world:map-width (world:find-map 'test-map))))))

(test cache.tilde-is-home
  (is (equal (namestring (merge-pathnames "cache/x" (user-homedir-pathname)))
             (namestring (world::cache-path "~/cache/x")))))
