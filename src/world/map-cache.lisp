;;;; map-cache.lisp -- keeping a built grid in a file (manual 5.1).

(in-package :ars-magna.world)

;;; The file is a row of 64-bit words: magic, key, count of walls, count of places, sum; then for
;;; each wall (index + substance * 2^32, parameter) and for each place (index + type * 2^32,
;;; direction), floats as their bits. The key is computed from the map's size and clauses and the
;;; definitions of all place types. A file with another key is stale; one with a wrong sum is
;;; damaged. Neither is used. Only the grid is kept, never things, and nothing while a place type
;;; has a :checker, since that is arbitrary code. A file is never overwritten if its first word is
;;; not the magic one, if it is not a file of bytes, or if this cannot be determined.

(defconstant +cache-magic+ #x4152534D41503031
  "The first word of a cache, ARSMAP01 in ASCII, which changes with the layout of the file.")
(defconstant +cache-header-size+ 5 "How many words come before the cells.")

(deftype words () '(simple-array (unsigned-byte 64) (*)))

(defun cache-key (map)
  "Return a 64-bit digest of all that the grid of MAP depends on (reading 62)."
  (digest-value
   (digest-add (make-digest)
               (list (map-width map) (map-height map) (map-clauses map)
                     (loop for type in (registry-objects *place-types*)
                           collect (list (place-type-name type) (place-type-key type)
                                         (place-type-rules type)))))))

(defun words-checksum (words)
  "Return the check sum of WORDS without the first word and the header's last word, which holds it."
  (declare (type words words))
  (let ((sum 1))
    (declare (type (unsigned-byte 64) sum))
    (loop for index from 1 below (length words)
          unless (= index (1- +cache-header-size+))
            do (setf sum (ldb (byte 64 0) (+ (* sum #x100000001B3) (aref words index)))))
    sum))

;;; Writing.

(defun map-words (map key)
  (let* ((walls (count-if #'plusp (map-flags map))) (places (count-if #'plusp (map-places map)))
         (words (make-array (+ +cache-header-size+ (* 2 (+ walls places)))
                            :element-type '(unsigned-byte 64)))
         (position +cache-header-size+))
    (flet ((add (number index value)
             (setf (aref words position) (logior index (ash number 32))
                   (aref words (1+ position)) (double-to-bits value))
             (incf position 2)))
      (loop for number across (map-substances map) for index from 0
            when (plusp number) do (add number index (aref (map-parameters map) index)))
      (loop for number across (map-places map) for index from 0
            when (plusp number) do (add number index (aref (map-directions map) index))))
    (replace words (list +cache-magic+ key walls places))
    (setf (aref words (1- +cache-header-size+)) (words-checksum words))
    words))

(defun write-words (words path)
  "Write WORDS to the file PATH atomically. Signals an error if PATH is write-protected."
  (ensure-directories-exist path)
  (remove-abandoned-files (uiop:pathname-directory-pathname path))
  (check-writable path)
  (call-with-own-random-state
   (lambda ()
     (uiop:with-temporary-file (:stream out :pathname new :element-type '(unsigned-byte 64)
                                :directory (uiop:pathname-directory-pathname path)
                                :prefix (temporary-file-prefix) :type :unspecific)
       (write-sequence words out)
       :close-stream
       (copy-permissions new path)
       (replace-file path new)))))

;;; Reading.

(defun read-words (path most)
  "Return a vector of the words of the file PATH, empty if they exceed MOST, or NIL without a file."
  (with-open-file (in path :element-type '(unsigned-byte 64) :if-does-not-exist nil)
    (when in
      (let ((words (make-array (if (<= (file-length in) most) (file-length in) 0)
                               :element-type '(unsigned-byte 64))))
        (read-sequence words in)
        words))))

(defun cache-problem-text (words key)
  (cond ((or (< (length words) +cache-header-size+) (/= (aref words 0) +cache-magic+)) "is damaged")
        ((/= (aref words 1) key) "is stale")
        ((or (/= (length words) (+ +cache-header-size+ (* 2 (+ (aref words 2) (aref words 3)))))
             (/= (aref words 4) (words-checksum words)))
         "is damaged")))

(defun restore-cell (map wall-p index number value)
  "Make the cell INDEX of MAP a wall of substance NUMBER if WALL-P, else a place of type NUMBER."
  (unless (< 0 number (length (if wall-p (map-substance-types map) (map-place-types map))))
    (error "no substance or place type has the number ~D" number))
  (if wall-p
      (setf (aref (map-flags map) index) +wall+
            (aref (map-substances map) index) number
            (aref (map-parameters map) index) value)
      (setf (aref (map-places map) index) number
            (aref (map-directions map) index) value)))

(defun restore-map (map words)
  "Fill the empty grid of MAP from WORDS. Signals an error if WORDS describe no grid."
  (clear-walls map)
  (clear-places map)
  (let ((walls-end (+ +cache-header-size+ (* 2 (aref words 2)))))
    (loop for position from +cache-header-size+ below (length words) by 2
          do (restore-cell map (< position walls-end)
                           (ldb (byte 32 0) (aref words position))
                           (ldb (byte 32 32) (aref words position))
                           (bits-to-double (aref words (1+ position))))))
  (record-wall-facts map))

(defun begins-as-cache-p (path)
  "True if the file PATH is empty or begins like a map cache."
  (let ((words (make-array 1 :element-type '(unsigned-byte 64))))
    (or (zerop (file-size path))
        (with-open-file (in path :element-type '(unsigned-byte 64))
          (and (= 1 (read-sequence words in))
               (= +cache-magic+ (aref words 0)))))))

(defun non-cache-file-p (path)
  "True if the file PATH exists but is not known to be a map cache, whole or damaged."
  (and (ignore-errors (probe-file path))
       (not (ignore-errors (and (regular-file-p path) (begins-as-cache-p path))))))

(defun warn-of-cache (map path what)
  (warning-set "The cache " (native-name path) " of map " (map-name map) " " what
               "; the map is built anew."))

(defun restore-from-cache (map path key)
  (handler-case
      ;; Each cell is a wall, or a place, or both.
      (let ((words (read-words path
                               (+ +cache-header-size+ (* 4 (map-width map) (map-height map))))))
        (when words
          (let ((trouble (cache-problem-text words key)))
            (if trouble
                (warn-of-cache map path trouble)
                (restore-map map words)))))
    (error (condition)
      (warn-of-cache map path (format nil "cannot be read (~A)" (text-of-condition condition)))
      nil)))

(defun write-cache (map path key)
  (handler-case (write-words (map-words map key) path)
    (error (condition)
      (warning-set "The cache " (native-name path) " of map " (map-name map)
                   " cannot be written: " (text-of-condition condition)))))

(defun cache-path (name)
  "Return the path of the cache file NAME, relative to the definition's file or current directory."
  (let ((directory (base-directory))
        (file (source-file (current-source))))
    (merge-pathnames (path-of-name name)
                     (if file
                         (merge-pathnames (uiop:pathname-directory-pathname (native-path file))
                                      directory)
                         directory))))

(defun usable-cache-path (map)
  "Return the path of the cache file of MAP, or NIL if MAP has none or the file is not a map cache."
  ;; Checkers are users' code, on which places would depend.
  (let ((path (and (notany #'place-type-checker (registry-objects *place-types*))
                   (map-cache map))))
    (cond ((null path) nil)
          ((non-cache-file-p path)
           (warning-set "The file " (native-name path)
                        " is no map cache and is left as it is; " (map-name map)
                        " is not kept. Give :cache another name.")
           nil)
          (t (or (ignore-errors (probe-file path)) path)))))
