;;;; crossing.lisp -- what it costs to cross the square between the middles of four cells.

;;; Ways run between the middles of cells, the nodes. Four of them are the corners of a square. A
;;; metre in it costs what it does in the dearest of the four cells; a metre on the line between two
;;; neighbouring nodes what it does in the dearer one. So there is no way into a square with a wall
;;; at a corner: ways keep half a metre off all walls, and go through the middle of a doorway that
;;; is one cell wide.
;;;
;;; From a node a way may cross a square to any point of the two sides opposite. What the goal
;;; costs from there is known for the corners, and taken to change evenly between them. That is
;;; Field D*: D. Ferguson and A. Stentz, "Using interpolation to improve path planning: the Field
;;; D* algorithm", Journal of Field Robotics 23(2), 2006.

(in-package :ars-magna.ways)

(defconstant +diagonal+ (sqrt 2d0) "The length of a square's diagonal, in metres.")

(declaim (inline crossing-by))
(defun crossing-by (straight diagonal edge square)
  "Return what the goal costs from a node by way of the side of a square opposite: STRAIGHT and
DIAGONAL are what it costs from the ends of that, EDGE and SQUARE what a metre costs on the line to
the first, and in the square. The result is larger than what it depends on, by a third at least."
  (declare (type double-float straight diagonal edge square))
  (let ((drop (- straight diagonal)) (along (+ edge straight)))
    (if (or (<= drop 0d0) (>= square +barred+))
        along
        (let ((slope (min drop edge)))
          (min along
               (if (< (* slope +diagonal+) square)
                   ;; The best point is on the side.
                   (+ diagonal slope (sqrt (the (double-float 0d0) (- (* square square)
                                                                      (* slope slope)))))
                   (+ diagonal (* square +diagonal+))))))))
