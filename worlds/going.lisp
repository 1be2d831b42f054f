;;;; going.lisp -- a robot goes to a point of its map: with continuations instead of a plan.

;;; For programs without plans, and for the command GO-TO of the prompt. It takes the same steps and
;;; keeps the same reckoning as the plan TRAVEL-TO (see doorways.lisp). Each step is a function that
;;; issues a command and returns; its continuation takes the next step. Steps share a JOURNEY.
;;;
;;;   (with-simulation (ars-worlds:marvin :seed 1)
;;;     (ars-worlds:robot-go-to ars-worlds:marvin 109 24
;;;       (continuation (err robot) (out (or err "there") t)))
;;;     (run-ticks 500))

(in-package :ars-worlds)
(in-readtable :nisp)

;;; A newer command interrupts an older one, whose continuation receives :INTERRUPT. But a program
;;; may be waiting for a camera when another program, or STOP, commands the robot. So a CLAIM
;;; compares how many commands the robot has received with how many the program itself has issued.

(defun commands-received (robot) (ars-magna.time:resource-asked robot))

(defstruct (claim (:constructor nil) (:copier nil))
  "A program's claim on a robot: the robot, and how many commands it should have received by now. If
the robot has received more commands, another program has taken it over."
  (robot nil :type robot :read-only t)
  (asked 0 :type integer))

(defun robot-to-command (claim)
  "Return the robot of CLAIM, and count the command that is about to be issued to it."
  (incf (claim-asked claim))
  (claim-robot claim))

(defun taken-over-p (claim)
  (/= (claim-asked claim) (commands-received (claim-robot claim))))

(defun must-end-p (claim err)
  "True if the program with CLAIM has to end: ERR, the error code of its last command, is
:INTERRUPT, or another program has taken over its robot."
  (or (eq err :interrupt) (taken-over-p claim)))

;;; Journeys.

