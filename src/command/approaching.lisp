;;;; approaching.lisp -- going to what a camera tracks (manual 3.5).

(in-package :ars-magna.command)

;;; The robot turns in place until it faces the designator, as far as it knows, and then drives,
;;; making up each tick for what the designator has moved sideways. It has arrived when it is in
;;; the cell of what is denoted. The track tells where to go, so losing it ends the approach. A
;;; false designator cannot be arrived at: the track is lost there.

(defun at-designator-p (robot designator)
  "True if ROBOT is in the cell of what DESIGNATOR denotes (reading 110)."
  (and (designator-denotation designator)
       (multiple-value-bind (x y) (designator-position designator)
         (and x (in-same-cell-p robot x y)))))

(defun turn-to-designator (robot designator)
  "Turn ROBOT towards DESIGNATOR, by no more than a tick's turn. True if it then faces it as well as
can be told."
  (let ((angle (angle-difference (designator-angle designator) 0)))
    (or (<= (abs angle) (max 1d-9 (double camera-angle-max-error*)))
        (< (abs (turn-step robot angle)) +facing+))))

(defun approach-step (operation robot camera designator)
  "Take ROBOT one tick nearer to DESIGNATOR, tracked by CAMERA, and end OPERATION if that ends
it (reading 111)."
  (cond ((at-designator-p robot designator) (succeed operation camera designator))
        ((not (tracking-p camera designator))
         (fail-with operation :not-tracking camera designator))
        ((zerop (robot-speed-now robot)) (fail-with operation :not-moving camera designator))
        ((turn-to-designator robot designator)
         (let ((block (drive-tick robot (designator-distance designator))))
           (cond ((at-designator-p robot designator) (succeed operation camera designator))
                 (block (fail-with operation :robot-blocked camera designator)))))))

(defun approach-on (operation)
  "Go on for a tick to the designator that is the subject of OPERATION."
  (approach-step operation (operation-resource operation)
                 (first (operation-arguments operation)) (operation-subject operation))
  (unless (operation-finished-p operation) (once-more operation)))

(defun approach (operation robot designator)
  "Let ROBOT go to DESIGNATOR, beginning in this tick."
  (begin-movement robot)
  (setf (operation-subject operation) designator)
  (go-on-now operation 'approach-on))

;; As reading 109 says.
(define-command robot-goto-designator (operation (robot robot)
                                       (camera camera "the camera that tracks the designator"))
    ((camera "the camera")
     (designator "the designator that it tracked"))
    ((:family :moving) (:section "3.5") (:delay robot-move-delay*)
     (:errors (:not-tracking (lambda (operation)
                               (format nil "~A is not tracking anything"
                                       (first (operation-arguments operation)))))
              (:goto-local "The designator is local: the robot is there already")
              (:robot-blocked "Robot is blocked")
              (:not-moving "Robot cannot move: its speed is 0"))
     (:report (camera designator) (format nil "Robot is at ~A" designator)))
    "Drive ROBOT next to what CAMERA tracks, into the same cell."
  (let ((designator (and (eq (camera-robot camera) robot) (camera-tracks camera))))
    (cond ((null designator) (fail-with operation :not-tracking camera))
          ((eq (designator-type designator) :local)
           (fail-with operation :goto-local camera designator))
          (t (approach operation robot designator)))))
