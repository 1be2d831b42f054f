;;;; way-lines.lisp -- GO and GO-TO: so far ahead, and to a point of the map.

(in-package :ars-magna.cli)

(defun tell-rewound (x y simulation)
  "Queue a message that the way to (X,Y) is given up, as another run goes on in the place of
SIMULATION."
  (let ((*message-queue* (simulation-messages (latest simulation))))
    (warning-set (format nil "go-to: The run was rewound on the way to ~A ~A, and the robot goes ~
                              there no more. Say it again if it is to." x y))))

(defun tell-arrival (err robot x y)
  "Queue a message about ROBOT, which was to go to (X,Y): ERR is an error code, or NIL."
  (case err
    ((nil) (message-set (format nil "go-to: Robot is near ~A ~A, as it believes" x y)))
    (:no-way (error-set (format nil "go-to: There is no way to ~A ~A for " x y) robot))
    (:gave-up (error-set (format nil "go-to: Something was in the way to ~A ~A too often for "
                                 x y)
                         robot))
    (t (error-set (format nil "go-to: Interrupted on the way to ~A ~A" x y)))))

(defun tell-slowed (robot speed)
  "Queue a message that a line GO was interrupted, and left ROBOT with another speed than SPEED."
  (unless (= speed (robot-speed robot))
    (warning-set (format nil "go: Interrupted. The speed is ~,2F now; SET-SPEED ~,2F sets what it ~
                              was"
                         (robot-speed robot) speed))))

(define-line "GO" (session (distance distance "how far"))
    (:moving)
    "Drive DISTANCE metres straight ahead, no faster than the robot's speed. GO-FORWARD drives for a
number of ticks."
  (let ((errand (make-errand)) (speed (robot-speed (session-robot))))
    (robot-go-distance (session-robot) distance
                       (lambda (err robot)
                         (when (eq :interrupt err) (tell-slowed robot speed))
                         (setf (errand-done-p errand) t)))
    (push errand (session-errands session))))

(define-line "GO-TO" (session (x metres "metres from the left") (y metres "metres from the top"))
    (:moving)
    "Let the robot find its way to X, Y, through doorways and round obstacles."
  (let ((errand (make-errand)) (simulation (current-simulation)))
    (robot-go-to (session-robot) x y
                 (lambda (err robot)
                   (if (eq simulation (latest simulation))
                       (tell-arrival err robot x y)
                       (tell-rewound x y simulation))
                   (setf (errand-done-p errand) t)))
    (push errand (session-errands session))))
