;;;; passing.lisp -- passing ticks of a headless run, and waiting for a live one.

(in-package :ars-magna.run)

(export '(check-wait-while-paused))

;;; Passing ticks.

(defun check-headless (simulation operator)
  (when (simulation-thread simulation)
    (reject-use "~(~A~): this simulation runs live, so its ticks pass by themselves. Use ~
                 (with-simulation (ROBOT) ...) or (stop-simulator)." operator)))

(defun check-can-pass-ticks (simulation)
  "Signal MISUSE if this thread is already passing ticks of SIMULATION."
  (when (and (owner-p simulation)
             (or (simulation-inside-tick-p simulation)
                 (timeline-passing-p (simulation-timeline simulation))))
    (reject-use "run-ticks: a tick is under way, as in a continuation, so no time can pass here. ~
                 Begin plans here by (begin-plan ...) instead of (run-plan ...); in a plan, wait ~
                 by (wait-time N).")))

(defun await-custody (simulation)
  "Another thread owns SIMULATION. Wait a moment if that thread only inspects SIMULATION. Signals
MISUSE if it passes ticks of SIMULATION."
  (when (timeline-passing-p (simulation-timeline simulation))
    (reject-use "run-ticks: another thread passes ticks of ~A, or changes it. Try again when that ~
                 thread has finished."
                (simulation-name simulation)))
  (answer-own-questions)
  (yield-thread))

(defun pass-ticks-ignoring-gate (count simulation)
  "Pass COUNT ticks of SIMULATION, which this thread owns. Stop early if the run ends, or if an
error in users' code has to be signalled."
  (let* ((timeline (simulation-timeline simulation)) (custody (timeline-custody timeline))
         (queue (simulation-messages simulation)))
    (loop repeat count
          until (or (timeline-over timeline) (message-queue-unsignalled queue))
          do (tick simulation)
             (when (custody-questions custody) (answer-questions custody)))))

(defun pass-ticks (count simulation)
  "Pass COUNT ticks of SIMULATION, which this thread owns. A gate of SIMULATION may limit how many
pass at a time. Meanwhile no other code, not even a continuation, can pass ticks of SIMULATION."
  (let ((timeline (simulation-timeline simulation)) (gate (simulation-gate simulation)))
    (setf (timeline-passing-p timeline) t)
    (in-any-case
      (loop with left = count
            until (or (zerop left) (timeline-over timeline)
                      (message-queue-unsignalled (simulation-messages simulation)))
            ;; The gate may wait, or make a non-local exit.
            do (let ((now (if gate (min left (funcall gate simulation)) left)))
                 (pass-ticks-ignoring-gate now simulation)
                 (decf left now)))
      (setf (timeline-passing-p timeline) nil))))

(defun warn-of-ticks-in-plan (operator simulation)
  "Warn once that a step of a plan calls OPERATOR, which passes ticks while the plan is stopped."
  (when (some #'participant-around-p (simulation-participants simulation))
    (warn-once (list :in-plan operator) (simulation-world simulation)
               (format nil "~(~A~) was called inside of a step of a plan, so the plan is stopped ~
                            meanwhile. In a plan, wait by (wait-time N) or (wait-until TEST)."
                       operator))))

(addition run-ticks)
(defun run-ticks (count &optional (simulation (current-simulation)))
  "Pass COUNT ticks, at most 1e9, of the headless SIMULATION. Return the tick that is reached. If
SIMULATION is a fork that was rewound, its successor is used. Signals WRONG-ARGUMENT, and MISUSE if
SIMULATION runs live or is inside a tick, or if another thread passes its ticks. If the error policy
is :SIGNAL, signals USER-CODE-ERROR after the tick in which the first error in user code occurs. The
restart CONTINUE passes the remaining ticks."
  (check-argument run-ticks count (whole-p count 0) "a whole number of ticks, from 0 to 1e9")
  (let ((simulation (successor-of-fork simulation)))
    (warn-of-ticks-in-plan :run-ticks simulation)
    (prog1 (check-and-pass-ticks simulation count)
      (notify-participants-after-ticks simulation))))

(defun notify-participants-after-ticks (simulation)
  (dolist (participant (simulation-participants simulation))
    (participant-after-ticks participant simulation)))

(defun successor-of-fork (simulation)
  (if (fork-p simulation) (latest-successor simulation) simulation))

(defun pass-ticks-when-free (simulation count)
  "Pass COUNT ticks of SIMULATION as PASS-TICKS does, as soon as no other thread owns it."
  (flet ((pass () (pass-ticks count simulation)))
    (declare (dynamic-extent #'pass))
    (flet ((pass-inside () (call-in-simulation simulation #'pass) t)
           (wait () (await-custody simulation) nil))
      (declare (dynamic-extent #'pass-inside #'wait))
      (loop with custody = (timeline-custody (simulation-timeline simulation))
            until (call-with-custody custody #'pass-inside #'wait)))))

(defun check-and-pass-ticks (simulation count)
  (check-headless simulation 'run-ticks)
  (check-not-over simulation 'run-ticks)
  (check-not-secluded simulation)
  (check-can-pass-ticks simulation)
  (when *recorded-bindings* (warn-of-recorded-bindings (simulation-world simulation)))
  (loop with last = (+ (simulation-tick simulation) count)
        do (pass-ticks-when-free simulation (- last (simulation-tick simulation)))
        while (signal-pending-error (simulation-messages simulation))
        until (or (simulation-over simulation) (<= last (simulation-tick simulation))))
  (simulation-tick simulation))

(defun note-run-until-result (answer limit-p limit simulation)
  "Record that RUN-UNTIL has ended in SIMULATION with ANSWER. If ANSWER is NIL and LIMIT is the
default, that is, LIMIT-P is false, warn once in the run."
  (cond (answer (record-progress-checked (simulation-world simulation)))
        ((not (or limit-p (simulation-over simulation)))
         (warn-once '(:limit :run-until) (simulation-world simulation)
                    (format nil "run-until returned NIL, because its test was still false after ~D ~
                                 ticks, at tick ~D. The default limit is ~D ticks; (run-until TEST ~
                                 :limit TICKS) sets another."
                            limit (simulation-tick simulation) limit)))))

(addition run-until)
(define-with-keywords run-until (predicate &key (limit 100000 limit-p)
                                           (simulation (current-simulation)))
  "Pass ticks of the headless SIMULATION until PREDICATE, a function without arguments, returns
true, but at most LIMIT ticks. Return the value of PREDICATE and the tick reached; a value of NIL
means that LIMIT ticks have passed. If no LIMIT was given, a warning says so once in a run. Signals
WRONG-ARGUMENT, and MISUSE as RUN-TICKS does."
  (check-argument run-until predicate (or (functionp predicate)
                                        (and (symbolp predicate) (fboundp predicate)))
                  "a function of no arguments, such as (lambda () (< 9 (simulation-tick)))")
  (check-argument run-until limit (typep limit '(integer 0)) "a number of ticks, 0 or more")
  (let ((simulation (successor-of-fork simulation)))
    (check-headless simulation 'run-until)
    (check-not-over simulation 'run-until)
    (warn-of-ticks-in-plan :run-until simulation)
    (let ((answer (loop for left downfrom limit
                        thereis (funcall predicate)
                        until (zerop left)
                        do (check-and-pass-ticks (successor-of-fork simulation) 1))))
      (note-run-until-result answer limit-p limit (successor-of-fork simulation))
      (notify-participants-after-ticks (successor-of-fork simulation))
      (values answer (simulation-tick simulation)))))

(addition step-ticks)
(defun step-ticks (&optional (count 1) (simulation (current-simulation)))
  "Pass COUNT ticks and then pause. In a headless SIMULATION the ticks have passed when STEP-TICKS
returns; a live SIMULATION passes them at its pace. Return nothing."
  (check-argument step-ticks count (whole-p count 1) "a whole number of ticks, from 1 to 1e9")
  (if (live-p simulation)
      (pass-then-pause count simulation)
      (run-ticks count simulation))
  (values))

;;; Waiting for a live run.

(addition await-idle)
(defun await-idle (&optional (simulation (current-simulation)) (seconds 60 given-p))
  "Wait, at most SECONDS, until all work in the live SIMULATION has ended. Return true if it has
ended; otherwise return false and, unless SECONDS are given, queue a warning that names the work in
progress. Kickers and tracks do not end, so AWAIT-IDLE does not wait for them. If SIMULATION is not
live, return at once whether it is idle. Signals WRONG-ARGUMENT unless SECONDS is a number from 0 to
1e9, and MISUSE if the simulator is paused after a failure, because the wait would never end."
  (check-argument await-idle seconds (and (sane-number-p seconds) (<= 0 seconds))
                  "a number of seconds, from 0 to 1e9")
  (let ((simulation (resolve-simulation simulation 'await-idle)))
    (cond ((not (live-p simulation)) (idle-p simulation))
          ((eq (current-thread) (simulation-thread simulation))
           (reject-use "await-idle: the simulator's own thread would wait for itself. Continue in ~
                        a continuation instead."))
          ((some #'participant-around-p (simulation-participants simulation))
           (reject-use "await-idle: a plan would wait for itself. In a plan, wait for a fluent, ~
                        such as robot-stopped*."))
          ((wait-until-idle simulation seconds))
          ((and (not given-p) (live-p simulation)) (warn-of-await-timeout simulation seconds)))))

(defun warn-of-await-timeout (simulation seconds)
  "Queue a warning that SIMULATION was not idle after AWAIT-IDLE has waited SECONDS. Return NIL."
  (let ((names (remove-duplicates (unfinished-work-texts simulation) :test #'string=))
        (*message-queue* (simulation-messages simulation)))
    (warn-at-once (format nil "await-idle has waited for ~A s and stops waiting, because ~:[some ~
                               work is still in progress~;~:*~{~A~^ and ~} did not end~]."
                          seconds names))
    nil))

;; Check plans first: their requests are in the inbox when they are at rest.
(defun all-at-rest-p (simulation)
  "True if SIMULATION has no work left and none of its participants is working."
  (asking (simulation)
    (and (notany #'participant-at-work-p (simulation-participants simulation))
         (no-work-left-p simulation))))

(defun wait-until-idle (simulation seconds)
  "Wait at most SECONDS until SIMULATION, live in another thread, is idle. Return true if idle."
  (let ((idle (make-semaphore "idle")))
    (flet ((look (simulation)
             (when (no-work-left-p simulation) (signal-semaphore idle))))
      (in-any-case
        (progn (add-observer #'look simulation)
               (wait-on-idle-semaphore idle seconds simulation))
        ;; Without waiting: code that does not return may be what the wait was ended for.
        (ask-later simulation (lambda () (remove-observer #'look simulation)))))))

(defun wait-on-idle-semaphore (idle seconds simulation)
  "Wait at most SECONDS until SIMULATION is idle. Return true if it is. The semaphore IDLE is
signalled when SIMULATION may be idle, but not when a plan ends. Signals MISUSE if SIMULATION has
failed."
  (loop with due = (+ (seconds-now) seconds)
        do (check-not-failed simulation)
        thereis (all-at-rest-p simulation)
        while (and (< (seconds-now) due) (live-p simulation))
        do (check-wait-while-paused 'await-idle simulation)
           (wait-while-serving idle (min 0.02 (max 0 (- due (seconds-now)))))))

(defun check-wait-while-paused (operator simulation)
  "OPERATOR waits for SIMULATION, a live run. If SIMULATION is paused and no user can resume it,
signal MISUSE. If a user can resume it, queue a warning, once in a run."
  (when (paused-without-steps-p simulation)
    (unless *user-can-resume-p*
      (reject-use "~(~A~): the run is paused, so this would wait for ever. Call (resume) first."
                  operator))
    (let ((*message-queue* (simulation-messages simulation)))
      (warn-once '(:waits-while-paused) (simulation-world simulation)
                 (format nil "~(~A~) waits, because the run is paused. Call (resume) in another ~
                              thread to continue the run. Control-C ends the wait." operator)))))

(defun check-not-failed (simulation)
  "Signal MISUSE if the live SIMULATION is paused because it has failed."
  (let ((trouble (clock-failure-text simulation)))
    (when trouble
      (reject-use "await-idle: the simulator has failed and is paused, so no ticks pass: ~A. ~
                   (resume) continues the run."
                  (string-right-trim "." trouble)))))
