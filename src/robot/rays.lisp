;;;; rays.lisp -- fans of rays across the grid, and what cells they meet (manual 3.4, chapter 4).

(in-package :ars-magna.robot)

;;; A ray passes from cell to cell (a digital differential analyser over the flags), a fan is a
;;; number of evenly spaced rays, turned into each other by one rotation instead of a sine and a
;;; cosine each. Nothing is allocated but a list of the cells that were found. Each is found once:
;;; while a scan lasts, the flags of the cells found carry the mark +SEEN+, so that cost depends
;;; on what is seen, neither on the size of the map nor on what exists in it.

(define-constant +seen+ 128
  :documentation "The flag of a cell that the scan under way has found; clear between scans.")
(define-constant +opaque+ (logior +wall+ +obsview+)
  :documentation "The flags of a cell that ends a ray.")

(deftype flag-vector () '(simple-array (unsigned-byte 8) (*)))
(deftype grid-size () '(unsigned-byte 15))

(declaim (inline walk-ray))
(defun walk-ray (visit flags width height x y dx dy reach)
  "Call VISIT with index and flags of each cell that the ray from (X,Y) in direction (DX,DY)
meets after the first, until it returns true, the map ends, or REACH columns or rows have been
crossed."
  (declare (type function visit) (type flag-vector flags) (type grid-size width height)
           (type double-float x y dx dy) (type (unsigned-byte 15) reach))
  (let* ((cell-x (the grid-size (truncate (the (double-float 0d0 32767d0) x))))
         (cell-y (the grid-size (truncate (the (double-float 0d0 32767d0) y))))
         (back-x (< dx 0d0)) (back-y (< dy 0d0))
         (step-x (if back-x -1 1)) (step-y (if back-y (- width) width))
         (left-x (min reach (if back-x cell-x (- width cell-x 1))))
         (left-y (min reach (if back-y cell-y (- height cell-y 1))))
         (per-x (abs (/ 1d0 dx))) (per-y (abs (/ 1d0 dy)))
         (at-x (* per-x (if back-x (- x cell-x) (- (1+ cell-x) x))))
         (at-y (* per-y (if back-y (- y cell-y) (- (1+ cell-y) y))))
         (index (+ cell-x (* cell-y width))))
    (declare (type fixnum left-x left-y step-x step-y) (type double-float per-x per-y at-x at-y)
             (type cell-index index))
    (loop
      (cond ((< at-x at-y)
             (when (< (decf left-x) 0) (return))
             (setf at-x (+ at-x per-x)
                   index (the cell-index (+ index step-x))))
            (t
             (when (< (decf left-y) 0) (return))
             (setf at-y (+ at-y per-y)
                   index (the cell-index (+ index step-y)))))
      (when (funcall visit index (aref flags index)) (return)))))

(declaim (inline nonzero))
(defun nonzero (component)
  "Return COMPONENT of a direction, or if it is almost 0 what is as good and can be divided by."
  (declare (type double-float component))
  (if (< (abs component) 1d-12) 1d-12 component))

(defmacro do-fan ((dx dy) (angle width count) &body body)
  "Run BODY for each of COUNT directions DX, DY, evenly spaced over WIDTH radians around ANGLE."
  (with-gensyms (spacing first cos sin)
    `(let* ((,spacing (/ ,width ,count))
            (,first (- ,angle (* 0.5d0 (- ,width ,spacing))))
            (,cos (cos ,spacing)) (,sin (sin ,spacing))
            (,dx (cos ,first)) (,dy (sin ,first)))
       (declare (type double-float ,spacing ,first ,cos ,sin ,dx ,dy))
       (loop repeat ,count
             do (progn ,@body)
                (psetf ,dx (- (* ,dx ,cos) (* ,dy ,sin))
                       ,dy (+ (* ,dx ,sin) (* ,dy ,cos)))))))
