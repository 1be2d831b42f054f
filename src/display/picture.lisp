;;;; picture.lisp -- pictures of a world, and of a map with ways, in files.

(in-package :ars-magna.display)

(export '(check-map-options picture-kind save-svg save-snapshot))

(defun write-picture (stream snapshot robot &key (display :world) (layers *picture-layers*)
                                              (in-color t) scale title subtitle)
  "Write an SVG document of DISPLAY to STREAM. ROBOT is the image of a robot in SNAPSHOT."
  (flet ((draw (canvas)
           (draw-display canvas display snapshot robot
                         :layers layers :title title :subtitle subtitle)))
    (if (member display '(:world :all))
        (with-map-svg (canvas stream snapshot :layers layers :in-color in-color :scale scale)
          (draw canvas))
        (with-svg (canvas stream :color-p in-color)
          (with-canvas (canvas :scale (suitable-scale scale snapshot layers)) (draw canvas))))))

(defun check-map-options (operator &key title layers scale)
  "Signal WRONG-ARGUMENT unless TITLE, LAYERS and SCALE are valid for OPERATOR, which draws a map."
  (unless (typep title '(or null string))
    (reject-argument operator :title title "a string or NIL"))
  (check-layers operator "layers" layers)
  (unless (or (null scale) (argument-of-type-p scale 'picture-scale))
    (reject-argument operator "scale" scale (argument-type-text 'picture-scale))))

(defun check-picture (operator robot display layers scale title)
  (unless (robot-p robot)
    (reject-argument operator "robot" robot "a robot"))
  (check-display operator display)
  (check-map-options operator :title title :layers layers :scale scale))

(defun snapshot-and-measures (operator robot measures)
  "Return a snapshot of the world of ROBOT, and a text of the values of MEASURES at that tick, or
NIL. Errors name OPERATOR."
  (asking (robot) (values (snapshot-of robot) (text-of-measures operator measures))))

(addition svg-picture)
(define-with-keywords svg-picture
    (robot &key (display :world) (layers *picture-layers*) (in-color t) scale title measures part)
  "Return a picture of the present world of ROBOT: an SVG document, as a string. DISPLAY is one of
:WORLD, :STATE, :DESIGNATORS, :CAMERAS, :HANDS and :BINS, the displays of the manual, or :ALL.
LAYERS lists what the picture shows besides walls, things and robots; () means nothing else.
*PICTURE-LAYERS* documents the layers. If the layer :TITLE is shown, TITLE, a string, replaces the
default title: robots, map and tick. The present values of MEASURES, a list of names of measures
(see DEFMEASURE), are written below the title. PART (left top right bottom), in cells, is the part
of the map to show, by default the whole map. If IN-COLOR is NIL, the picture is black and white.

SCALE is the number of pixels per cell, from 1 to 256. The default is GRAPHICS-SCALE* if you have
set it to a value other than 8, else the scale that suits the map. That scale is from 4 to 40. With
it, the picture without its legend is at most 900 x 700 pixels large, unless even the scale 4 makes
it larger. If SCALE is larger than the scale that suits the map, and larger than 20, text and lines
grow too. In a paper, text is readable if the picture is at most 400 pixels wide for a column of 84
mm, and at most 820 pixels wide for a page of 174 mm.

Signals WRONG-ARGUMENT, UNKNOWN-NAME, and MISUSE if GRAPHICS-SCALE* is not a valid scale."
  (check-picture 'svg-picture robot display layers scale title)
  (multiple-value-bind (snapshot subtitle) (snapshot-and-measures 'svg-picture robot measures)
    (with-output-to-string (stream)
      (write-picture stream (snapshot-of-part snapshot part 'svg-picture)
                     (snapshot-robot snapshot (robot-name robot))
                     :display display :layers layers :in-color in-color :scale scale
                     :title title :subtitle subtitle))))

;;; Files.

(defun write-picture-file (text file)
  (overwrite-file (lambda (out) (write-string text out)) file "the picture"))

(defun png-remedy (words)
  (cond ((search "larger than" words) "Choose a smaller scale, or save it as .svg")
        ((search "No space" words) "Make room there, or choose another directory")
        (t "Choose a smaller scale if it is very large, or save it as .svg")))

(defun reject-png (file words)
  "Signal MISUSE because the picture cannot be written to FILE. WORDS is rsvg-convert's message."
  (let ((words (one-line words)))
    (reject-use "The picture cannot be written to ~A: rsvg-convert ~:[failed without a ~
                 message~;~:*says ~S~]. An older file of this name is unchanged. ~A."
                (file-name-text file) (and (plusp (length words)) (cut words 300))
                (png-remedy words))))

(defun write-png (svg out file)
  "Convert the SVG document SVG to PNG with the program rsvg-convert and write the PNG to the stream
OUT. FILE is the name of the file for messages."
  (multiple-value-bind (status words)
      (run-filter "rsvg-convert" '("--unlimited" "-f" "png") svg out)
    (cond ((null status)
           (reject-use "PNG pictures need the program rsvg-convert, which is in Debian's package ~
                        librsvg2-bin: apt-get install librsvg2-bin. Or save the picture as .svg."))
          ((plusp status) (reject-png file words)))))

(defun picture-kind (operator file &optional (kinds '(:svg :png)) (endings ".svg or .png"))
  "Return the element of KINDS that is the type of the file name FILE. Signals WRONG-ARGUMENT for
OPERATOR if FILE has another type or cannot be written. ENDINGS names the types in the message."
  (flet ((reject (expected) (reject-argument operator 'file file expected)))
    (unless (typep file '(or string pathname)) (reject "the name of a file"))
    (when (wildcard-name-p file)
      (reject "the name of one file; in a Lisp string, write \\\\ before each *, ? and ["))
    (let ((missing (missing-directory file)))
      (when missing (reject (format nil "a name in an existing directory; make ~A first" missing))))
    (or (find (pathname-type file) kinds :test #'string-equal)
        (reject (format nil "a name that ends in ~A" endings)))))

(defun save-svg (svg file kind)
  "Write the document SVG to FILE, as it is or as PNG if KIND is :PNG. Return the truename of FILE."
  (ecase kind
    (:svg (write-picture-file svg file))
    (:png (let ((file (merge-pathnames file)))
            (overwrite-file (lambda (out) (write-png svg out file)) file "the picture"
                            :kind :image)))))

(defun save-snapshot (snapshot robot file &rest look &key (display :all) &allow-other-keys)
  "Save a picture of SNAPSHOT in FILE as SAVE-PICTURE does. ROBOT is the image of a robot in
SNAPSHOT. LOOK are options of WRITE-PICTURE."
  (save-svg (with-broken-graphics-reported
              (with-output-to-string (stream)
                (apply #'write-picture stream snapshot robot :display display look)))
            file (picture-kind 'save-snapshot file)))

(addition save-picture)
(define-with-keywords save-picture
    (robot file &key (display :world) (layers *picture-layers*) (in-color t) scale title measures
                  part)
  "Save a picture of ROBOT's present world in FILE, replacing an older file. Return the truename.
The name ends in .svg, or in .png if the program rsvg-convert is installed. The other arguments are
those of SVG-PICTURE. Signals WRONG-ARGUMENT, UNKNOWN-NAME, and MISUSE if rsvg-convert is missing."
  (picture-kind 'save-picture file)
  (check-picture 'save-picture robot display layers scale title)
  (multiple-value-bind (snapshot subtitle) (snapshot-and-measures 'save-picture robot measures)
    (save-snapshot (snapshot-of-part snapshot part 'save-picture)
                   (snapshot-robot snapshot (robot-name robot)) file
                   :display display :layers layers :in-color in-color :scale scale
                   :title title :subtitle subtitle)))

;;;; Ways on a map

(defun coordinates-of (point)
  "Return the coordinates of POINT, a PT or a list (x y), as a list (x y)."
  (if (pt-p point) (list (pt-x point) (pt-y point)) point))

(defun point-in-pixels (point)
  (points-to-pixels (coordinates-of point)))

(defun draw-ways-on-map (canvas ways)
  (draw-way-lines canvas (loop for way in ways for position from 0
                               collect (make-way-line position
                                                      (list (mapcan #'point-in-pixels way)))))
  (draw-way-marks canvas
                  (loop for way in ways for position from 0
                        for color = (nth-ink position)
                        collect `(draw-way-start ,@(point-in-pixels (first way)) ,color)
                        collect `(draw-way-end ,@(point-in-pixels (first (last way))) ,color))))

(defun way-p (way)
  (and (consp way) (proper-list-p way)
       (every (lambda (point) (or (pt-p point) (number-pair-p point))) way)))

(defun check-ways (ways)
  (check-argument save-way-picture ways (not (and (proper-list-p ways) (member nil ways)))
                  "a list of ways, without NIL, which FIND-WAY returns if there is no way")
  (check-argument save-way-picture ways (and (proper-list-p ways) (every #'way-p ways))
                  "a list of ways; each way is a list of PT objects or of lists (x y)"))

(defun point-on-map-p (point map)
  (destructuring-bind (x y) (coordinates-of point)
    (and (<= 0 x (map-width map)) (<= 0 y (map-height map)))))

(defun check-ways-on-map (map ways)
  (dolist (way ways)
    (dolist (point way)
      (unless (point-on-map-p point map)
        (reject-argument 'save-way-picture 'ways point
                         (format nil "ways on the map ~A, with x from 0 to ~D and y from 0 to ~D"
                                 (drawn-name (map-name map)) (map-width map) (map-height map)))))))

(defun ways-entries (ways)
  (append (loop for nil in ways for number from 0
                collect (let ((position number))
                          (named-entry-with-sample (canvas x y)
                              ((format nil "way~:[~; ~D~]" (rest ways) (1+ position)) "" 38)
                            (draw-way-sample canvas (list (- x 18) y (+ x 18) y)
                                             (nth-ink position) position))))
          (and ways (list (entry-with-sample (canvas x y) "start"
                            (draw-way-start canvas x y black*))
                          (entry-with-sample (canvas x y) "end"
                            (draw-way-end canvas x y black*))))))

(defun snapshot-of-map (map)
  "Return a snapshot of the current world if MAP is its map; if not, of MAP alone."
  (let ((simulation *simulation*))
    (if (and simulation (eq map (world-map (simulation-world simulation))))
        (asking (simulation) (take-snapshot (simulation-world simulation)))
        (make-snapshot :map map))))

(defun way-picture-text (snapshot ways &rest look &key layers &allow-other-keys)
  (apply #'framed-picture-svg snapshot
         (lambda (canvas)
           (draw-terrain canvas (snapshot-map snapshot) :layers layers)
           (draw-ways-on-map canvas ways)
           (draw-movers canvas snapshot layers))
         :more (ways-entries ways) look))

(addition save-way-picture)
(define-with-keywords save-way-picture
    (map ways file &key title (layers *picture-layers*) (in-color t) scale)
  "Save a picture of MAP with WAYS in FILE, replacing an older file. MAP is a map or its name. WAYS
is a list of ways. Each way is a list of PT objects or of lists (x y), such as FIND-WAY returns.
Return the truename of FILE. If MAP is the map of the current simulation, the picture also shows its
things and robots. TITLE, a string, is the title of the picture. FILE and the other arguments are
those of SAVE-PICTURE. Signals WRONG-ARGUMENT, UNKNOWN-NAME, and MISUSE if rsvg-convert is needed
but not installed."
  (check-ways ways)
  (check-map-options 'save-way-picture :title title :layers layers :scale scale)
  (let* ((map (find-map map)) (kind (picture-kind 'save-way-picture file)))
    (check-ways-on-map map ways)
    (save-svg (with-broken-graphics-reported
                (way-picture-text (snapshot-of-map map) ways
                                  :layers layers :in-color in-color :scale scale
                                  :title (or title (drawn-name (map-name map)))))
              file kind)))
