;;;; text-layers.lisp -- what a text map shows on demand: fields of view, ways, beliefs.

(in-package :ars-magna.display)

;;; A layer is a list of pairs of the number of a block and of the glyph that is to be seen there.

(define-constant +text-layers+ '(:cones :way :plan :belief)
  :test #'cl:equal
  :documentation "What a text map shows on demand: CONES, what is in the fields of view of the
robot's cameras; WAY, where the robot went, as far as a history was kept; PLAN, which way it is
about to go, as far as its program has told; BELIEF, where it believes itself and what its
designators denote to be.")

(defun glyph-at (view x y glyph)
  "Return a list of the pair of the block of VIEW at X, Y and of GLYPH, or NIL if it is outside."
  (let ((number (block-at view x y)))
    (and number (list (cons number glyph)))))

;;; Cones.

(define-constant +ray-spacing+ 0.01d0
  :documentation "How far apart the lines are that find what is in a field of view, in radians.")

(defun cells-seen (world x y angle)
  "Return the indices of the cells of WORLD that a camera at X, Y sees in direction ANGLE."
  (let ((map (world-map world)) (flags (world-flags world)) (indices '()))
    (walk-grid (lambda (index at column)
                 (declare (ignore at column))
                 (push index indices)
                 (logtest +opaque+ (aref flags index)))
               (map-width map) (map-height map) x y (cosine angle) (sine angle) +no-limit+)
    indices))

(defun cone (view camera)
  "Return the numbers of the blocks of VIEW that have something in the field of view of CAMERA."
  (let* ((robot (camera-robot camera))
         (x (robot-x robot)) (y (robot-y robot))
         (width (camera-field-of-view camera))
         (count (max 1 (ceiling width +ray-spacing+)))
         (first (- (+ (robot-angle robot) (camera-angle camera)) (/ width 2))))
    (remove-duplicates
     (loop for ray to count
           append (loop for index in (cells-seen (robot-world robot) x y
                                                 (+ first (* ray (/ width count))))
                        when (block-of-index view index) collect it)))))

(defun cones-layer (view robot)
  (let ((glyph (make-glyph :layer #\` (format nil "in view of ~A" robot) :yellow)))
    (when (robot-cell-index robot)
      (loop for camera across (robot-cameras robot)
            unless (camera-location camera)
              append (loop for number in (cone view camera) collect (cons number glyph))))))

;;; Ways.

(defun way-layer (view robot)
  (let ((glyph (make-glyph :layer #\+ (format nil "way of ~A" robot) :green)))
    (do-trail ((points-of-trail robot) x y)
          append (glyph-at view x y glyph))))

(defconstant +way-spacing+ 0.2d0
  "How far apart the points of a planned way are that are shown, in metres.")

(defun points-between (from to)
  "Return points, lists (x y), on the line between the points FROM and TO, both with it."
  (destructuring-bind ((x y) (dx dy)) (list from (mapcar #'- to from))
    (let ((count (max 1 (ceiling (sqrt (+ (* dx dx) (* dy dy))) +way-spacing+))))
      (loop for i to count
            collect (list (+ x (* dx (/ i count))) (+ y (* dy (/ i count))))))))

(defun plan-layer (view robot)
  (let ((glyph (make-glyph :layer #\: (format nil "planned way of ~A" robot) :cyan)))
    (loop for (from to) on (robot-way-left robot)
          while to
          append (loop for (x y) in (points-between from to)
                       append (glyph-at view x y glyph)))))

;;; Beliefs.

(defun own-position-layer (view robot)
  "Return where the main odometer of ROBOT puts it."
  (let* ((odometer (image-of-odometer robot))
         (x (odometer-image-x odometer)) (y (odometer-image-y odometer)))
    (glyph-at view x y
              (make-glyph :robot #\@
                          (format nil "believed (~,2F,~,2F)" (hundredths x) (hundredths y))
                          :bold))))

(defun designator-layer (view robot designator)
  "Return where ROBOT believes what DESIGNATOR denotes to be: it knows that from where it is."
  (let ((angle (+ (robot-angle robot) (designator-angle designator)))
        (distance (designator-distance designator)))
    (glyph-at view
              (+ (robot-x robot) (* distance (cosine angle)))
              (+ (robot-y robot) (* distance (sine angle)))
              (make-glyph :layer (digit-char (mod (designator-number designator) 10))
                          (format nil "~A" designator) :bold))))

(defun belief-layer (view robot)
  (append (and (robot-main-odometer robot) (own-position-layer view robot))
          (loop for designator in (live-designators robot)
                append (designator-layer view robot designator))))

(defun layer-of (view robot layer)
  "Return the pairs that LAYER, one of +TEXT-LAYERS+, has for ROBOT in VIEW."
  (ecase layer
    (:cones (cones-layer view robot))
    (:way (way-layer view robot))
    (:plan (plan-layer view robot))
    (:belief (belief-layer view robot))))
