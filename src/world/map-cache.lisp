;;;; map-cache.lisp -- keeping a built grid in a file (manual 5.1).

(in-package :ars-magna.world)

;;; The file is a row of 64-bit words: magic, key, count of walls, count of places, sum; then
;;; for each wall (index + substance * 2^32, parameter) and for each place (index + type * 2^32,
;;; direction), floats as their bits. The key stands for the map's size and clauses and for the
;;; definitions of all place types. A file with another key is stale, one whose words do not
;;; add up is damaged; neither is ever used. Only the grid is kept, never things. A file that is
;;; no cache, by its first word, or that is no file of bytes, is never written to.

(define-constant +cache-magic+ #x4152534D41503031
  :documentation "ARSMAP01 in ASCII; changes when the file's layout does.")
(define-constant +cache-header+ 5 :documentation "How many words come before the cells.")

(deftype words () '(simple-array (unsigned-byte 64) (*)))

(defun cache-key (map)
  "Return the 64-bit key of MAP's grid."
  (digest-value
   (digest-add (make-digest)
               (list (map-width map) (map-height map) (map-clauses map)
                     (loop for type in (registry-objects *place-types*)
                           collect (list (place-type-name type) (place-type-key type)))))))

(defun double-bits (number)
  (logior (ash (ldb (byte 32 0) (sb-kernel:double-float-high-bits number)) 32)
          (sb-kernel:double-float-low-bits number)))

(defun bits-double (bits)
  (let ((high (ldb (byte 32 32) bits)))
    (sb-kernel:make-double-float (if (logbitp 31 high) (- high (ash 1 32)) high)
                                 (ldb (byte 32 0) bits))))

(defun words-sum (words)
  "Return a check sum of WORDS behind the header."
  (declare (type words words))
  (let ((sum 1))
    (declare (type (unsigned-byte 64) sum))
    (loop for index from +cache-header+ below (length words)
          do (setf sum (ldb (byte 64 0) (+ (* sum #x100000001B3) (aref words index)))))
    sum))

;;; Writing.

(defun count-cells (numbers) (count-if #'plusp numbers))

(defun map-words (map key)
  "Return the words that stand for the grid of MAP."
  (let* ((walls (count-cells (map-flags map))) (places (count-cells (map-places map)))
         (words (make-array (+ +cache-header+ (* 2 (+ walls places)))
                            :element-type '(unsigned-byte 64)))
         (position +cache-header+))
    (flet ((add (number index value)
             (setf (aref words position) (logior index (ash number 32))
                   (aref words (1+ position)) (double-bits value))
             (incf position 2)))
      (loop for number across (map-substances map) for index from 0
            when (plusp number) do (add number index (aref (map-parameters map) index)))
      (loop for number across (map-places map) for index from 0
            when (plusp number) do (add number index (aref (map-directions map) index))))
    (replace words (list +cache-magic+ key walls places (words-sum words)))))

(defun write-words (words path)
  "Write WORDS to the file PATH, which is whole at every moment."
  (let ((temporary (sb-ext:parse-native-namestring
                    (format nil "~A.new" (sb-ext:native-namestring path)))))
    (ensure-directories-exist path)
    (with-open-file (out temporary :direction :output :if-exists :supersede
                                   :element-type '(unsigned-byte 64))
      (write-sequence words out))
    (sb-unix:unix-rename (sb-ext:native-namestring temporary)
                         (sb-ext:native-namestring path))))

;;; Reading.

(defun read-words (path)
  "Return the words of the file PATH, or NIL if there is no such file."
  (with-open-file (in path :element-type '(unsigned-byte 64) :if-does-not-exist nil)
    (when in
      (let ((words (make-array (file-length in) :element-type '(unsigned-byte 64))))
        (read-sequence words in)
        words))))

(defun words-trouble (words key)
  "Return what is wrong with WORDS as a cache with KEY, a string, or NIL if nothing is."
  (cond ((or (< (length words) +cache-header+) (/= (aref words 0) +cache-magic+)) "is damaged")
        ((/= (aref words 1) key) "is stale")
        ((or (/= (length words) (+ +cache-header+ (* 2 (+ (aref words 2) (aref words 3)))))
             (/= (aref words 4) (words-sum words)))
         "is damaged")))

(defun restore-map (map words)
  "Fill the empty grid of MAP from WORDS."
  (clear-walls map)
  (clear-places map)
  (let ((walls-end (+ +cache-header+ (* 2 (aref words 2)))))
    (loop for position from +cache-header+ below (length words) by 2
          for index = (ldb (byte 32 0) (aref words position))
          for number = (ldb (byte 32 32) (aref words position))
          for value = (bits-double (aref words (1+ position)))
          do (if (< position walls-end)
                 (setf (aref (map-flags map) index) +wall+
                       (aref (map-substances map) index) number
                       (aref (map-parameters map) index) value)
                 (setf (aref (map-places map) index) number
                       (aref (map-directions map) index) value))))
  (note-parameter-range map)
  map)

(defun regular-file-p (path)
  "True if PATH is a file of bytes: no directory, device or pipe."
  (= sb-posix:s-ifreg
     (logand sb-posix:s-ifmt
             (sb-posix:stat-mode (sb-posix:stat (sb-ext:native-namestring path))))))

(defun begins-as-cache-p (path)
  "True if the file PATH is empty or begins as caches do."
  (let ((words (make-array 1 :element-type '(unsigned-byte 64))))
    (with-open-file (in path :element-type '(unsigned-byte 64))
      (or (zerop (file-length in))
          (and (= 1 (read-sequence words in))
               (= +cache-magic+ (aref words 0)))))))

(defun foreign-p (path)
  "True if there is something at PATH that is not a map's cache, whole or damaged."
  (and (or (probe-file path) (uiop:directory-exists-p path))
       (not (and (regular-file-p path) (begins-as-cache-p path)))))

(defun cache-path (name)
  "Return the file that NAME, a string or pathname, stands for; ~/ is the home directory."
  (cond ((pathnamep name) name)
        ((starts-with-subseq "~/" name)
         (merge-pathnames (sb-ext:parse-native-namestring (subseq name 2))
                          (user-homedir-pathname)))
        (t (sb-ext:parse-native-namestring name))))

(defun warn-of-cache (map path what)
  (warning-set "The cache " (sb-ext:native-namestring path) " of map " (map-name map) " " what
               "; the map is built anew."))

(defun restore-from-cache (map path key)
  "Fill MAP from the file PATH; true if that could be done."
  (handler-case
      (let ((words (read-words path)))
        (when words
          (let ((trouble (words-trouble words key)))
            (if trouble
                (warn-of-cache map path trouble)
                (restore-map map words)))))
    (error (condition)
      (warn-of-cache map path (format nil "cannot be read (~A)" condition))
      nil)))

(defun write-cache (map path key)
  (handler-case (write-words (map-words map key) path)
    (error (condition)
      (warning-set "The cache " (sb-ext:native-namestring path) " of map " (map-name map)
                   " cannot be written: " (princ-to-string condition)))))

(defun usable-cache-path (map)
  "Return the file that MAP is to be kept in, if any; not one that holds something else."
  (let ((path (and (map-cache map) (cache-path (map-cache map)))))
    (cond ((null path) nil)
          ((handler-case (foreign-p path) (error () nil))
           (warning-set "The file " (sb-ext:native-namestring path)
                        " is no cache of a map; it is left as it is, and " (map-name map)
                        " is not kept. Give :cache another name.")
           nil)
          (t (or (probe-file path) path)))))