(defstruct (journey (:include claim) (:copier nil))
  "The goal and reckoning of a robot. The journey ends after STEPS steps or PATIENCE obstacles."
  (me nil :type reckoning :read-only t)
  (goal '() :type list :read-only t)
  (tolerance 1 :type real :read-only t)
  (camera nil :read-only t)
  (continuation nil :read-only t)
  (steps 300 :type fixnum)
  (patience 40 :type fixnum))

(defun free-goal-near (chart x y)
  "Return the point (X,Y), a list, or the nearest free point on CHART. Signals WRONG-ARGUMENT."
  (let ((point (nearest-free-point chart (list x y))))
    (unless point
      (ars-magna.base:reject-argument 'robot-go-to "the point" (list x y)
                                      (format nil "the coordinates of a point of ~A, within five ~
                                                   cells of a free cell"
                                              (chart-map chart))))
    (point-as-list point)))

(defun check-go-to-arguments (robot x y continuation start tolerance patience)
  (check-arguments 'robot-go-to
                   (list (typep robot 'robot) "robot" robot "a robot")
                   (list (realp x) "x" x "a number of metres from the left")
                   (list (realp y) "y" y "a number of metres from the top")
                   (list (ars-magna.base:argument-of-type-p continuation 'continuation)
                         "continuation" continuation
                         (ars-magna.base:argument-type-text 'continuation))
                   (list (or (null start) (number-list-p start 3)) ":start" start
                         "a list (x y heading) of numbers, or NIL"))
  (check-tolerance-and-patience 'robot-go-to tolerance patience))

(defun robot-go-to (robot x y continuation &key start (tolerance 1) (patience 40))
  "Make ROBOT go to the point (X,Y) of its map, or the nearest free point, to within TOLERANCE
metres. ROBOT drives through doorways and round obstacles, by its odometer, its place sense and a
camera. It waits for other robots in the way, plans another way or gives way to them. START is its
position, a list (x y heading); the default is the true position. Returns at once. The robot's
current command is interrupted, even if the robot is at the goal already. At the end CONTINUATION,
unless it is NIL, is called once with an error code or NIL, and ROBOT. The codes:
- :NO-WAY if no way leads there.
- :GAVE-UP after PATIENCE obstacles, or 300 steps.
- :INTERRUPT if another command took over the robot or the camera, or the run ended or was rewound.
Signals WRONG-ARGUMENT if no free point is near (X,Y), or an argument is invalid."
  (check-go-to-arguments robot x y continuation start tolerance patience)
  (let* ((me (begin-reckoning (or start (here robot)) robot))
         (goal (free-goal-near (reckoning-chart me) x y)))
    (grab-resource robot (robot-simulation robot))
    (continue-journey (make-journey :robot robot :asked (commands-received robot) :me me :goal goal
                                    :tolerance tolerance :patience patience
                                    :camera (camera-with-widest-view robot)
                                    :continuation continuation))
    (values)))

(defun end-journey (journey err)
  "End JOURNEY with the error code ERR, or NIL for success."
  (show-way (journey-me journey) '())
  (when (journey-continuation journey)
    (funcall (journey-continuation journey) err (journey-robot journey))))

(defun continue-after-command (journey err next otherwise)
  "Call NEXT, a function of no arguments, if a command ended without an error code ERR, else
OTHERWISE. If the command was interrupted or another program took over the robot, end JOURNEY."
  (cond ((must-end-p journey err) (end-journey journey :interrupt))
        (err (funcall otherwise))
        (t (funcall next))))

(defun continue-journey (journey)
  "Take JOURNEY's next step, or end JOURNEY: at the goal, without a way, or after too many steps."
  (let* ((me (journey-me journey)) (goal (journey-goal journey))
         (ticks (ticks-at-passing-place me))
         (step (next-step-of me (present-goal me goal))))
    (cond ((<= (distance-left me goal) (journey-tolerance journey)) (end-journey journey nil))
          ((null step) (end-journey journey :no-way))
          ((zerop (decf (journey-steps journey))) (end-journey journey :gave-up))
          (ticks (wait-on-journey journey ticks))
          ((eq :door (first step))
           (face-point journey (middle-of (second step))
                       (lambda () (drive-through-doorway journey (second step) (third step)))))
          (t (drive-to-point journey (second step) #'continue-journey)))))

;;; Driving.

(defun face-point (journey point next)
  (robot-turn (robot-to-command journey) (angle-towards (journey-me journey) point)
    (continuation (err robot angle) (continue-after-command journey err next next))))

(defun drive-to-point (journey point next)
  "Drive the robot of JOURNEY straight to POINT, then call NEXT, a function of JOURNEY."
  (face-point journey point
              (lambda ()
                (drive-straight journey (distance-left (journey-me journey) point) next))))

(defun drive-metres (claim metres top continuation)
  "Drive the robot of CLAIM straight ahead by METRES, in whole ticks, at most TOP metres per tick.
CONTINUATION gets an error code or NIL, and the robot."
  (let ((ticks (if (plusp top) (max 1 (ceiling metres top)) 1)))
    (robot-set-speed (robot-to-command claim) (/ metres ticks)
      (continuation (err robot speed)
        (if (must-end-p claim err)
            (funcall continuation :interrupt robot)
            (robot-go-forward (robot-to-command claim) ticks continuation))))))

(defun drive-straight (journey distance next)
  "Drive the robot of JOURNEY ahead by DISTANCE metres, then call NEXT, a function of JOURNEY."
  (if (< distance .05)
      (funcall next journey)
      (drive-metres journey distance driving-speed*
        (continuation (err robot)
          (continue-after-command journey err
                                  (lambda () (funcall next journey))
                                  (lambda () (continue-after-obstacle journey)))))))

;;; Obstacles.

(defun continue-after-obstacle (journey)
  "Continue JOURNEY after something has stopped the robot: correct the reckoning by a wall, or bar
the cells of a thing. In a world with several robots, first find out which of the two it is."
  (let ((me (journey-me journey)))
    (reckon me)
    (cond ((meets-robots-p me) (feel-obstacle journey))
          (t (unless (correct-by-wall me) (bar-cell-ahead me))
             (try-again journey)))))

(defun feel-obstacle (journey)
  "Find out what stopped the robot of JOURNEY, as FEEL-AHEAD does, and continue JOURNEY."
  (drive-metres journey .1 .1
    (continuation (err robot)
      (continue-after-command journey err
                              (lambda () (continue-journey journey))
                              (lambda () (feel-wall journey))))))

(defun feel-wall (journey)
  "Something stands directly ahead of the robot of JOURNEY. If it is a wall, correct the reckoning.
If it is a robot or a thing, bar its cell and give way."
  (let ((me (journey-me journey)))
    (robot-goto-wall (robot-to-command journey)
      (continuation (err robot)
        (continue-after-command journey err
                                (lambda ()
                                  (reckon me)
                                  (correct-by-wall me)
                                  (try-again journey))
                                (lambda ()
                                  (reckon me)
                                  (bar-cell-ahead me)
                                  (give-way-on-journey journey)))))))

(defun give-way-on-journey (journey)
  (if (zerop (decf (journey-patience journey)))
      (end-journey journey :gave-up)
      (wait-on-journey journey (give-way (journey-me journey)))))

(defun wait-on-journey (journey ticks)
  "Continue JOURNEY after some TICKS. The robot turns by 0 meanwhile: so another program, or STOP,
can interrupt it."
  (if (plusp ticks)
      (robot-turn (robot-to-command journey) 0
        (continuation (err robot angle)
          (flet ((on () (wait-on-journey journey (- ticks (max 1 robot-turn-delay*)))))
            (continue-after-command journey err #'on #'on))))
      (continue-journey journey)))

(defun try-again (journey)
  "Continue JOURNEY after an obstacle. Every third time, turn away and drive two metres first."
  (cond ((zerop (decf (journey-patience journey))) (end-journey journey :gave-up))
        ((zerop (mod (journey-patience journey) 3))
         (robot-turn (robot-to-command journey) (if (evenp (journey-patience journey)) 2.4 -2.4)
           (continuation (err robot angle)
             (continue-after-command journey err
                                     (lambda () (drive-straight journey 2 #'continue-journey))
                                     (lambda () (continue-journey journey))))))
        (t (continue-journey journey))))

;;; Doorways: a camera guides the robot there, as in PASS-DOORWAY.

(defun drive-through-doorway (journey cell beyond)
  "Drive the robot of JOURNEY, which faces the doorway CELL, through the doorway to BEYOND."
  (labels ((blindly ()
             (drive-to-point journey (middle-of cell)
                             (lambda (journey) (leave-doorway journey beyond))))
           (look ()
             (camera-get-all-place-designators (journey-camera journey) 'doorway
               (continuation (err camera designators)
                 (let ((doorway (nearest-designator-ahead designators)))
                   (if (and doorway (not (must-end-p journey err)))
                       (go-to-doorway journey doorway beyond)
                       (continue-after-command journey err #'blindly #'blindly)))))))
    (if (journey-camera journey)
        (camera-align-robot (journey-camera journey)
          (continuation (err camera angle) (continue-after-command journey err #'look #'look)))
        (blindly))))

(defun go-to-doorway (journey doorway beyond)
  "Track the designator DOORWAY and drive the robot of JOURNEY to the doorway."
  (let ((begun nil))
    (camera-track (journey-camera journey) doorway
      (continuation (err camera designator)
        ;; It is called again when the track ends.
        (unless begun
          (setf begun t)
          (when (taken-over-p journey) (untrack-doorway journey doorway))
          (continue-after-command journey err
                                  (lambda () (follow-to-doorway journey doorway beyond))
                                  (lambda () (continue-after-obstacle journey))))))))

;; In a doorway the camera may lose its track before a CAMERA-UNTRACK begins, which then would fail.
;; After the run has ended nothing is tracked, and no command can be issued.
(defun untrack-doorway (journey doorway)
  "If the camera of JOURNEY tracks the designator DOORWAY, stop this track without a message."
  (let ((camera (journey-camera journey)) (run (robot-simulation (journey-robot journey))))
    (when (and (eq doorway (camera-tracks camera))
               (not (ars-magna.run:simulation-over run)))
      (grab-resource camera run))))

(defun follow-to-doorway (journey doorway beyond)
  "Drive the robot of JOURNEY to the designator DOORWAY, which its camera tracks."
  (robot-set-speed (robot-to-command journey) driving-speed*
    (continuation (err robot speed)
      (flet ((follow () (go-to-tracked-doorway journey doorway beyond)))
        (when (must-end-p journey err) (untrack-doorway journey doorway))
        (continue-after-command journey err #'follow #'follow)))))

(defun go-to-tracked-doorway (journey doorway beyond)
  "Drive the robot of JOURNEY, whose speed is set, to the designator DOORWAY."
  (robot-goto-designator (robot-to-command journey) (journey-camera journey)
    (continuation (err robot camera designator)
      (untrack-doorway journey doorway)
      (continue-after-command journey err
                              (lambda () (leave-doorway journey beyond))
                              (lambda ()
                                (if (eq err :robot-blocked)
                                    (continue-after-obstacle journey)
                                    (leave-doorway journey beyond)))))))

(defun leave-doorway (journey beyond)
  "Correct the reckoning of JOURNEY if the robot senses a doorway, and drive on to BEYOND."
  (flet ((on () (drive-to-point journey beyond #'continue-journey)))
    (robot-place (robot-to-command journey)
      (continuation (err robot type)
        (let ((cell (doorway-nearby (journey-me journey))))
          (if (and cell (eq type 'doorway) (not (must-end-p journey err)))
              (correct-in-doorway journey cell #'on)
              (continue-after-command journey err #'on #'on)))))))

(defun correct-in-doorway (journey cell next)
  "Correct position and heading in the reckoning of JOURNEY, whose robot is in the doorway CELL."
  (let ((me (journey-me journey)))
    (correct-by-cell me cell)
    (robot-align-place (robot-to-command journey)
      (continuation (err robot angle)
        (continue-after-command journey err
                                (lambda ()
                                  (correct-by-direction me cell)
                                  (funcall next))
                                next)))))
