;;;; rpl-issue.lisp -- what a plan learns when its commands interrupt others, or it ends.

(in-package :ars-magna.tests)
(in-suite rpl-robot)

;;; Interruptions at issue.

(rpl:def-interp-proc turned (angle)
  "Turn FITTER by ANGLE; return the error code, and the tick in which the plan gets it."
  (driver:rpl-robot-turn angle)
  (rpl:wait-for driver:robot-stopped*)
  (list (value-in driver:robot-movement-error*) (rpl:plan-time)))

(test issue.a-wait-hears-its-own-command
  "What interrupts another command does not take the end of that for its own."
  (with-fitter (:clean t)
    (let ((angle (robot:robot-angle fitter)))
      (destructuring-bind (codes ticks)
          (run-as-plan
            (let ((answers '()))
              (driver:rpl-robot-go-forward 100)
              (rpl:wait-time 10)
              (rpl:n-times 4 (push (turned .5) answers))
              (list (mapcar #'first answers) (mapcar #'second answers))))
        (is (equal '(nil nil nil nil) codes))
        (is (apply #'> ticks)))
      (is (near 2 (geo:angle-difference (robot:robot-angle fitter) angle) 1d-6)))))

(test issue.ends-what-was-before-at-once
  "A task that waits for the older command gets :INTERRUPT before any time passes, and once."
  (with-fitter (:clean t)
    (is (equal '((:interrupt 3) (nil 8))
               (run-as-plan
                 (let ((heard '()))
                   (rpl:with-policy
                       (rpl:whenever (driver:robot-stopped* :missed :all)
                         (push (list (value-in driver:robot-movement-error*) (rpl:plan-time))
                               heard))
                     (driver:rpl-robot-turn 3)
                     (rpl:wait-time 3)
                     (turned 1)
                     (rpl:wait-time 5))
                   (reverse heard)))))))

(defun told-at-issue (before then fluent)
  "Return what FLUENT, a form, holds right after the call THEN, before which was BEFORE."
  (with-fitter (:clean t)
    (multiple-value-bind (value state)
        (driver:run-plan (rpl:make-plan `(rpl:seq (rpl:set-value ,fluent :none)
                                                  ,before
                                                  ,then
                                                  (value-in ,fluent))))
      (is (eq :succeeded state) "~A" value)
      value)))

(test issue.each-resource-for-itself
  (loop for (before then fluent told) in
        '(((driver:rpl-robot-turn 3) (driver:rpl-robot-go-forward 2)
           driver:robot-movement-error* :interrupt)
          ((driver:rpl-robot-turn 3) (driver:rpl-grab-robot)
           driver:robot-movement-error* :interrupt)
          ((driver:rpl-robot-turn 3) (driver:rpl-camera-turn 0 1)
           driver:robot-movement-error* :none)
          ((driver:rpl-camera-turn 0 1) (driver:rpl-camera-view 0)
           (svref driver:camera-movement-error* 0) :interrupt)
          ((driver:rpl-camera-turn 0 1) (driver:rpl-camera-view 1)
           (svref driver:camera-movement-error* 0) :none)
          ((driver:rpl-hand-insert-bin 0 0) (driver:rpl-hand-remove 0)
           (svref driver:hand-error* 0) :interrupt)
          ((driver:rpl-hand-insert-bin 0 0) (driver:rpl-storage-bin-close 0)
           (svref driver:hand-error* 0) :none)
          ((driver:rpl-storage-bin-close 0) (driver:rpl-grab-bin 0)
           (svref driver:storage-bin-error* 0) :interrupt))
        do (is (eq told (told-at-issue before then fluent)) "~S ~S" before then)))

(test issue.what-takes-no-time-is-carried-out
  "A speed set right before a movement holds for that, and is no failure (manual D.4)."
  (with-fitter (:clean t)
    (is (equal '(nil .25d0)
               (run-as-plan
                 (rpl:set-value driver:robot-movement-error* :none)
                 (driver:rpl-robot-set-speed .25)
                 (driver:rpl-robot-go-forward 3)
                 (rpl:wait-for driver:robot-stopped*)
                 (list (value-in driver:robot-movement-error*) (driver:rpl-robot-speed)))))))

(test issue.tracks-go-on
  "A track that has begun is no command on its camera's way; turning the camera ends it in its
tick (manual 3.4.3)."
  (with-fitter (:clean t)
    (is (equal '(nil :interrupt)
               (run-as-plan
                 (tracked 'green)
                 (driver:rpl-camera-turn 0 1)
                 (list (value-in (svref driver:camera-tracking-error* 0))
                       (rpl:seq (rpl:wait-for (svref driver:camera-moved* 0))
                                (rpl:wait-time 1)
                                (value-in (svref driver:camera-tracking-error* 0)))))))))

(test issue.a-late-answer-sets-no-error
  "The robot's own answer to an interruption already reported comes in the next tick, and pulses
nothing."
  (with-fitter (:clean t)
    (is (equal '(:mine nil)
               (run-as-plan
                 (driver:rpl-robot-turn 3)
                 (rpl:wait-time 2)
                 (driver:rpl-grab-robot)
                 (rpl:set-value driver:robot-movement-error* :mine)
                 (let ((pulsed (rpl:wait-for driver:robot-stopped* :timeout 5)))
                   (list (value-in driver:robot-movement-error*) pulsed)))))))

(test issue.what-has-been-answered-is-heard-as-such
  "A command that ended in the same tick has succeeded, though no task has seen that yet."
  (with-fitter (:clean t)
    (let ((order '()))
      (flet ((note (what) (push (list what (value-in driver:robot-movement-error*)) order)))
        (driver:begin-plan (rpl:interp-lambda ()
                             (rpl:set-value driver:robot-movement-error* :none)
                             (driver:rpl-camera-view 0)
                             (driver:rpl-robot-place)
                             (rpl:wait-for (svref driver:camera-input* 0))
                             ;; The place has been sensed, too, and waits to be heard.
                             (rpl:set-value driver:robot-place* :none)
                             (driver:rpl-robot-turn 1)
                             (note (value-in driver:robot-place*))))
        (run:run-ticks 20)
        (is (equal '((nil :none)) order))))))

;;; Ended plans.

(defmacro ended-after (ticks plan &body then)
  "Begin PLAN, an INTERP-LAMBDA, end it after TICKS, and evaluate THEN."
  `(let ((task (driver:begin-plan ,plan)))
     (run:run-ticks ,ticks)
     (driver:end-plan task)
     ,@then))

(defun moves-p (robot)
  "True if ROBOT moves in the next three ticks."
  (run:run-ticks 1)
  (let ((before (list (robot:robot-x robot) (robot:robot-y robot) (robot:robot-angle robot))))
    (run:run-ticks 3)
    (not (equal before (list (robot:robot-x robot) (robot:robot-y robot)
                             (robot:robot-angle robot))))))

(test ended.its-commands-are-interrupted
  (with-fitter (:clean t)
    (ended-after 3 (rpl:interp-lambda () (driver:rpl-robot-turn 30) (rpl:wait-time 100))
      (is (eq :interrupt (value-in driver:robot-movement-error*)))
      (is-false (moves-p fitter)))))

(test ended.by-failure-too
  (with-fitter (:clean t)
    (with-messages
      (run-as-plan (driver:rpl-robot-turn 30) (rpl:wait-time 3) (rpl:fail))
      (is (eq :interrupt (value-in driver:robot-movement-error*)))
      (is-false (moves-p fitter)))))

(test ended.a-plan-that-succeeds-leaves-its-commands
  (with-fitter (:clean t)
    (run-as-plan (driver:rpl-robot-turn 30) (rpl:wait-time 3))
    (is-true (moves-p fitter))))

(test ended.losers-leave-theirs
  "Only the end of a whole plan ends its commands (reading 185)."
  (with-fitter (:clean t)
    (driver:begin-plan (rpl:interp-lambda ()
                         (rpl:pursue (rpl:seq (driver:rpl-robot-turn 30)
                                              (rpl:wait-for driver:robot-stopped*))
                                     (rpl:wait-time 2))
                         (rpl:wait-time 50)))
    (run:run-ticks 5)
    (is-true (moves-p fitter))))

(test ended.commands-that-others-gave-go-on
  "A part that was taken over from the plan is not its own any more."
  (with-fitter (:clean t)
    (ended-after 3 (rpl:interp-lambda () (driver:rpl-robot-turn 30) (rpl:wait-time 100))
      (is-false (moves-p fitter)))
    (let ((task (driver:begin-plan (rpl:interp-lambda ()
                                     (driver:rpl-robot-turn 30) (rpl:wait-time 100)))))
      (run:run-ticks 3)
      (command:robot-turn fitter 30)
      (driver:end-plan task)
      (is-true (moves-p fitter)))))

(test ended.tracks-end-too
  (with-fitter (:clean t)
    (ended-after 20 (rpl:interp-lambda () (tracked 'green) (rpl:wait-time 100))
      (is-true (robot:camera-tracks (robot:robot-camera fitter 0)))
      (run:run-ticks 1)
      (is (null (robot:camera-tracks (robot:robot-camera fitter 0)))))))

(test ended.what-it-does-to-clean-up-goes-on
  (with-fitter (:clean t)
    (ended-after 3 (rpl:interp-lambda ()
                     (rpl:evap-protect (rpl:wait-time 100) (driver:rpl-robot-turn 30)))
      (is-true (moves-p fitter)))))

(test ended.is-repeated-from-a-journal
  (let* ((digest nil)
         (journal (run:with-simulation (fitter :seed 4 :journal t)
                    (driver:rpl-init-robot fitter)
                    (ended-after 5 (rpl:interp-lambda ()
                                     (driver:rpl-robot-turn 30) (rpl:wait-time 100)))
                    (ended-after 20 (rpl:interp-lambda () (tracked 'green) (rpl:wait-time 100))
                      (run:run-ticks 10))
                    (setf digest (run:state-digest))
                    (run:simulation-journal (time:current-simulation)))))
    (is (= digest (run:state-digest (run:replay journal))))))

;;; Takeovers.

(defun texts-of-warnings ()
  "Return the texts of the warnings that are queued, and flush the queue."
  (loop for message in (base:take-messages)
        when (eq :warning (base:message-kind message))
          collect (base:message-text message)))

(defun takeover-warnings (&rest plans)
  "Run PLANS for ten ticks beside one that counts ticks. Return its count, and the warnings about
endless repetition."
  (with-fitter (:clean t)
    (let ((ticks 0))
      (driver:begin-plan (rpl:interp-lambda () (loop (rpl:wait-time 1) (incf ticks))))
      (mapc #'driver:begin-plan plans)
      (run:run-ticks 10)
      (list ticks (remove-if-not (lambda (text) (search "for ever" text))
                                 (texts-of-warnings))))))

(rpl:def-interp-proc keep-turning ()
  (loop (driver:rpl-robot-turn 1) (rpl:wait-for driver:robot-stopped*)))

(rpl:def-interp-proc keep-going ()
  (loop (driver:rpl-robot-go-forward 1) (rpl:wait-for driver:robot-stopped*)))

(test takeovers.are-named-and-take-time
  (destructuring-bind (ticks texts) (takeover-warnings 'keep-turning 'keep-going)
    (is (<= 9 ticks 10))
    (is (<= 1 (length texts) 3))
    (is (search "keep-turning" (first texts)))
    (is (search "keep-going" (first texts)))))

(test takeovers.are-not-forgotten-for-what-they-make-others-say
  (with-fitter (:clean t)
    (driver:begin-plan 'keep-turning)
    (driver:begin-plan 'keep-going)
    (run:run-ticks 35)
    (is-true (find-if (lambda (text) (search "for ever" text)) (texts-of-warnings)))))

(test takeovers.from-oneself
  (destructuring-bind (ticks texts)
      (takeover-warnings (rpl:interp-lambda ()
                           (rpl:whenever driver:robot-stopped*
                             (driver:rpl-robot-go-forward 5)
                             (driver:rpl-robot-turn 1)))
                         (rpl:interp-lambda ()
                           (rpl:wait-time 1)
                           (driver:rpl-grab-robot)
                           (rpl:pulse driver:robot-stopped*)))
    (is (<= 9 ticks 10))
    (is (<= 1 (length texts) 3))
    (is (search "from itself" (first texts)))))

(test takeovers.a-few-are-no-trouble
  (destructuring-bind (ticks texts)
      (takeover-warnings (rpl:interp-lambda ()
                           (rpl:n-times 50 (driver:rpl-robot-turn 1) (driver:rpl-grab-robot))))
    (is (<= 9 ticks 10))
    (is (null texts))))

;;; Tasks that have not reached their wait yet.

(test issue.who-has-not-come-to-its-wait-hears-it-there
  "The task that takes the robot continues only after the task that loses it has been informed."
  (with-fitter (:clean t)
    (is (equal '(:interrupt nil)
               (run-as-plan
                 (let ((first nil) (second nil))
                   (rpl:par (rpl:seq (driver:rpl-robot-turn 2)
                                     (rpl:wait-for driver:robot-stopped*)
                                     (setf first (value-in driver:robot-movement-error*)))
                            (rpl:seq (driver:rpl-robot-turn 1)
                                     (rpl:wait-for driver:robot-stopped*)
                                     (setf second (value-in driver:robot-movement-error*))))
                   (list first second)))))))

(test issue.a-policy-that-takes-the-robot-lets-the-body-hear-it
  (with-fitter (:clean t)
    (is (eq :interrupt
            (run-as-plan
              (let ((alarm (rpl:create-fluent 'alarm)))
                (rpl:with-policy (rpl:seq (rpl:wait-for alarm) (driver:rpl-robot-turn 1/2))
                  (driver:rpl-robot-turn 2)
                  (rpl:pulse alarm)
                  (rpl:wait-for driver:robot-stopped*)
                  (value-in driver:robot-movement-error*))))))))

(defun turn-returning (value)
  (driver:rpl-robot-turn 1)
  value)

(test issue.who-takes-the-robot-waits-whatever-its-step-returned
  (dolist (value '(t nil))
    (with-fitter (:clean t)
      (is (equal '(:interrupt)
                 (run-as-plan
                   (let ((alarm (rpl:create-fluent 'alarm)) (errors '()))
                     (rpl:with-policy (rpl:seq (rpl:wait-for alarm)
                                               (turn-returning value)
                                               (push (value-in driver:robot-movement-error*)
                                                     errors))
                       (driver:rpl-robot-turn 2)
                       (rpl:pulse alarm)
                       (rpl:wait-for driver:robot-stopped*)
                       errors))))))))
