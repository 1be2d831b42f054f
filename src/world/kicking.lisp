;;;; kicking.lisp -- moving a thing by a kick.

(in-package :ars-magna.world)

;;; Manual 5.3.1. The path is not checked, only where it ends. From an open container or from
;;; a hand a thing is kicked onto the floor. Off the map is as in a wall.

(defun enclosed-p (thing)
  "True if THING is in anything closed, directly or not."
  (loop for location = (thing-location thing) then (thing-location location)
        until (eq location :floor)
        thereis (and location (location-closed-p location))
        while (thing-p location)))

(defun nearest-opening (map x y from-x from-y)
  "Return the centre of the empty cell beside the one that holds X, Y that is nearest to FROM-X,
FROM-Y, as two values; NIL if all eight are filled."
  (loop with best-x = nil and best-y and least double-float = 0d0
        for (dx dy) in '((0 -1) (1 0) (0 1) (-1 0) (1 -1) (1 1) (-1 1) (-1 -1))
        for cx = (+ (floor x) dx 0.5d0) and cy = (+ (floor y) dy 0.5d0)
        for away = (+ (expt (- cx from-x) 2) (expt (- cy from-y) 2))
        do (when (and (not (wall-at-p map cx cy)) (or (null best-x) (< away least)))
             (setf best-x cx best-y cy least away))
        finally (return (values best-x best-y))))

(defun %kick-thing (thing dx dy kick-if-wall)
  (declare (type double-float dx dy))
  (multiple-value-bind (from-x from-y) (thing-position thing)
    (declare (type double-float from-x from-y))
    (let ((map (world-map (thing-world thing))) (x (+ from-x dx)) (y (+ from-y dy)))
      (when (wall-at-p map x y)
        (multiple-value-setq (x y)
          (and kick-if-wall (nearest-opening map x y from-x from-y))))
      (when x
        (relocate thing :floor x y)
        t))))

(public kick-thing)
(defun kick-thing (thing dx dy kick-if-wall)
  "Move THING by DX, DY metres (manual 5.3.1). If that ends in a wall, move it to an empty cell
beside that one (the nearest to where it was) if KICK-IF-WALL is true, or else not at all. True
if it moved; NIL also if it is inside something closed or has been destroyed (reading 172)."
  (check-argument kick-thing thing (thing-p thing) "a thing")
  (check-of-type 'kick-thing 'dx dx 'number)
  (check-of-type 'kick-thing 'dy dy 'number)
  (changing ((thing-world thing) kick-thing thing dx dy kick-if-wall)
    (and (thing-location (thing-outermost thing))
         (not (enclosed-p thing))
         (%kick-thing thing (double dx) (double dy) kick-if-wall))))

(define-operator 'kick-thing '(thing number number truth) #'kick-thing)
