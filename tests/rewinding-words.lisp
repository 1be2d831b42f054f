;;;; rewinding-words.lisp -- requests to a run and its plans repeat alike after a rewind.

(in-package :ars-magna.tests)
(in-suite rewinding)

;;; Plans that wait for each other, think, run under policies, and print what they do.

(defvar *bell* (rpl:create-fluent 'bell) "What plans listen to.")

(defun say-so (&rest items)
  (format t "~D: ~{~A~^ ~}~%" (rpl:plan-time) items))

(rpl:def-interp-proc mutter (name ticks)
  (rpl:n-times 400
    (rpl:wait-time ticks)
    (say-so name (random 100))))

(rpl:def-interp-proc brood (name steps)
  (rpl:n-times 400
    (let ((sum 0))
      (rpl:n-times steps (setf sum (mod (+ 7 (* 3 sum)) 101)))
      (rpl:with-charge ((random 4)) (setf sum (1+ sum)) sum)
      (say-so name sum))
    (rpl:wait-time 1)))

(rpl:def-interp-proc roam-about (name)
  (rpl:n-times 400
    (rpl:with-policy (rpl:whenever *bell*
                       (say-so name :bell (rpl:fluent-value driver:robot-movement-error*))
                       (rpl:think 2 :alone (zerop (random 2))))
      (rpl:with-valve ((driver:rpl-robot-valve))
        (driver:rpl-robot-turn (- (/ (random 20) 10d0) 1))
        (rpl:wait-for driver:robot-stopped*)
        (say-so name :turned (rpl:fluent-value driver:robot-movement-error*))
        (driver:rpl-robot-go-forward 1)
        (rpl:wait-for driver:robot-stopped*)))
    (rpl:think (random 3))))

(rpl:def-interp-proc peer (name)
  (rpl:n-times 400
    (driver:rpl-camera-get-all-object-designators 0 :non-local '((:color red)))
    (rpl:wait-for (aref driver:camera-input* 0))
    (say-so name (length (rpl:fluent-value (aref driver:camera-designators* 0))))
    (rpl:handle-failure ((t () (say-so name :failed)))
      (rpl:with-deadline (3)
        (rpl:par (rpl:wait-time (random 6))
                 (rpl:pursue (rpl:wait-for *bell*) (rpl:wait-time 4)))))))

(rpl:def-interp-proc brief (name)
  (say-so name :began)
  (rpl:wait-time 2)
  (rpl:evap-protect (rpl:wait-time 1) (say-so name :over))
  (rpl:pulse *bell*))

;;; Words, by dice. What they are said to is what is there.

(defvar *words-dice* nil "What decides on the words.")
(defvar *words-end* 0 "The tick from which on continuations say no more.")

(defun word-roll (count) (base:roll-index count *words-dice*))

(defun words-pick (list) (and list (nth (word-roll (length list)) list)))

(defun any-task ()
  (labels ((all (tasks) (loop for task in tasks
                              collect task append (all (rpl:task-children task)))))
    (words-pick (all (driver:plans)))))

(defun robot-now () (first (run:simulation-robots time:*simulation*)))

(defun speak-to-world ()
  (ecase (word-roll 5)
    (0 (robot:place-robot (robot-now) 3.5 3.5 (word-roll 3)))
    (1 (run:set-seed (word-roll 1000)))
    (2 (setf base:motion-noise* (/ (word-roll 9) 10d0)))
    (3 (let ((thing (words-pick (world:world-thing-list world:*world*))))
         (when thing
           (handler-case (world:move-thing thing 3.5 3.5) (base:ars-magna-error ())))))
    (4 (run:set-thinking (words-pick '(:free :charged (:charged :budget 30)
                                       (:charged :budget 120) (:charged :budget 7)))))))

(defun start-a-plan ()
  (when (< (length (driver:plans)) 5)
    (let ((name (word-roll 100)))
      (ecase (word-roll 5)
        (0 (driver:begin-plan 'mutter name (1+ (word-roll 3))))
        (1 (driver:begin-plan 'brood name (word-roll 40)))
        (2 (driver:begin-plan 'roam-about name))
        (3 (driver:begin-plan 'peer name))
        (4 (driver:begin-plan 'brief name))))))

(defun speak-to-plans ()
  (let ((task (any-task)))
    (ecase (word-roll 17)
      ((0 1) (start-a-plan))
      (2 (when task (driver:end-plan task)))
      (3 (when task (rpl:suspend task)))
      ((4 5) (when task (rpl:wake-up task)))
      (6 (when task (rpl:evaporate task)))
      (7 (rpl:charge-ticks (word-roll 4) (driver:rpl-runner)))
      (8 (rpl:charge-steps (word-roll 80) (driver:rpl-runner)))
      (9 (rpl:exhaust-reaction (driver:rpl-runner)))
      (10 (rpl:pulse *bell*))
      (11 (rpl:pulse driver:robot-stopped*))
      (12 (rpl:set-value driver:robot-movement-error* (word-roll 3)))
      (13 (driver:rpl-robot-turn (/ (word-roll 9) 10d0)))
      (14 (driver:rpl-camera-turn 0 0.1d0))
      (15 (driver:rpl-grab-robot))
      (16 (when (zerop (word-roll 4)) (driver:rpl-init-robot (robot-now)))))))

;; A continuation speaks too.
(declaim (ftype function speak))

(defun a-continuation ()
  "Return a continuation that says something that is decided now."
  (let ((words (word-roll 1000000)))
    (lambda (&rest ignored)
      (declare (ignore ignored))
      (when (< (tick-of-run) *words-end*)
        (let ((*words-dice* (base:make-dice words "later"))) (speak))))))

(defun speak-to-robot ()
  (let ((robot (robot-now)))
    (ecase (word-roll 6)
      (0 (command:robot-turn robot (/ (word-roll 30) 10d0) (a-continuation)))
      (1 (command:robot-turn robot 0.3d0))
      (2 (command:robot-stop robot (a-continuation)))
      (3 (command:camera-turn (robot:robot-camera robot 0) 0.2d0 (a-continuation)))
      (4 (time:grab-resource robot))
      (5 (command:think robot (word-roll 4) (a-continuation))))))

(defun speak ()
  (case (word-roll 10)
    ((0 1 2) (speak-to-robot))
    (3 (speak-to-world))
    (t (speak-to-plans))))

(defun speak-between-ticks ()
  "Say what can be said between ticks only, perhaps, and other things."
  (loop repeat (word-roll 3) do (speak))
  (when (zerop (word-roll 12))
    (driver:run-plan 'brief :waited)))

;;; A run.

(defun words-at (salt tick place)
  (base:make-dice (+ (* 1000 tick) salt) place))

(defun look-on (salt)
  "Return an observer that speaks now and then."
  (lambda (simulation)
    (let ((*words-dice* (words-at salt (run:simulation-tick simulation) "observer")))
      (when (zerop (word-roll 3)) (speak)))))

(defun moment-now (printed)
  "Return what there is to be known of the run: its tick, state, what was PRINTED and said."
  (list (tick-of-run) (state-now) (random 536870912 (make-random-state nil))
        printed (mapcar #'base:message-text (base:take-messages))))

(defun speak-to-tick (goal salt)
  "Pass ticks to GOAL, and speak as SALT says. Return the moments, the newest first."
  (let ((observer (look-on salt)) (moments '()))
    (run:add-observer observer)
    (loop while (< (tick-of-run) goal)
          do (push (moment-now (with-output-to-string (*standard-output*)
                                 (let ((*words-dice* (words-at salt (tick-of-run) "between")))
                                   (speak-between-ticks))
                                 (run:run-ticks 1)))
                   moments))
    (run:remove-observer observer)
    moments))

(defparameter *words-length* 40 "After how many ticks a run is rewound.")

(defun words-mode (seed)
  (nth (mod seed 4) '(:free :charged (:charged :budget 30) (:charged :budget 120))))

(defun call-with-speaking-run (seed function)
  "Call FUNCTION in a run in which plans may drive the keeper and things hop about."
  (let ((*standard-output* (make-broadcast-stream)) (*bell* (rpl:create-fluent 'bell)))
    (keeping-often
      (run:with-simulation (keeper :seed seed :keep (if (evenp seed) 3 12) :journal t
                                   :thinking (words-mode seed))
        (dolist (thing (world:world-thing-list world:*world*))
          (when (evenp (world:thing-serial thing)) (world:set-kicker thing 'ride-hop)))
        (driver:rpl-init-robot (robot-now))
        (base:take-messages)
        (funcall function)))))

(defmacro speaking-run ((seed) &body body)
  `(call-with-speaking-run ,seed (lambda () ,@body)))

(defun rewind-to-moment (moment)
  "Rewind to MOMENT. Return what is not as it was then."
  (rewind-to (first moment))
  (let ((now (moment-now nil)))
    (append (unless (equal (subseq now 0 3) (subseq moment 0 3)) (list now))
            (remove-if-not (lambda (text) (search "The rewound run differs" text)) (fifth now)))))

(defun wrong-after-rewind (seed)
  "Let a run go on, be rewound, and go on; return what is not as it was, or as in a run that has
never gone further."
  (let ((dice (base:make-dice seed "rewind")) (wrong '()) (tick 0) (goal 0) (then '()))
    (speaking-run (seed)
      (let* ((*words-end* most-positive-fixnum)
             (moments (speak-to-tick *words-length* seed))
             (moment (base:roll-element moments dice)))
        (setf wrong (rewind-to-moment moment)
              tick (first moment)
              goal (+ tick 15)
              *words-end* tick
              then (speak-to-tick goal (+ 7 seed)))))
    (speaking-run (seed)
      (let ((*words-end* (1+ tick)))
        (speak-to-tick tick seed)
        (setf *words-end* tick)
        (append wrong (set-exclusive-or then (speak-to-tick goal (+ 7 seed)) :test #'equal))))))

(test rewind.repeats-words-from-anywhere
  "Between ticks, from continuations and observers; to robot, world, plans and tasks; whatever
thinking costs."
  (loop for seed from 1 to 12
        do (is (null (wrong-after-rewind seed)) "~D" seed)))

(test rewind.again-and-again
  (loop for seed from 1 to 3
        do (speaking-run (seed)
             (let* ((*words-end* most-positive-fixnum)
                    (dice (base:make-dice seed "again"))
                    (moments (speak-to-tick 40 seed)))
               (loop for time from 1 to 5
                     for moment = (base:roll-element moments dice)
                     do (is (null (rewind-to-moment moment)))
                        (setf moments
                              (append (speak-to-tick (+ 8 (tick-of-run)) (+ time seed))
                                      (remove (first moment) moments :key #'first :test #'<))))
               (is (= (run:state-digest)
                      (nth-value 1 (run:replay (end-journal time:*simulation*)))))))))
