;;;; exporting.lisp -- EXPORT-MAP: the walls of a map as an occupancy grid.

(in-package :ars-magna.floors)

;;; EXPORT-MAP writes what ROS's map_saver writes: black walls, white floor, 205 for unknown, and
;;; the thresholds between these three.

(define-constant +shades+ #(254 0 205) :test 'equalp
  :documentation "The brightness, from 0 to 255, of pixels for +FREE+, +OCCUPIED+ and +UNKNOWN+.")

(defun substance-index (map substance)
  "Return the index of SUBSTANCE in MAP, or NIL if no wall has SUBSTANCE. Signals UNKNOWN-NAME."
  (let ((names (map-substance-types map)))
    (or (position substance names :start 1 :test #'same-name-p)
        (unless (find-substance substance nil)
          (reject-name "substance" substance
                       (append (rest (coerce names 'list)) (defined-names *substances*)))))))

(defun unknown-wall-test (map unknown)
  "Return a function of the substance index and parameter of a wall of MAP. It returns true if
EXPORT-MAP with UNKNOWN writes the wall as unknown. Signals UNKNOWN-NAME."
  (if (member unknown '(nil :walls))
      (constantly nil)
      (destructuring-bind (name &optional parameter) (ensure-list unknown)
        (let ((wanted (substance-index map name)))
          (lambda (number value)
            (and (eql number wanted)
                 (or (null parameter) (= value parameter))))))))

(defun map-grid (map unknown)
  "Return the cells of MAP as a grid. UNKNOWN says which walls are unknown, as in EXPORT-MAP."
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
  "Write GRID as binary PGM to OUT, a stream whose characters are octets."
  (format out "P5~%~D ~D~%255~%" (grid-width grid) (grid-height grid))
  (let ((row (make-string (grid-width grid))))
    (dotimes (y (grid-height grid))
      (dotimes (x (grid-width grid))
        (setf (char row x)
              (code-char (aref +shades+ (aref (grid-cells grid) (+ x (* y (grid-width grid))))))))
      (write-string row out))))

(defun yaml-quoted-file-name (name)
  "Return the file name NAME as a value in YAML, in quotes only if YAML requires quotes."
  (if (and (alpha-char-p (char name 0))
           (every (lambda (char) (or (alphanumericp char) (find char "._-"))) name))
      name
      (format nil "'~{~A~^''~}'" (uiop:split-string name :separator "'"))))

(defun image-name (path)
  "Return the name by which a description in the same directory refers to the image file PATH."
  (let ((name (file-base-name path)))
    ;; Readers might take ~ for a home directory.
    (if (char= #\~ (char name 0))
        (concatenate 'string "./" name)
        name)))

(defun write-description (map image out)
  (destructuring-bind (size &rest origin) (map-frame map)
    (format out "image: ~A~%mode: trinary~%resolution: ~A~%origin: [~{~A~^, ~}]~%negate: 0~%~
                 occupied_thresh: 0.65~%free_thresh: 0.196~%"
            (yaml-quoted-file-name image) (decimal-notation size) (mapcar #'decimal-notation
                                                                          origin))))

(defun write-floor-file (file format function &key (check #'identity))
  "Replace FILE by what FUNCTION writes. Signals UNUSABLE-FLOOR if FILE cannot be written."
  (handler-case (call-replacing-file function file :external-format format :check check)
    (unusable-floor (condition) (error condition))
    (error (condition)
      (reject-floor file nil "the file cannot be written and is unchanged: ~A. Give the name of a ~
                              file that you may write"
                    (write-failure-text condition)))))

(defun check-description-name (file path)
  "Signal WRONG-ARGUMENT about FILE if its path PATH is no valid name for EXPORT-MAP."
  (unless (member (pathname-type path) '("yaml" "yml") :test #'equalp)
    (reject-argument 'export-map 'file file
                     "a name that ends in .yaml; the image is written beside the file"))
  (unless (every #'graphic-char-p (file-base-name path))
    (reject-argument 'export-map 'file file
                     "a name of printable characters only, because the .yaml file contains it")))

(defun resolve-link (path)
  "Return the truename of the file PATH, which may be a link, or PATH if there is no such file."
  (or (ignore-errors (existing-path path)) path))

(defun image-named-in (file)
  "Return the path of the image that the description FILE names, as a truename if the image exists;
NIL if FILE is no valid description."
  (ignore-errors
   (check-description-file file)
   (let ((entries (read-entries file (file-text file))))
     (resolve-link (image-path file (required-entry file "image" entries))))))

(defun missing-or-empty-file-p (path)
  (let ((there (probe-file path)))
    (or (null there)
        (ignore-errors (and (regular-file-p there) (zerop (file-size there)))))))

(defun check-files-replaceable (path image)
  "Signal UNUSABLE-FLOOR if the files PATH and IMAGE must not be replaced, because PATH does not
describe IMAGE, or because IMAGE is no image."
  (let ((named (image-named-in path)))
    (flet ((reject (file what)
             (reject-floor file nil "the file is not ~A, and is left unchanged. Give another name, ~
                                     or remove the file" what)))
      (cond ((missing-or-empty-file-p path)
             (unless (missing-or-empty-file-p image)
               (reject image (format nil "the image of ~A" (native-name path)))))
            ((null named) (reject path "the description of a map"))
            ((not (equal named (resolve-link image)))
             (reject path (format nil "the description of ~A" (native-name image))))
            ((other-kind-of-file-p image :image) (reject image "a PGM or PNG image"))))))

(addition export-map)
(defun export-map (map file &key unknown)
  "Write the walls of MAP, a map or its name, as an occupancy grid for ROS's map_server: the YAML
file FILE, a string or pathname whose name ends in .yaml or .yml, and beside it a PGM image of the
same name. Return the truenames of both files. In a string ~/ is the home directory, and * ? [ and
\\ stand for themselves. Each cell becomes a pixel as wide as MAP-FRAME says a cell is; IMPORT-MAP
turns the pixels into the same cells again. Substances and things are not written.
UNKNOWN is a substance whose walls are written as unknown, or a list of a substance and a parameter,
such as (glass 5); NIL and :WALLS mean no walls. MAP need not have walls of the substance.
An existing description that names the same image is replaced, together with the image. If FILE is
a link, both files are written beside the file that the link leads to, under the name of that file.
Signals UNUSABLE-FLOOR, for example if another file has one of these names, WRONG-ARGUMENT and
UNKNOWN-NAME; then both files are unchanged."
  (check-argument export-map file (typep file '(or string pathname)) "the name of a file")
  (check-argument export-map unknown (substance-option-p unknown)
                  "the name of a substance, or a list of the name and a parameter, as in (glass 5)")
  (let ((map (find-map-argument 'export-map map)) (path (resolve-link (resolve-file-name file))))
    (check-description-name file path)
    (let* ((grid (map-grid map unknown))
           (image (make-pathname :type "pgm" :defaults path))
           (written nil))
      (check-files-replaceable path image)
      (flet ((write-beside (description)
               (declare (ignore description))
               (setf written (write-floor-file image :latin-1
                                               (lambda (out) (write-image grid out))))))
        ;; The image is replaced when the new description is ready to be.
        (values (write-floor-file path :utf-8
                                  (lambda (out) (write-description map (image-name image) out))
                                  :check #'write-beside)
                written)))))
