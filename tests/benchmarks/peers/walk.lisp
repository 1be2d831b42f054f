;;;; walk.lisp -- the walk across a room as its peers do it, by continuations, as an experiment.

;;; Lines are counted by ./run under the names after "== ", as in trials.py.

;; == question
(ars:define-user-package :walk
  (:use :cl :ars)
  (:import-from :nisp #:continuation)
  (:export #:measure))

(in-package :walk)

(defmap room (14 14)
  (rect (0 0) (13 13) bricks 1))

(defrobot walker (room (1.5 1.5) 0))

(defun at-goal-p (robot)
  (and (> (robot-x robot) 12) (> (robot-y robot) 12)))

(defun next-heading (robot noise)
  "Return the heading of the next step of ROBOT, in radians: towards the goal, or at random."
  (let ((dice (world-dice *world* :user)))
    (* (/ pi 2)
       (cond ((chance noise dice) (roll-index 4 dice))
             ((<= (floor (robot-x robot)) (floor (robot-y robot))) 0)
             (t 1)))))

(defun wall-ahead-p (robot)
  (wall-at-p (find-map 'room)
             (+ (robot-x robot) (cos (robot-angle robot)))
             (+ (robot-y robot) (sin (robot-angle robot)))))

(defun walk (robot noise steps ended)
  "Let ROBOT take STEPS, or fewer if it is at the goal before, and call ENDED."
  (flet ((go-on (err robot)
           (declare (ignore err))
           (walk robot noise (1- steps) ended)))
    (if (or (zerop steps) (at-goal-p robot))
        (funcall ended)
        (robot-turn robot (- (next-heading robot noise) (robot-angle robot))
          (continuation (err robot angle)
            (if (wall-ahead-p robot)
                (go-on err robot)
                (robot-go-forward robot 1 #'go-on)))))))

(defun walked-p (robot noise steps)
  "True if ROBOT gets to the goal within STEPS."
  (let ((ended nil))
    (robot-set-speed robot 1)
    (robot-set-turn-angle robot pi)
    (walk robot noise steps (lambda () (setf ended t)))
    (run-until (lambda () ended))
    (at-goal-p robot)))

(defexperiment walking
  "How often does a walker get across the room, the more of its steps are random?"
  (:robots walker)
  (:clean)
  (:parameters (max-turn-angle* pi) (robot-turn-delay* 0) (robot-move-delay* 0))
  (:vary (noise 0 1/10 2/10 4/10 6/10))
  (:trials 1000)
  (:run (walked-p walker noise 40)))

;; == measuring
(defun success-rate (sample)
  (/ (count "success" (sample-outcomes sample) :test #'string=)
     (float (length (sample-outcomes sample)))))

(defun measure (cores directory)
  "Do all trials on CORES cores, with a table in DIRECTORY; print the figures that ./run wants."
  (let* ((start (get-internal-real-time))
         (results (run-experiment 'walking :workers cores :directory directory :stream nil))
         (seconds (/ (- (get-internal-real-time) start) internal-time-units-per-second 1.0)))
    (format t "~&~{~A~^|~}~%"
            (list* "ARS MAGNA" cores seconds (mapcar #'success-rate (results-samples results))))))
