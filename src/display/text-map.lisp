;;;; text-map.lisp -- the world as characters, for terminals.

(in-package :ars-magna.display)

;;; Each character stands for a square block of cells, so many that the picture is no wider than
;;; asked for; what matters most in the block shows: a robot, things, walls, a place. Nothing is
;;; changed by looking, and no dice are rolled.

(define-constant +place-glyphs+ "=:.;,'~\"|-/\\_" :test #'equal
  :documentation "What place types look like, by their rank; the rest look like the last.")

(defstruct (view (:copier nil))
  "Which cells a picture shows: COLUMNS x ROWS blocks of SCALE x SCALE cells from LEFT and TOP."
  (world nil :type world :read-only t)
  (left 0 :type fixnum :read-only t)
  (top 0 :type fixnum :read-only t)
  (columns 1 :type (integer 1) :read-only t)
  (rows 1 :type (integer 1) :read-only t)
  (scale 1 :type (integer 1) :read-only t)
  ;; What has been drawn: lists (glyph text) in order of their first appearance.
  (legend '() :type list))

(defun view-map (view) (world-map (view-world view)))

(defun explain (view glyph text)
  "Let the legend of VIEW say that GLYPH stands for TEXT. Return GLYPH."
  (let ((entry (list glyph text)))
    (unless (member entry (view-legend view) :test #'equal)
      (setf (view-legend view) (append (view-legend view) (list entry)))))
  glyph)

;;; Which glyph.

(defun arrow-glyph (angle)
  "Return the arrow that points most nearly in the direction ANGLE, in radians."
  (char ">v<^" (mod (round angle (/ pi 2)) 4)))

(defun names-text (things)
  "Return what THINGS are called, each name once."
  (format nil "~{~A~^, ~}" (remove-duplicates (mapcar #'thing-name things) :from-end t)))

(defun robot-glyph (view robots things)
  "Return the glyph of the first of ROBOTS, which stands on THINGS."
  (let ((robot (first robots)))
    (multiple-value-bind (x y) (robot-position robot)
      (explain view (arrow-glyph (robot-angle robot))
               (format nil "~A (~,2F,~,2F)~:[ with ~A~;~]" robot x y (null things)
                       (names-text things))))))

(defun things-glyph (view things)
  "Return the initial of what the THINGS of a block are called, or * if they differ in name."
  (let ((names (remove-duplicates (mapcar #'thing-name things))))
    (dolist (name names)
      (explain view (char-downcase (char (symbol-name name) 0)) (symbol-name name)))
    (if (rest names)
        (explain view #\* "several things")
        (char-downcase (char (symbol-name (first names)) 0)))))

(defun place-glyph (view type)
  (explain view
           (char +place-glyphs+ (min (place-type-rank type) (1- (length +place-glyphs+))))
           (string-downcase (place-type-name type))))

(defun block-glyph (view indices robots)
  "Return the glyph for the block of VIEW that consists of the cells INDICES and holds ROBOTS."
  (let* ((map (view-map view))
         (things (loop for index in indices
                       append (svref (world-cells (view-world view)) index)))
         (place (find-if #'plusp (mapcar (lambda (index) (aref (map-places map) index)) indices))))
    (cond (robots (robot-glyph view robots things))
          (things (things-glyph view things))
          ((some (lambda (index) (logtest +wall+ (aref (map-flags map) index))) indices) #\#)
          (place (place-glyph view (svref (map-place-types map) place)))
          (t #\Space))))

;;; Drawing.

(defun block-indices (view column row)
  "Return the indices of the cells of the block at COLUMN and ROW of VIEW."
  (let ((scale (view-scale view))
        (map (view-map view)))
    (loop for y from (+ (view-top view) (* row scale)) repeat scale
          append (loop for x from (+ (view-left view) (* column scale)) repeat scale
                       when (map-index map x y) collect it))))

(defun robots-in (view indices)
  (remove-if-not (lambda (robot) (member (robot-cell-index robot) indices))
                 (world-robots (view-world view))))

(defun write-row (view row stream)
  (format stream "~4D " (+ (view-top view) (* row (view-scale view))))
  (write-string
   (string-right-trim
    " " (coerce (loop for column below (view-columns view)
                      for indices = (block-indices view column row)
                      collect (block-glyph view indices (robots-in view indices)))
                'string))
   stream)
  (terpri stream))

(defun write-ruler (view stream)
  "Write the x coordinate of every tenth column."
  (let ((marks (loop for column from 0 below (view-columns view) by 10
                     collect (+ (view-left view) (* column (view-scale view))))))
    (format stream "     ~A~%" (string-right-trim " " (format nil "~{~10A~}" marks)))))

(defun write-legend (view columns stream)
  "Explain the glyphs of VIEW in lines of at most COLUMNS characters."
  (when (> (view-scale view) 1)
    (format stream "Each character is ~D x ~:*~D cells.~%" (view-scale view)))
  (let ((line "# wall"))
    (loop for (glyph text) in (view-legend view)
          for longer = (format nil "~A   ~C ~A" line glyph text)
          do (if (<= (length longer) columns)
                 (setf line longer)
                 (format stream "~A~%" (shiftf line (format nil "~C ~A" glyph text)))))
    (format stream "~A~%" line)))

(defun draw (view columns stream)
  (write-ruler view stream)
  (dotimes (row (view-rows view)) (write-row view row stream))
  (write-legend view columns stream))

(defun whole-view (world columns)
  "Return a view of all of WORLD that is at most COLUMNS characters wide."
  (let* ((map (world-map world))
         (scale (ceiling (map-width map) columns)))
    (make-view :world world :scale scale
               :columns (ceiling (map-width map) scale)
               :rows (ceiling (map-height map) scale))))

(defun near-view (robot radius columns)
  "Return a view of what is no more than RADIUS cells from ROBOT."
  (let* ((world (robot-world robot))
         (map (world-map world))
         (radius (min radius (floor (1- columns) 2)))
         (left (max 0 (- (floor (robot-x robot)) radius)))
         (top (max 0 (- (floor (robot-y robot)) radius))))
    (make-view :world world :left left :top top
               :columns (max 1 (- (min (map-width map) (+ (floor (robot-x robot)) radius 1)) left))
               :rows (max 1 (- (min (map-height map) (+ (floor (robot-y robot)) radius 1)) top)))))

(addition text-map)
(defun text-map (robot &key (columns 80) radius)
  "Return a string that shows the world of ROBOT in lines of at most COLUMNS characters: walls,
places, things by their initials, robots as arrows, and what it all means. With RADIUS, a
number of cells, it shows only the surroundings of ROBOT. Call it where the world stands still.
Signals WRONG-ARGUMENT."
  (check-argument text-map robot (robot-p robot) "a robot")
  (check-argument text-map columns (whole-p columns 10 100000) "an integer from 10 to 100000")
  (check-argument text-map radius (or (null radius) (whole-p radius))
                  "a whole number of cells, from 0 to 1e9, or NIL")
  (with-output-to-string (stream)
    (draw (if radius
              (near-view robot radius (- columns 5))
              (whole-view (robot-world robot) (- columns 5)))
          columns stream)))
