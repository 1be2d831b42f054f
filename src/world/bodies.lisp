;;;; bodies.lisp -- the bodies of robots: things on the floor that move with their robots.

(in-package :ars-magna.world)

(export '(make-body move-body remove-body do-cell-bodies))

;;; In a world with several robots, each robot has a body, unless the world's robots are ghosts. The
;;; body is in the list of its cell and causes flags there, as any thing. So rays, searches, tracks
;;; and motion treat robots as things. Bodies have no serial number, do not count as things of the
;;; world, and cannot be kicked, put elsewhere, destroyed, or filled.

(defun put-body-in-cell (body)
  "Put BODY, which is in no cell, into the cell that it is in."
  (let ((index (thing-cell-index body)) (world (thing-world body)))
    (put-first-in-cell (thing-rank body) index (world-stock world))
    (add-flags (thing-rank body) index world)))

(defun make-body (robot name attributes world x y)
  "Make the body of ROBOT in WORLD on the floor at (X,Y), with NAME and ATTRIBUTES, a descriptor."
  (let ((body (%make-body name robot world)))
    (setf (thing-attributes body) attributes)
    (update-physics-slots body)
    (add-to-stock body (world-stock world))
    (setf (thing-x body) x (thing-y body) y (thing-location body) :floor)
    (record-thing-flags body (world-stock world))
    (put-body-in-cell body)
    body))

(defun move-body (body x y)
  "Move BODY to (X,Y), in metres, a point of the map."
  (declare #.*hot* (type body body) (type double-float x y))
  (unless (and (= x (thing-x body)) (= y (thing-y body)))
    (let ((from (thing-cell-index body)))
      (setf (thing-x body) x (thing-y body) y)
      (unless (= from (thing-cell-index body))
        (take-from-cell (thing-rank body) from (world-stock (the world (thing-world body))))
        (refresh-cell-flags (thing-world body) from)
        (put-body-in-cell body))
      (call-move-watchers body :floor :floor))))

(defun remove-body (body)
  "Remove BODY from its world."
  (take-from-floor body)
  (setf (thing-location body) nil
        (thing-alive-p body) nil)
  (call-move-watchers body :floor nil)
  (setf (body-robot body) nil))

(defmacro do-cell-bodies ((body index world) &body forms)
  "Run FORMS with BODY bound to each body of a robot in the cell INDEX of WORLD. FORMS must not move
bodies."
  `(do-cell-things (,body ,index ,world)
     (when (robot-body-p ,body) ,@forms)))
