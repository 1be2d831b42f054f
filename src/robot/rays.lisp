;;;; rays.lisp -- fans of rays across the grid, and what cells they meet (manual 3.4, chapter 4).

(in-package :ars-magna.robot)

;;; A ray passes from cell to cell (grid-walk.lisp); a fan is a number of evenly spaced rays, turned
;;; into each other by one rotation instead of a sine and a cosine each. Nothing is allocated but
;;; a list of the cells that were found. Each is found once: while a scan lasts, the flags of the
;;; cells found carry the mark +SEEN+, so that cost depends on what is seen, neither on the size
;;; of the map nor on what exists in it.

(define-constant +seen+ 128
  :documentation "The flag of a cell that the scan under way has found; clear between scans.")
(define-constant +least-component+ 1d-12
  :documentation "Any component of a ray's direction that is nearer to 0 is taken for this.")

(deftype flag-vector () '(simple-array (unsigned-byte 8) (*)))

(declaim (inline nonzero))
(defun nonzero (component)
  "Return COMPONENT of a direction, or if it is almost 0 what is as good, whatever its sign."
  (declare (type double-float component))
  (if (< (abs component) +least-component+) +least-component+ component))

(declaim (inline walk-ray))
(defun walk-ray (visit flags width height x y dx dy reach)
  "Call VISIT with index and flags of each cell that the ray from (X,Y) in direction (DX,DY)
meets after the first, until it returns true, the map ends, or REACH columns or rows have been
crossed."
  (declare (type function visit) (type flag-vector flags) (type double-float dx dy))
  (walk-grid (lambda (index at column)
               (declare (ignore at column))
               (funcall visit index (aref flags index)))
             width height x y (nonzero dx) (nonzero dy) reach))

(defmacro do-fan ((dx dy) (angle width count) &body body)
  "Run BODY for each of COUNT directions DX, DY, evenly spaced over WIDTH radians around
ANGLE (reading 146)."
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
