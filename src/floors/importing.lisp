;;;; importing.lisp -- IMPORT-MAP: a map from an occupancy grid, with its frame.

(in-package :ars-magna.floors)

;;; A map's y grows downwards and its angles clockwise. In the frame, as in ROS, y grows upwards and
;;; angles counterclockwise. The map's lower left corner is the frame's origin, see MAP-FRAME.

(defun check-pose (operator x y angle)
  (loop for (name value) in `((x ,x) (y ,y) (angle ,angle))
        unless (sane-number-p value)
          do (reject-argument operator name value "a number from -1e9 to 1e9")))

(addition map-to-frame)
(defun map-to-frame (map x y &optional (direction 0))
  "Convert the point (X, Y) and DIRECTION, in radians clockwise, from MAP to its frame (see
MAP-FRAME). MAP is a map or its name. Return x and y in metres and the angle in radians
counterclockwise: three double-floats. Signals WRONG-ARGUMENT and UNKNOWN-NAME."
  (check-pose 'map-to-frame x y direction)
  (let ((map (find-map-argument 'map-to-frame map)))
    (destructuring-bind (size left low yaw) (mapcar #'double (map-frame map))
      (let ((right (* size x)) (up (* size (- (map-height map) y))))
        (values (+ left (- (* right (cosine yaw)) (* up (sine yaw))))
                (+ low (* right (sine yaw)) (* up (cosine yaw)))
                (- yaw direction))))))

(addition frame-to-map)
(defun frame-to-map (map x y &optional (yaw 0))
  "Convert the point (X, Y), in metres, and YAW, in radians counterclockwise, from the frame of MAP
(see MAP-FRAME). MAP is a map or its name. Return x, y and the direction in MAP, radians clockwise:
three double-floats. The point may be outside MAP. Signals WRONG-ARGUMENT and UNKNOWN-NAME."
  (check-pose 'frame-to-map x y yaw)
  (let ((map (find-map-argument 'frame-to-map map)))
    (destructuring-bind (size left low turn) (mapcar #'double (map-frame map))
      (let ((right (- x left)) (up (- y low)))
        (values (/ (+ (* right (cosine turn)) (* up (sine turn))) size)
                (- (map-height map)
                   (/ (- (* up (cosine turn)) (* right (sine turn))) size))
                (- turn yaw))))))

;;;; Importing

;;; The files become a DEFMAP form, with the frame and a wall for each line of cells. So an imported
;;; map is a map like any other. Journals record its name and the number of its form, which differs
;;; at replay if the files have changed.

(define-constant +most-pixels+ 25000000
  :documentation "The largest number of pixels of an image, unless :limit gives another number.")

;;; The options.

(defun check-option (option test value expected)
  (unless test (reject-argument 'import-map option value expected)))

(defun whole-as-integer (value)
  (if (= value (round value)) (round value) value))

(defun substance-option-p (value)
  "True if VALUE is a symbol, or a list of a symbol and perhaps a number."
  (or (symbolp value)
      (and (proper-list-p value) (first value) (symbolp (first value))
           (or (null (rest value))
               (and (= 2 (length value)) (bounded-number-p (second value)))))))

(defun wall-substance (option value)
  "Return a list (substance parameter) for VALUE of OPTION. Signals UNKNOWN-NAME."
  (check-option option (and value (substance-option-p value)) value
                "the name of a substance, or a list of the name and a parameter, as in (bricks 20)")
  (destructuring-bind (name &optional (parameter nil given)) (ensure-list value)
    (let ((substance (find-substance name)))
      (list (substance-name substance)
            (if given parameter (whole-as-integer (substance-parameter substance)))))))

(defun map-name-for (name file)
  "Return the name of the map from FILE: NAME or, if NAME is NIL, a symbol of the current package.
The symbol is the name of FILE, with dashes for other characters than letters and digits."
  (let* ((words (substitute-if #\Space (complement #'alphanumericp)
                               (string-upcase (or (pathname-name file) ""))))
         (own (substitute #\- #\Space (one-line (string-trim " " words)))))
    (check-option :name (and (symbolp name) (not (keywordp name)) (not (eq name t))
                             (or name (some #'alpha-char-p own)))
                  name
                  (if name
                      "a symbol, but no keyword"
                      "a symbol, because the name of the file has no letters"))
    (or name (intern own))))

(defun cell-side-in-pixels (description pixels cell)
  "Return the width of a cell in pixels: PIXELS, CELL converted from metres, or 1 if both are NIL."
  (check-option :pixels (or (null pixels) (whole-p pixels 1 32767)) pixels
                "the width of a cell in pixels, an integer from 1 to 32767")
  (check-option :cell (or (null cell) (and (sane-number-p cell) (plusp cell) (null pixels))) cell
                "the width of a cell in metres, above 0; leave :pixels out")
  (if (null cell)
      (or pixels 1)
      (let* ((resolution (description-resolution description))
             (exact (/ (rational cell) resolution)) (side (max 1 (round exact))))
        (check-option :cell (and (<= side 32767) (< (abs (- exact side)) 1/1000)) cell
                      (format nil "a multiple of ~A, the width of a pixel in metres, such as ~A"
                              (decimal-notation resolution)
                              (decimal-notation (* (min side 32767) resolution))))
        side)))

;;; The form.

(defun wall-clauses (lines sort)
  (loop for (start end) in lines collect `(:wall ,start ,end ,@sort)))

