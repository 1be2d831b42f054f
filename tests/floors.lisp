;;;; floors.lisp -- maps from occupancy grids, and grids from maps.

(in-package :ars-magna.tests)

(def-suite* floors :in ars-magna)

;;; Files.

(defparameter *floor-lines*
  '("image: floor.pgm" "resolution: 0.05" "origin: [0.0, 0.0, 0.0]" "negate: 0"
    "occupied_thresh: 0.65" "free_thresh: 0.196")
  "What a map saver writes.")

(defun floor-text (&rest lines)
  "Return the text of a description: *FLOOR-LINES* with LINES for those that have the same key."
  (flet ((key (line) (subseq line 0 (position #\: line))))
    (format nil "~{~A~%~}"
            (append lines (remove-if (lambda (line)
                                       (member (key line) lines :key #'key :test #'string=))
                                     *floor-lines*)))))

(defun write-as-octets (text file)
  "Let FILE hold the characters of TEXT, each an octet."
  (with-open-file (out file :direction :output :if-exists :supersede :external-format :latin-1)
    (write-string text out))
  file)

(defmacro with-floor ((yaml image &optional (description '(floor-text))) &body body)
  "Run BODY with YAML bound to a file that holds the text DESCRIPTION, beside an image floor.pgm
that holds the text IMAGE; both are gone afterwards, and so is what is defined."
  `(base:with-own-definitions ()
     (call-in-directory
      (lambda (directory)
        (let ((,yaml (write-as-octets ,description (merge-pathnames "floor.yaml" directory))))
          (write-as-octets ,image (merge-pathnames "floor.pgm" directory))
          ,@body)))))

(defun pgm-text (rows &key (white 255))
  "Return the image, numbers in text, that has ROWS, lists of numbers."
  (format nil "P2~%~D ~D~%~D~%~{~{~D ~}~%~}" (length (first rows)) (length rows) white rows))

(defun pgm-octets (rows &key (white 255))
  "Return the image, as bytes, that has ROWS, lists of numbers."
  (format nil "P5~%~D ~D~%~D~%~{~{~A~}~}" (length (first rows)) (length rows) white
          (loop for row in rows
                collect (loop for value in row
                              when (< 255 white) collect (code-char (ash value -8))
                              collect (code-char (logand 255 value))))))

;;; Maps.

(defun wall-rows (map)
  "Return the rows of MAP as strings: # for a wall, u for one of glass, . for none."
  (loop for y below (world:map-height map)
        collect (coerce (loop for x below (world:map-width map)
                              for cell = (world:map-cell map x y)
                              collect (cond ((not (world:cell-filled? cell)) #\.)
                                            ((string= "GLASS" (world:cell-substance-type cell)) #\u)
                                            (t #\#)))
                        'string)))

(defun imported-rows (yaml &rest options)
  "Return the rows of the map that YAML is imported as, with what is unknown of glass."
  (wall-rows (apply #'ars:import-map yaml (append options '(:name imported :unknown glass)))))

(defparameter *corner* '((0 0 0 254) (0 254 205 254) (0 254 254 254))
  "The rows of an image: a corner of walls, and a pixel of which nothing is known.")

(defparameter *corner-rows* '("###." "#.u." "#..."))

(test image.is-read-in-all-its-formats
  (dolist (image (list (pgm-text *corner*) (pgm-octets *corner*)
                       (pgm-octets (loop for row in *corner*
                                         collect (mapcar (lambda (value) (* 257 value)) row))
                                   :white 65535)
                       (pgm-text '((0 0 0 1000) (0 1000 804 1000) (0 1000 1000 1000)) :white 1000)
                       (format nil "P2 # one~%#two~%4 3 255 0 0 0 254~%0 254 205 #three~%254 0 254 ~
                                    254 254")
                       (format nil "P5~%# CREATOR: map_saver 0.050 m/pix~%~A~%"
                               (subseq (pgm-octets *corner*) 3))))
    (with-floor (yaml image)
      (is (equal *corner-rows* (imported-rows yaml)) "~S" image))))

(defun states-with (row &rest lines)
  "Return the states of the pixels of ROW in a floor whose description has LINES."
  (with-floor (yaml (pgm-text (list row)) (apply #'floor-text lines))
    (first (imported-rows yaml))))

(test pixels.are-told-apart-by-the-thresholds
  "Strictly: the chance 51/255, a fifth, is not below .2, and 204/255 not above .8."
  (is (string= "##uu." (states-with '(0 89 90 205 206))))
  (is (string= "#uuu." (states-with '(50 51 100 204 205)
                                    "occupied_thresh: 0.8" "free_thresh: 0.2")))
  (is (string= "..uu#" (states-with '(0 49 50 165 166) "negate: 1")))
  (is (string= "#u." (states-with '(0 128 255) "mode: scale")))
  (is (string= "..uu##uu" (states-with '(0 19 20 65 66 100 101 255) "mode: raw"))))

(test description.is-read-as-others-write-it
  (dolist (text (list (floor-text "origin: [-1, +2., .5e1]  # a corner")
                      (format nil "---~%~A...~%and more" (floor-text "image: 'floor.pgm'   # it"))
                      (floor-text "image: \"floor.pgm\"" "negate: false" "mode: Trinary" "by: me")))
    (with-floor (yaml (pgm-text *corner*) text)
      (is (equal *corner-rows* (imported-rows yaml)) "~A" text)))
  (with-floor (yaml (pgm-text *corner*)
                    (substitute #\Return #\;
                                (floor-text (format nil "origin:;~%- -1.5;~%  - 2;~%- .25 # yaw"))))
    (is (equal '(.05d0 -1.5d0 2d0 .25d0) (world:map-frame (ars:import-map yaml))))))

(test import.has-a-name
  (with-floor (yaml (pgm-text *corner*))
    (let* ((*package* (find-package :ars-user)) (map (ars:import-map yaml)))
      (is (eq 'cl:floor (world:map-name map)) "which has no variable")
      (is (eq map (ars:find-map 'floor)))
      (is (eq (ars:import-map (base:native-name yaml) :name 'ward-b) (symbol-value 'ward-b)))
      (is (eq map (ars:find-map 'floor))))))

;;; Cells of several pixels.

(test cells.are-of-as-many-pixels-as-one-says
  "They are laid from the lower left; any pixel that is occupied, or a share of them, is a wall."
  (let ((rows '((254 254 254 254 0)
                (0   254 205 205 254)
                (254 254 205 254 254)
                (254 254 254 254 205)
                (254 0   254 254 205))))
    (with-floor (yaml (pgm-text rows))
      (is (equal '("..#" "#u." "#.u") (imported-rows yaml :pixels 2)))
      (is (equal (imported-rows yaml :pixels 2) (imported-rows yaml :cell .1)))
      (is (equal '("..#" ".u." "..u") (imported-rows yaml :pixels 2 :share 1/2)))
      (is (equal '("#") (imported-rows yaml :pixels 9)))
      (is (equal '(.1d0 0d0 0d0 0d0)
                 (world:map-frame (ars:import-map yaml :pixels 2 :name 'imported)))))))

(test import.makes-walls-of-what-one-says
  (flet ((kinds (&rest options)
           (with-floor (yaml (pgm-text '((0 205 254))))
             (let ((map (apply #'ars:import-map yaml :name 'imported options)))
               (loop for x below 3
                     for cell = (world:map-cell map x 0)
                     collect (list (world:cell-substance-type cell)
                                   (world:cell-substance-parameter cell)))))))
    (is (equal '((ars:bricks 20d0) (ars:bricks 20d0) (nil 0d0)) (kinds)))
    (is (equal '((ars:slate 30d0) (ars:slate 30d0) (nil 0d0)) (kinds :substance 'ars:slate)))
    (is (equal '((ars:slate 7d0) (nil 0d0) (nil 0d0))
               (kinds :substance '(ars:slate 7) :unknown nil)))
    (is (equal '((ars:bricks 20d0) (ars:glass 1.5d0) (nil 0d0))
               (kinds :unknown '(ars:glass 1.5))))
    (is (equal '((ars:bricks 20d0) (ars:bricks 20d0) (ars:slate 3d0))
               (kinds :clauses '((wall (2 0) (2 0) ars:slate 3)))))))

(test import.says-what-came-of-it
  (with-floor (yaml (pgm-text *corner*))
    (multiple-value-bind (map report) (ars:import-map yaml :unknown nil)
      (is (equal '(:width 4 :height 3 :cell .05d0 :free 6 :occupied 5 :unknown 1 :walls 2) report))
      (multiple-value-bind (form again) (ars:imported-map-form yaml :unknown nil)
        (is (equal report again))
        (is (equal '((:wall (0 0) (2 0) ars:bricks 20) (:wall (0 0) (0 2) ars:bricks 20))
                   (cdddr form)))
        (is (equalp (grid-of map) (grid-of (world:find-map (eval form)))) "which can be kept")))))

;;; Fewest lines.

(defun random-grid (width height shares dice)
  "Return a grid whose cells are free, occupied and unknown with the SHARES, which add up to 1."
  (let ((grid (floors::make-grid width height)))
    (dotimes (index (* width height) grid)
      (setf (aref (floors::grid-cells grid) index)
            (let ((roll (base:roll dice)))
              (cond ((< roll (first shares)) 0)
                    ((< roll (+ (first shares) (second shares))) 1)
                    (t 2)))))))

(defun cells-of-line (line width)
  "Return the indices of the cells of LINE, two ends."
  (destructuring-bind ((x0 y0) (x1 y1)) line
    (loop for y from y0 to y1
          append (loop for x from x0 to x1 collect (+ x (* y width))))))

(defun cells-in (grid states)
  (loop for state across (floors::grid-cells grid) for index from 0
        when (member state states) collect index))

(defun whole-lines (grid states)
  "Return all lines along rows and columns through cells of GRID in STATES that cannot be longer, as
lists of cells, found by trying all."
  (let* ((width (floors::grid-width grid)) (height (floors::grid-height grid))
         (allowed (cells-in grid states))
         (lines (remove-if-not
                 (lambda (cells) (subsetp cells allowed))
                 (append (loop for y below height
                               append (loop for x0 below width
                                            append (loop for x1 from x0 below width
                                                         collect (cells-of-line `((,x0 ,y) (,x1 ,y))
                                                                                width))))
                         (loop for x below width
                               append (loop for y0 below height
                                            append (loop for y1 from y0 below height
                                                         collect (cells-of-line `((,x ,y0) (,x ,y1))
                                                                                width))))))))
    (remove-duplicates (remove-if (lambda (cells)
                                    (some (lambda (other) (and (not (equal cells other))
                                                               (subsetp cells other)))
                                          lines))
                                  lines)
                       :test #'equal)))

(defun least-count (needed lines)
  "Return how few of LINES, lists of cells, have all cells NEEDED, by trying: some line must have
the first cell."
  (if (null needed)
      0
      (1+ (loop for line in lines
                when (member (first needed) line)
                  minimize (least-count (set-difference needed line) lines)))))

(test lines.are-as-few-as-can-be
  "Held against trying all on small grids: no line leaves what is allowed, all that is needed is in
one."
  (let ((dice (base:make-dice 5)) (total 0))
    (dotimes (i 150)
      (let* ((grid (random-grid (+ 1 (mod i 5)) (+ 1 (mod i 4)) '(.3 .5 .2) dice))
             (width (floors::grid-width grid))
             (allowed (if (evenp i) '(1) '(1 2)))
             (lines (mapcar (lambda (line) (cells-of-line line width))
                            (floors::fewest-lines grid '(1) allowed)))
             (needed (cells-in grid '(1))))
        (incf total (length lines))
        (is (subsetp needed (reduce #'append lines)))
        (is (subsetp (reduce #'append lines) (cells-in grid allowed)))
        (is (= (length lines) (least-count needed (whole-lines grid allowed))))))
    (is (< 150 total))))

;;; There and back.

(defun grid-octets (grid)
  "Return GRID as an image in bytes."
  (with-output-to-string (out) (floors::write-image grid out)))

(defun same-cells-p (map other)
  (equalp (grid-of map) (grid-of other)))

(test round-trip.gives-the-same-cells
  (let ((dice (base:make-dice 9)))
    (loop for (width height . shares) in '((1 1 0 1 0) (7 1 .5 .5 0) (1 9 .2 .4 .4) (31 17 .7 .3 0)
                                           (40 33 .3 .4 .3) (25 60 .1 .1 .8) (12 12 0 0 1))
          for grid = (random-grid width height shares dice)
          do (with-floor (yaml (grid-octets grid) (floor-text "origin: [-3.25, 1e-3, 0.1]"))
               (let ((map (ars:import-map yaml :name 'there :unknown 'ars:glass))
                     (file (base:native-path (format nil "~Ait's [a] copy.yaml"
                                                     (base:native-name directory)))))
                 (ars:export-map map file :unknown 'glass)
                 (let ((back (ars:import-map file :name 'back :unknown 'ars:glass)))
                   (is (same-cells-p map back))
                   (is (equal (world:map-frame map) (world:map-frame back)))))))))

(test export.takes-what-import-took-for-unknown
  "A name, or a list of that and a parameter; :WALLS and NIL are for no walls of their own."
  (with-floor (yaml (pgm-text *corner*))
    (flet ((again (imported exported)
             (let ((map (ars:import-map yaml :name 'there :unknown imported :substance '(glass 5)))
                   (file (base:native-path (format nil "~Ab.yaml" (base:native-name directory)))))
               (ars:export-map map file :unknown exported)
               (wall-rows (ars:import-map file :name 'back :unknown 'glass)))))
      (is (equal *corner-rows* (again 'bricks 'bricks)))
      (is (equal *corner-rows* (again '(glass 77) '(glass 77))))
      (is (equal '("uuu." "u.u." "u...") (again '(glass 77) 'glass)) "both are of glass")
      (is (equal '("###." "#.#." "#...") (again :walls :walls)))
      (is (equal '("###." "#..." "#...") (again nil nil)))
      (is (equal '("###." "#.#." "#...") (again '(glass 77) '(glass 78))))
      (is (equal '("###." "#.#." "#...") (again :walls 'paper)) "there are no walls of paper"))
    (dolist (wrong '(5 (glass heavy) ((glass)) "glass"))
      (signals base:wrong-argument (ars:export-map 'there "room.yaml" :unknown wrong)))))

(test import.warns-of-keys-that-look-like-others
  (flet ((said (&rest lines)
           (with-floor (yaml (pgm-text '((0 254))) (apply #'floor-text lines))
             (warnings-of (lambda () (ars:import-map yaml))))))
    (is (search "floor.yaml, line 1: the key moed is unknown and ignored; did you mean mode?"
                (first (said "moed: scale"))))
    (is (search "did you mean image?" (first (said "Image: other.pgm"))))
    (is (null (said "mode: trinary" "cost: 3" "map_id: 7" "width: 5" "free_cost: 1")))))

(test import.warns-of-a-floor-where-nothing-is-free
  (with-floor (yaml (pgm-text '((0 128 200))) (floor-text "mode: scale" "free_thresh: 0.1"))
    (is (search "no cell is free" (first (warnings-of (lambda () (ars:import-map yaml)))))))
  (with-floor (yaml (pgm-text '((0 128 255))) (floor-text "mode: scale" "free_thresh: 0.1"))
    (is (null (warnings-of (lambda () (ars:import-map yaml)))))))

(test export.writes-what-import-reads
  "Whatever frame a map has, and whatever the file is called; but for names that no line can hold."
  (with-own-definitions
    (call-in-directory
     (lambda (directory)
       (loop for (name . frame) in '(("plain.yaml" 1f-6 1d-31 -1d-300 4.9d-324)
                                     ("~.yaml" 2d-9 1d9 -1d9 .1f0) ("~x 'y' #z.yml" 1d9 1/3 0 0))
             for file = (base:native-path (concatenate 'string (base:native-name directory) name))
             do (eval `(world:defmap framed (3 2 :frame ,frame) (wall (0 0) (2 0) slate 1)))
                (ars:export-map 'framed file)
                (is (equal (mapcar #'base:double frame)
                           (world:map-frame (ars:import-map file :name 'back)))
                    "~A ~A" name frame))
       (signals base:wrong-argument
         (ars:export-map 'framed (format nil "~Atwo~%lines.yaml" (base:native-name directory))))
       (is (null (directory (merge-pathnames "two*.*" directory))))))))

(test export.takes-any-map
  (with-own-definitions
    (eval '(world:defmap plain-room (6 5) (rect (0 0) (5 4) slate 1) (circle (2 2) 1 wood 3)))
    (call-in-directory
     (lambda (directory)
       (let ((file (merge-pathnames "room.yaml" directory)))
         (is (equal (list file (make-pathname :type "pgm" :defaults file))
                    (multiple-value-list (ars:export-map 'plain-room file))))
         (is (equal '(1d0 0d0 0d0 0d0) (world:map-frame (ars:import-map file :name 'back))))
         (is (equalp (world:map-flags (world:find-map 'plain-room))
                     (world:map-flags (world:find-map 'back)))))))))
