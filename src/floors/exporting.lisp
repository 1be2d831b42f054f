;;;; exporting.lisp -- EXPORT-MAP: the walls of a map as an occupancy grid.

(in-package :ars-magna.floors)

;;; EXPORT-MAP writes what ROS's map_saver writes: black walls, white floor, 205 for unknown, and
;;; the thresholds between these three.

(define-constant +shades+ #(254 0 205) :test 'equalp
  :documentation "The brightness, from 0 to 255, of pixels for +FREE+, +OCCUPIED+ and +UNKNOWN+.")

(defun number-of-substance (map substance)
  "Return the number of SUBSTANCE in MAP, or NIL if no wall is of it. Signals UNKNOWN-NAME."
  (let ((names (map-substance-types map)))
    (or (position substance names :start 1 :test #'same-name-p)
        (unless (find-substance substance nil)
          (reject-name "substance" substance
                       (append (rest (coerce names 'list)) (defined-names *substances*)))))))

(defun unknown-wall-test (map unknown)
  "Return a predicate of a substance's number and a parameter, true if UNKNOWN, as for EXPORT-MAP,
stands for such walls of MAP. Signals UNKNOWN-NAME."
  (if (member unknown '(nil :walls))
      (constantly nil)
      (destructuring-bind (name &optional parameter) (ensure-list unknown)
        (let ((wanted (number-of-substance map name)))
          (lambda (number value)
            (and (eql number wanted)
                 (or (null parameter) (= value parameter))))))))

(defun map-grid (map unknown)
  "Return the cells of MAP as a grid. UNKNOWN, as for EXPORT-MAP, says which walls are unknown."
  (let* ((grid (make-grid (map-width map) (map-height map)))
         (cells (grid-cells grid)) (unknown-p (unknown-wall-test map unknown)))
    (dotimes (index (length cells) grid)
      (when (logtest +wall+ (aref (map-flags map) index))
        (setf (aref cells index)
              (if (funcall unknown-p (aref (map-substances map) index)
                           (aref (map-parameters map) index))
                  +unknown+
                  +occupied+))))))

(defun write-image (grid out)
  "Write GRID as PGM in bytes to OUT, a stream whose characters are octets."
  (format out "P5~%~D ~D~%255~%" (grid-width grid) (grid-height grid))
  (let ((row (make-string (grid-width grid))))
    (dotimes (y (grid-height grid))
      (dotimes (x (grid-width grid))
        (setf (char row x)
              (code-char (aref +shades+ (aref (grid-cells grid) (+ x (* y (grid-width grid))))))))
      (write-string row out))))

(defun name-as-value (name)
  "Return NAME, of a file, as a value of YAML, in quotes only if it needs them."
  (if (and (alpha-char-p (char name 0))
           (every (lambda (char) (or (alphanumericp char) (find char "._-"))) name))
      name
      (format nil "'~{~A~^''~}'" (uiop:split-string name :separator "'"))))

(defun image-name (path)
  "Return the name of the image PATH for a description in the same directory."
  (let ((name (name-in-directory path)))
    ;; Readers might take ~ for a home directory.
    (if (char= #\~ (char name 0))
        (concatenate 'string "./" name)
        name)))

(defun write-description (map image out)
  (destructuring-bind (size &rest origin) (map-frame map)
    (format out "image: ~A~%mode: trinary~%resolution: ~A~%origin: [~{~A~^, ~}]~%negate: 0~%~
                 occupied_thresh: 0.65~%free_thresh: 0.196~%"
            (name-as-value image) (decimal size) (mapcar #'decimal origin))))

(defun write-floor-file (file format function &key (check #'identity))
  "Do as CALL-REPLACING-FILE does with FUNCTION, FILE and CHECK. Signals UNUSABLE-FLOOR."
  (handler-case (call-replacing-file function file :external-format format :check check)
    (unusable-floor (condition) (error condition))
    (error (condition)
      (reject-floor file nil "it cannot be written, and is as it was: ~A. Give the name of a file ~
                              that you may write"
                    (unwritten-reason condition)))))

(defun check-description-name (file path)
  "Signal WRONG-ARGUMENT if PATH, that of FILE, is no possible name for EXPORT-MAP."
  (unless (member (pathname-type path) '("yaml" "yml") :test #'equalp)
    (reject-argument 'export-map 'file file
                     "a name that ends in .yaml; the image goes beside it"))
  (unless (every #'graphic-char-p (name-in-directory path))
    (reject-argument 'export-map 'file file
                     "a name without line ends and the like, which cannot stand in the file")))

(defun linked-file (path)
  "Return the truename of the file PATH, which may be a link; PATH if there is none."
  (or (ignore-errors (existing-path path)) path))

(defun image-named-in (file)
  "Return the path (the truename if it is there) of the image that FILE describes, or NIL."
  (ignore-errors
   (check-description-file file)
   (let ((entries (read-entries file (file-text file))))
     (linked-file (image-path file (required-entry file "image" entries))))))

(defun unused-name-p (path)
  "True if there is no file PATH, or an empty one."
  (let ((there (probe-file path)))
    (or (null there)
        (ignore-errors (and (plain-file-p there) (zerop (file-size there)))))))

(defun check-pair (path image)
  "Signal UNUSABLE-FLOOR if the files PATH and IMAGE may not be replaced: PATH does not describe
IMAGE, or IMAGE is no image or not described by PATH."
  (let ((named (image-named-in path)))
    (flet ((reject (file what)
             (reject-floor file nil "it is not ~A, and is left as it is. Give another name, or ~
                                     remove it" what)))
      (cond ((unused-name-p path)
             (unless (unused-name-p image)
               (reject image (format nil "the image of ~A" (native-name path)))))
            ((null named) (reject path "the description of a map"))
            ((not (equal named (linked-file image)))
             (reject path (format nil "the description of ~A" (native-name image))))
            ((foreign-file-p image :image) (reject image "a PGM or PNG image"))))))

(addition export-map)
(defun export-map (map file &key unknown)
  "Write the walls of MAP, a map or its name, as an occupancy grid for ROS's map_server: the YAML
file FILE, a string or pathname whose name ends in .yaml or .yml, and beside it a PGM image of the
same name. Return the truenames of both. In a string ~/ is the home directory, and * ? [ and \\
stand for themselves. A pixel is a cell, as wide as MAP-FRAME says; IMPORT-MAP makes the same cells
of it. Substances and things are not written.

UNKNOWN, as for IMPORT-MAP, is a substance whose walls are written as unknown, or a list of that and
a parameter, such as (glass 5); NIL and :WALLS mean none. MAP need not have walls of it.

An existing description of a map that names that image is replaced, and the image with it. If FILE
is a link, both are written where it leads to, under that name. Signals UNUSABLE-FLOOR, for example
if another file has one of these names, WRONG-ARGUMENT and UNKNOWN-NAME; then both files are as they
were."
  (check-argument export-map file (typep file '(or string pathname)) "the name of a file")
  (check-argument export-map unknown (substance-option-p unknown)
                  "the name of a substance, or a list of that and a parameter, as in (glass 5)")
  (let ((map (map-from 'export-map map)) (path (linked-file (file-called file))))
    (check-description-name file path)
    (let* ((grid (map-grid map unknown))
           (image (make-pathname :type "pgm" :defaults path))
           (written nil))
      (check-pair path image)
      (flet ((write-beside (description)
               (declare (ignore description))
               (setf written (write-floor-file image :latin-1
                                               (lambda (out) (write-image grid out))))))
        ;; The image is replaced when the new description is ready to be.
        (values (write-floor-file path :utf-8
                                  (lambda (out) (write-description map (image-name image) out))
                                  :check #'write-beside)
                written)))))
