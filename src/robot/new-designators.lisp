;;;; new-designators.lisp -- giving a robot a designator, and making room for it (manual 3.4.1).

(in-package :ars-magna.robot)

(export '(add-designator))

(defun forget-oldest (robot)
  "Drop the oldest designator of ROBOT that no camera tracks."
  (let ((oldest nil))
    (dolist (designator (live-designators robot))
      (when (and (or (null oldest)
                     (< (designator-serial designator) (designator-serial oldest)))
                 (not (tracked-p designator)))
        (setf oldest designator)))
    (when oldest (drop-designator oldest))))

(defun add-designator (robot &key (type :non-local) (angle 0d0) (distance 0d0) data denotation
                                  x y location)
  "Return a new designator of ROBOT: of TYPE, for DENOTATION (a THING, a PLACE, or NIL for one that
seems to be at X, Y), seen at DISTANCE metres and at ANGLE to the heading, described by
DATA, in LOCATION (NIL: in the open)."
  (when (>= (length (robot-designators robot)) *designator-limit*) (forget-oldest robot))
  (let ((designator (make-designator :type type :robot robot :data data :location location
                                     :denotation denotation
                                     :angle (double angle) :distance (double distance)
                                     :x (double (or x 0)) :y (double (or y 0)))))
    (unless x
      (multiple-value-bind (x y) (designator-position designator)
        (setf (designator-x designator) (double x)
              (designator-y designator) (double y))))
    (pushnew #'watch-thing (world-move-watchers (robot-world robot)))
    (take-number robot designator)))
