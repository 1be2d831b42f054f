;;;; text-layers.lisp -- what a text map shows on demand: fields of view, ways, beliefs.

(in-package :ars-magna.display)

;;; These are called by layers.lisp. Each returns a list of pairs of the number of a block and of
;;; the glyph that is to be seen there.

(defun mark-at (view x y glyph)
  "Return a list of the pair of the block of VIEW at X, Y and of GLYPH, or NIL if it is outside."
  (let ((number (block-at view x y)))
    (and number (list (cons number glyph)))))

;;; Cones.

(define-constant +ray-spacing+ 0.01d0
  :documentation "How far apart the lines are that find what is in a field of view, in radians.")

(defun cells-seen (map opaque-p x y angle)
  "Return the indices of the cells of MAP that a camera at X, Y sees in direction ANGLE."
  (let ((indices '()))
    (walk-grid (lambda (index at column)
                 (declare (ignore at column))
                 (push index indices)
                 (funcall opaque-p index))
               (map-width map) (map-height map) x y (cosine angle) (sine angle) +no-limit+)
    indices))

(defun cone (view robot camera)
  "Return the numbers of the blocks of VIEW that have something in the field of view of CAMERA."
  (let* ((width (camera-image-field-of-view camera))
         (count (max 1 (ceiling width +ray-spacing+)))
         (first (- (+ (robot-image-angle robot) (camera-image-angle camera)) (/ width 2)))
         (opaque-p (opaque-cells (view-snapshot view))))
    (remove-duplicates
     (loop for ray to count
           append (loop for index in (cells-seen (view-map view) opaque-p
                                                 (robot-image-x robot) (robot-image-y robot)
                                                 (+ first (* ray (/ width count))))
                        when (block-of-index view index) collect it)))))

(defun cone-marks (view robot)
  (let ((glyph (make-glyph :layer #\` (format nil "in view of ~A" (robot-image-name robot))
                           :yellow)))
    (loop for camera in (remove-if-not #'looking-out (robot-image-cameras robot))
          append (loop for number in (cone view robot camera) collect (cons number glyph)))))

;;; Ways.

(defun trail-marks (view robot)
  (let ((glyph (make-glyph :layer #\+ (format nil "way of ~A" (robot-image-name robot)) :green)))
    (do-trail ((robot-image-trail robot) x y)
          append (mark-at view x y glyph))))

(defconstant +way-spacing+ 0.2d0
  "How far apart the points of a planned way are that are shown, in metres.")

(defun points-between (from to)
  "Return points, lists (x y), on the line between the points FROM and TO, both with it."
  (destructuring-bind ((x y) (dx dy)) (list from (mapcar #'- to from))
    (let ((count (max 1 (ceiling (sqrt (+ (* dx dx) (* dy dy))) +way-spacing+))))
      (loop for i to count
            collect (list (+ x (* dx (/ i count))) (+ y (* dy (/ i count))))))))

(defun planned-marks (view robot)
  (let ((glyph (make-glyph :layer #\: (format nil "planned way of ~A" (robot-image-name robot))
                           :cyan)))
    (loop for (from to) on (robot-image-planned-way robot)
          while to
          append (loop for (x y) in (points-between from to)
                       append (mark-at view x y glyph)))))

;;; Beliefs.

(defun own-position-marks (view odometer)
  (let ((x (odometer-image-x odometer)) (y (odometer-image-y odometer)))
    (mark-at view x y (make-glyph :robot #\@
                                  (format nil "believed (~,2F,~,2F)" (hundredths x) (hundredths y))
                                  :bold))))

(defun designator-marks (view robot designator)
  "Return where ROBOT believes what DESIGNATOR denotes to be: it knows that from where it is."
  (destructuring-bind (x y)
      (around (robot-image-x robot) (robot-image-y robot)
              (+ (robot-image-angle robot) (designator-image-angle designator))
              (designator-image-distance designator))
    (mark-at view x y
             (make-glyph :layer (digit-char (mod (designator-image-number designator) 10))
                         (subject-title designator) :bold))))

(defun belief-marks (view robot)
  (append (and (robot-image-odometer robot)
               (own-position-marks view (robot-image-odometer robot)))
          (loop for designator in (robot-image-designators robot)
                append (designator-marks view robot designator))))