(defun grid-clauses (grid walls unknown)
  "Return clauses of DEFMAP for GRID: walls of WALLS for occupied cells, and walls of UNKNOWN for
unknown cells. WALLS and UNKNOWN are lists (substance parameter)."
  (flet ((clauses (sort needed &optional (allowed needed))
           (wall-clauses (fewest-lines grid needed allowed) sort)))
    (cond ((null unknown) (clauses walls (list +occupied+)))
          ((equal unknown walls) (clauses walls (list +occupied+ +unknown+)))
          ;; Later walls replace earlier ones, so unknown lines may continue below them.
          (t (append (clauses unknown (list +unknown+) (list +unknown+ +occupied+))
                     (clauses walls (list +occupied+)))))))

(defun check-grid-size (description image side)
  "Signal UNUSABLE-FLOOR if IMAGE is too wide or high for a map with cells of SIDE pixels."
  (let ((most (ceiling (max (image-width image) (image-height image)) side)))
    (when (< 32767 most)
      (reject-floor (description-image description) nil
                    "the image would make a map of ~D cells in a row or column, and maps have at ~
                     most 32767; give IMPORT-MAP :pixels ~D or more"
                    most (ceiling (max (image-width image) (image-height image)) 32767)))))

(defun warn-of-nothing-free (description grid)
  "Warn if no cell of GRID is free though DESCRIPTION has the mode :SCALE."
  (when (and (eq :scale (description-mode description))
             (zerop (count-cells +free+ grid)))
    (warn-of-definition "~A: no cell is free. In the mode scale a shade is the probability that ~
                         the pixel is occupied, and a pixel is free below ~A (free_thresh); if ~
                         light pixels should be free, give a higher free_thresh."
                        (native-name (description-file description))
                        (decimal-notation (description-free description)))))

(defun import-report (grid frame clauses)
  (list :width (grid-width grid) :height (grid-height grid) :cell (first frame)
        :free (count-cells +free+ grid) :occupied (count-cells +occupied+ grid)
        :unknown (count-cells +unknown+ grid) :walls (length clauses)))

(addition imported-map-form)
(defun imported-map-form (file &key name pixels cell (share 0) (substance 'bricks)
                                 (unknown :walls) clauses cache (limit +most-pixels+))
  "Return the DEFMAP form that IMPORT-MAP would evaluate for the same arguments, and the plist that
it would return. Define nothing. Signals the same errors as IMPORT-MAP."
  (check-argument imported-map-form file (typep file '(or string pathname)) "the name of a file")
  (check-argument imported-map-form limit (whole-p limit 1 1000000000) "an integer from 1 to 1e9")
  (check-option :share (probability-p share) share "a number from 0 to 1")
  (let* ((walls (wall-substance :substance substance))
         (unknown (case unknown
                    (:walls walls)
                    ((nil) nil)
                    (t (wall-substance :unknown unknown))))
         (description (read-description file))
         (name (map-name-for name (description-file description)))
         (side (cell-side-in-pixels description pixels cell))
         (image (read-image (description-image description) limit (description-mode description))))
    (check-grid-size description image side)
    (let* ((grid (image-grid image description side (rational share)))
           (frame (mapcar #'double (cons (* side (description-resolution description))
                                         (description-origin description))))
           (lines (grid-clauses grid walls unknown)))
      (warn-of-nothing-free description grid)
      (values `(defmap ,name (,(grid-width grid) ,(grid-height grid) :frame ,frame
                              ,@(and cache (list :cache cache)))
                 ,@lines ,@clauses)
              (import-report grid frame lines)))))

(addition import-map)
(defun import-map (file &rest options &key name pixels cell share substance unknown clauses cache
                                        limit)
  "Define a map from an occupancy grid in the format of ROS's map_server. FILE, a string or
pathname, is the YAML file that names the image: PGM or PNG (not interlaced), by its first bytes. In
a string ~/ is the home directory, and * ? [ and \\ stand for themselves. NAME is the map's name, by
default the file's name as a symbol of the current package. OPTIONS:
  :pixels -- width of a cell in pixels, by default 1; or :cell -- its width in metres
  :share -- least share of occupied pixels that makes a cell a wall; by default 0: one is enough
  :substance -- the substance of the walls, by default bricks, or a list such as (bricks 20)
  :unknown -- what unknown cells become: :walls, the default, NIL for nothing, a substance, or a
list such as (glass 5)
  :clauses -- more clauses of DEFMAP, such as things
  :cache -- as for DEFMAP
  :limit -- the largest number of pixels accepted, by default 25000000
Return the map and a plist: :width and :height in cells, the width of a :cell in real metres, the
numbers of :free, :occupied and :unknown cells, and the number of :walls, which is as small as
possible. A robot's metre is the side of a cell, whatever the cell's real width; MAP-TO-FRAME and
FRAME-TO-MAP convert. Colours become grey as in ROS's nav2_map_server: the average of red, green and
blue. If the image has alpha, the mode trinary averages alpha in as a fourth channel; in the mode
scale a pixel that is not fully opaque is unknown; the mode raw ignores alpha. Signals
UNUSABLE-FLOOR, with the file and line, WRONG-ARGUMENT, UNKNOWN-NAME for a substance, and
MALFORMED-DEFINITION."
  (declare (ignore name pixels cell share substance unknown clauses cache limit))
  (multiple-value-bind (form report) (apply #'imported-map-form file options)
    (values (find-map (eval form)) report)))
