;;;; bodies.lisp -- the bodies of robots: things on the floor that move with their robots.

(in-package :ars-magna.world)

(export '(make-body move-body remove-body do-cell-bodies))

;;; In a world with several robots, each robot has a body, unless the world's robots are ghosts. The
;;; body is in the list of its cell and causes flags there, as any thing. So rays, searches, tracks
;;; and motion treat robots as things. Bodies have no serial number, do not count as things of the
;;; world, and cannot be kicked, put elsewhere, destroyed, or filled.

(defun make-body (robot name attributes world x y)
  "Make the body of ROBOT in WORLD on the floor at (X,Y), with NAME and ATTRIBUTES, a descriptor."
  (let ((body (%make-body name robot world)))
    (setf (thing-attributes body) attributes)
    (update-physics-slots body)
    (add-to-stock body (world-stock world))
    (put-on-floor body x y)
    body))

(defun move-body (body x y)
  "Move BODY to (X,Y), in metres, a point of the map."
  (declare #.*hot* (type body body) (type double-float x y))
  (unless (and (= x (thing-x body)) (= y (thing-y body)))
    (move-on-floor body x y)
    (call-move-watchers body :floor :floor)))

(defun remove-body (body)
  "Remove BODY from its world."
  (remove-from-location body)
  (setf (thing-alive-p body) nil)
  (remove-thing body (thing-world body))
  (call-move-watchers body :floor nil))

(defmacro do-cell-bodies ((body index world) &body forms)
  "Run FORMS with BODY bound to each body of a robot in the cell INDEX of WORLD. FORMS must not move
bodies."
  `(do-cell-things (,body ,index ,world)
     (when (robot-body-p ,body) ,@forms)))
