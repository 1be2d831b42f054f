;;;; thread.lisp -- the thread in which the plans of a live simulation react.

(in-package :ars-magna.rpl-robot)

;;; It lives as long as there are plans and ticks pass by themselves, and sleeps only while none of
;;; the plans is ready. The next tick that finds plans starts another.

(defun leave-to-ticks (interface)
  "Let the plans of INTERFACE, which are to have a thread no longer, go on in the ticks."
  (swap-if (interface-thread interface) (current-thread) nil)
  ;; Somebody may have closed it, and left that to this thread, before it had none.
  (when (interface-closing-p interface) (react-fully interface))
  (wake-owner (simulation-timeline (interface-simulation interface)))
  :over)

(defun react-in-thread (interface)
  "Let the plans of INTERFACE react. Return :IDLE or :BUDGET, :OVER if there are none to go on here,
NIL if that was aborted."
  (with-plans (interface)
    (unless (timeline-real-p (simulation-timeline (interface-simulation interface)))
      (return-from react-in-thread (leave-to-ticks interface)))
    ;; Looked at first: what is to end the plans is heard in this reaction.
    (let* ((closing-p (interface-closing-p interface))
           (outcome (call-user-code #'react-fully (participant-origin interface) interface)))
      (cond ((and (tasks-of interface) (not closing-p))
             (if (and (not (live-p (interface-simulation interface)))
                      (or (eq :idle outcome) (waits-for-tick-p interface)))
                 (leave-to-ticks interface)
                 outcome))
            (t (setf (interface-thread interface) nil)
               :over)))))

(defun call-for-ticks (interface)
  "Have the live simulation, if it rests for want of events, go on while a plan waits for time."
  (let ((simulation (interface-simulation interface)))
    (when (and (or (interface-tick-wanted-p interface)
                   (wake-tick interface))
               (zerop (agenda-pending (simulation-agenda simulation))))
      (wake-owner (simulation-timeline simulation)))))

(defun rest-plans (interface &optional seconds)
  (atomic-incf (interface-rests interface))
  (call-for-ticks interface)
  (wait-on-semaphore (interface-wake-up interface) seconds)
  (setf (interface-tick-wanted-p interface) nil))

(defun run-thread (interface)
  (loop
    (loop while (plusp (interface-wanted interface)) do (yield-thread))
    (let-fork-be-kept (interface-simulation interface))
    (ecase (react-in-thread interface)
      (:over (return))
      ;; A tick may have come meanwhile for which nobody was told to wake.
      (:idle (unless (woken-by-tick-p interface)
               ;; Where somebody listens to messages, as at the prompt, that is told anyway.
               (unless (message-queue-listener *message-queue*) (look-for-stranded interface))
               (rest-plans interface)))
      (:budget (when (or (waits-for-tick-p interface) (wish-to-serve interface))
                 (setf (interface-tick-wanted-p interface) t)
                 (rest-plans interface)))
      ((nil) (rest-plans interface 0.05)))))

(defun become-thread (interface)
  "Let this thread, which was started for that, be the thread of INTERFACE. True if it is; the start
may have been given up, and another may have been started."
  (let ((thread (current-thread)))
    (swap-if (interface-thread interface) :starting thread)
    (eq thread (interface-thread interface))))

(defun call-as-thread (interface function)
  "Call FUNCTION in what is the thread of INTERFACE from now on, until it returns or is left; but
not if another is."
  (when (become-thread interface)
    (in-any-case
      (funcall function)
      (swap-if (interface-thread interface) (current-thread) nil)
      (wake-owner (simulation-timeline (interface-simulation interface))))))

(defun start-plans-thread (interface)
  (let ((simulation (interface-simulation interface))
        (calls (make-user-calls))
        (ended (make-semaphore "plans' thread ended")))
    (setf (interface-calls interface) calls)
    (flet ((run ()
             (let ((*user-calls* calls))
               (in-any-case
                 (call-as-owner simulation
                                (lambda ()
                                  (call-as-thread interface (lambda () (run-thread interface)))))
                 (signal-semaphore ended))))
           (name (control)
             (format nil control (interface-robot interface))))
      (let ((thread (start-thread #'run (name "plans of ~A"))))
        (swap-if (interface-thread interface) :starting thread)
        (start-thread (lambda ()
                        (call-as-owner simulation
                                       (lambda () (watch-plans interface thread calls ended))))
                      (name "watcher of the plans of ~A"))))))

;; A time limit may come at any moment: it must not leave plans that wait for a thread to start.
(defun ensure-thread (interface)
  (when (and (thread-wanted-p interface) (null (thread-of interface)))
    (deferring-interrupts
      (when (swap-if (interface-thread interface) nil :starting)
        (in-any-case
          (start-plans-thread interface)
          (swap-if (interface-thread interface) :starting nil))))))
