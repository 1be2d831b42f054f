;;;; thread.lisp -- the thread in which plans of a live simulation react, and its watcher.

(in-package :ars-magna.rpl-robot)

;;; A watcher thread samples the plans' thread twice in *HOG-SECONDS*. If it finds the same step of
;;; Lisp code three times in a row, the plan has kept the thread that long, and a warning names the
;;; plan. The code is aborted if the plan is to end or the simulator has been stopped. For a plan
;;; that takes step after step the warning comes from the runner; it is ended if it goes on after
;;; the simulator has stopped.

(defstruct (sample (:constructor make-sample (rests steps task)) (:copier nil))
  "A sample of the plans' thread: its counts of rests and of steps, and the running TASK, or NIL."
  (rests 0 :read-only t)
  (steps 0 :read-only t)
  (task nil :read-only t))

(defun take-thread-sample (interface thread)
  (let ((*runner* (interface-runner interface)))
    (make-sample (interface-rests interface)
                 (runner-steps *runner*)
                 (and (eq thread (interface-holder interface))
                      (current-task)))))

(defun busy-since-p (sample earlier)
  "True if the plans have not come to rest between EARLIER and SAMPLE."
  (and earlier
       (sample-task sample)
       (sample-task earlier)
       (eql (sample-rests sample) (sample-rests earlier))))

(defun stuck-since-p (sample earlier)
  (and (busy-since-p sample earlier)
       (eql (sample-steps sample) (sample-steps earlier))))

(defun end-requested-p (interface task)
  (or (interface-closing-p interface)
      (not (live-p (interface-simulation interface)))
      (member (task-top task) (interface-ends-requested interface))))

(defun warn-of-blocking-plan (task)
  (warn-at-once (format nil "The plan ~A has kept the plans' thread busy for ~,1F s and goes on, ~
                             at ~A in ~{~A~^ > ~}; (end-plan :all) or (stop-simulator) ends it"
                        (task-label (task-top task)) (hog-seconds)
                        (form-text (task-form task)) (task-path task))))

(defun abort-step (interface steps)
  "Abort the Lisp code of INTERFACE's plan in this thread, if the plans are still at step STEPS."
  (when (and (eql steps (runner-steps (interface-runner interface)))
             (holding-plans-p interface))
    (abort)))

(defun end-blocking-plan (interface thread sample stuck-p)
  "End the plan from which SAMPLE was taken. If STUCK-P, abort the Lisp code that the plan is
running; otherwise end the plan between two steps."
  (let ((steps (sample-steps sample)))
    (if stuck-p
        (interrupt-thread thread (lambda () (abort-step interface steps)))
        (stop-plan (interface-runner interface) (task-top (sample-task sample))))))

(defun watch-plans (interface thread calls ended)
  "Watch THREAD, the plans' thread, until the semaphore ENDED is signalled at its end. Warn of plans
that block THREAD, and end them on request. CALLS says which users' code THREAD runs."
  (loop with earlier = nil and stuck = 1 and busy = 1
        until (wait-on-semaphore ended (/ (hog-seconds) 2))
        do (let ((sample (take-thread-sample interface thread)))
             (setf stuck (if (stuck-since-p sample earlier) (1+ stuck) 1)
                   busy (if (busy-since-p sample earlier) (1+ busy) 1)
                   earlier sample
                   (interface-hog interface) (and (<= 3 stuck) (sample-task sample)))
             (unless (user-calls-waiting-p calls)
               (when (= 3 stuck) (warn-of-blocking-plan (sample-task sample)))
               (when (and (<= 3 busy) (end-requested-p interface (sample-task sample)))
                 (end-blocking-plan interface thread sample (<= 3 stuck)))))
        finally (setf (interface-hog interface) nil)))

;;; The thread exists while there are plans and ticks pass by themselves. It sleeps only while no
;;; plan is ready. The next tick that finds plans starts another.

(defun run-plans-in-ticks (interface)
  "From now on, run the plans of INTERFACE at the end of each tick, without a thread."
  (swap-if-eq (interface-thread interface) (current-thread) nil)
  ;; Another thread may have closed it before, and left the rest to this one.
  (when (interface-closing-p interface) (react-fully interface))
  (wake-owner (simulation-timeline (interface-simulation interface)))
  :over)

(defun react-in-thread (interface)
  "Let the plans of INTERFACE react. Return :IDLE or :BUDGET; :OVER if the thread has no more plans
to run; NIL if the reaction was aborted."
  (with-plans (interface)
    (unless (timeline-real-p (simulation-timeline (interface-simulation interface)))
      (return-from react-in-thread (run-plans-in-ticks interface)))
    ;; Read first: a request to end the plans is served in this reaction.
    (let* ((closing-p (interface-closing-p interface))
           (outcome (call-user-code #'react-fully (participant-origin interface) interface)))
      (cond ((and (tasks-of-interface interface) (not closing-p))
             (if (and (not (live-p (interface-simulation interface)))
                      (or (eq :idle outcome) (must-wait-for-tick-p interface)))
                 (run-plans-in-ticks interface)
                 outcome))
            (t (setf (interface-thread interface) nil)
               :over)))))

(defun wake-idle-simulation (interface)
  "Wake the live simulation if it is idle for lack of events while a plan waits for a tick."
  (let ((simulation (interface-simulation interface)))
    (when (and (or (interface-tick-wanted-p interface)
                   (wake-tick interface))
               (zerop (agenda-pending (simulation-agenda simulation))))
      (wake-owner (simulation-timeline simulation)))))

(defun rest-until-woken (interface &optional seconds)
  (atomic-incf (interface-rests interface))
  (wake-idle-simulation interface)
  (wait-on-semaphore (interface-wake-up interface) seconds)
  (setf (interface-tick-wanted-p interface) nil))

;; Other plans must not wait for one that never does.
(defmethod slices-spent ((interface interface) runner)
  "If this is the plans' thread, let time go on. End the reaction if a wish or a fork of the run
waits for its end."
  (when (eq (current-thread) (interface-thread interface))
    (let* ((simulation (interface-simulation interface)) (tick (simulation-tick simulation)))
      (setf (interface-computing-p interface) t)
      (when (> tick (plan-runner-tick runner)) (advance-timers runner tick))
      (publish-next-tick interface)
      (wake-idle-simulation interface)
      (or (fork-postponed-p simulation) (wish-to-serve interface)))))

(defun run-plans-thread (interface)
  (loop
    (loop while (plusp (interface-wanted interface)) do (yield-thread))
    (await-postponed-fork (interface-simulation interface))
    (ecase (react-in-thread interface)
      (:over (return))
      ;; A tick may have come meanwhile without a call to wake.
      (:idle (unless (woken-by-tick-p interface)
               ;; With a listener for messages, as at the prompt, that is reported anyway.
               (unless (message-queue-listener *message-queue*) (warn-of-stranded-plans interface))
               (rest-until-woken interface)))
      (:budget (cond ((or (must-wait-for-tick-p interface) (wish-to-serve interface))
                      (setf (interface-tick-wanted-p interface) t)
                      (rest-until-woken interface))
                     (t (wake-idle-simulation interface))))
      ((nil) (rest-until-woken interface 0.05)))))

(defun call-as-plans-thread (interface function)
  "Call FUNCTION in this thread, which is the thread of INTERFACE until FUNCTION returns or is left.
Do nothing if the start of this thread was given up."
  (let ((thread (current-thread)))
    (swap-if-eq (interface-thread interface) :starting thread)
    (when (eq thread (interface-thread interface))
      (in-any-case
        (funcall function)
        (swap-if-eq (interface-thread interface) thread nil)
        (wake-owner (simulation-timeline (interface-simulation interface)))))))

(defun start-plans-thread (interface)
  (let ((simulation (interface-simulation interface))
        (calls (make-user-calls))
        (ended (make-semaphore "plans' thread ended")))
    (setf (interface-calls interface) calls)
    (flet ((run ()
             (let ((*user-calls* calls))
               (in-any-case
                 (call-with-thread-bindings simulation
                                (lambda ()
                                  (call-as-plans-thread
                                   interface (lambda () (run-plans-thread interface)))))
                 (signal-semaphore ended))))
           (name (control)
             (format nil control (plans-owner interface))))
      (let ((thread (start-thread #'run (name "plans of ~A"))))
        (swap-if-eq (interface-thread interface) :starting thread)
        (start-thread (lambda ()
                        (call-with-thread-bindings
                         simulation
                         (lambda () (watch-plans interface thread calls ended))))
                      (name "watcher of the plans of ~A"))))))

;; A time limit may come at any moment: it must not leave plans that wait for a thread to start.
(defun ensure-thread (interface)
  (when (and (plans-thread-wanted-p interface) (null (plans-thread interface)))
    (deferring-interrupts
      (when (swap-if-eq (interface-thread interface) nil :starting)
        (in-any-case
          (start-plans-thread interface)
          (swap-if-eq (interface-thread interface) :starting nil))))))
