;;;; clock.lisp -- a simulation that runs live, in a thread of its own (manual 2.3, A).

(in-package :ars-magna.time)

;;; The thread passes ticks at the pace RATE, a number of ticks per second or :FREE, for as long as
;;; anything is to be done; while all is idle it sleeps, and simulated time stands still. Between
;;; ticks it answers questions. Others steer it by setting its fields and waking it. This is the
;;; only file that reads the real clock, and no result depends on what it reads.

(addition *default-rate*)
(defparameter *default-rate* 20
  "The pace of a live simulation unless another is given: ticks per second, or :FREE.")

(addition *hog-seconds*)
(defparameter *hog-seconds* 0.5
  "A continuation that keeps the simulator's thread for longer earns a warning, in seconds.")

(defun seconds-now ()
  "Return the real time, in seconds since some moment. No result may depend on it."
  (/ (float (get-internal-real-time) 1d0) internal-time-units-per-second))

(addition live-p)
(defun live-p (simulation)
  "True if SIMULATION runs in a thread of its own."
  (and (simulation-thread simulation) t))

(addition paused-p)
(defun paused-p (simulation)
  "True if the live SIMULATION has been told to pause."
  (simulation-paused-p simulation))

(defun sleep-until-woken (simulation seconds)
  "Sleep for SECONDS (NIL: for as long as it takes), but not while somebody wants something."
  (setf (simulation-asleep-p simulation) t)
  (sb-thread:barrier (:memory))
  (unless (simulation-questions simulation)
    (wait-on-semaphore (simulation-wake-up simulation) seconds))
  (setf (simulation-asleep-p simulation) nil))

(defun nothing-to-do-p (simulation)
  (if (simulation-paused-p simulation)
      (zerop (simulation-steps simulation))
      (idle-p simulation)))

(defun rest-thread (simulation)
  "Sleep for as long as there is nothing to do."
  (setf (simulation-asleep-p simulation) t)
  (sb-thread:barrier (:memory))
  (when (and (nothing-to-do-p simulation)
             (null (simulation-questions simulation))
             (not (simulation-stopping-p simulation)))
    ;; The timeout covers tests that come true without anybody posting.
    (wait-on-semaphore (simulation-wake-up simulation) 1))
  (setf (simulation-asleep-p simulation) nil))

(defun keep-pace (simulation due)
  "Sleep until the time DUE, in seconds; return when the next tick is due."
  (let ((rate (simulation-rate simulation)))
    (if (eq rate :free)
        (seconds-now)
        (loop for left = (- due (seconds-now))
              while (and (plusp left)
                         (not (simulation-stopping-p simulation))
                         (eql rate (simulation-rate simulation)))
              do (sleep-until-woken simulation left)
                 (answer-questions simulation)
              finally (return (+ (max due (- (seconds-now) 0.25d0)) (/ 1d0 (float rate 1d0))))))))

(defun live-tick (simulation)
  "Pass a tick. Trouble that no user code answers for is reported and pauses the clock."
  (handler-bind ((error (lambda (trouble)
                          (unless *break-on-user-error*
                            (error-set "The simulator failed and is paused; RESUME goes on: "
                                       (princ-to-string trouble))
                            (setf (simulation-paused-p simulation) t)
                            (return-from live-tick)))))
    (tick simulation))
  (when (plusp (simulation-steps simulation)) (decf (simulation-steps simulation))))

(defun run-live (simulation)
  (loop with due = (seconds-now)
        until (or (simulation-stopping-p simulation)
                  ;; Stopped from within and started again: another thread has taken over.
                  (not (eq (current-thread) (simulation-thread simulation))))
        do (answer-questions simulation)
           (cond ((nothing-to-do-p simulation)
                  (rest-thread simulation)
                  (setf due (seconds-now)))
                 (t (setf due (keep-pace simulation due))
                    (unless (simulation-stopping-p simulation)
                      (live-tick simulation))))))

(defun call-as-owner (simulation function)
  "Call FUNCTION with the bindings under which the thread of SIMULATION runs."
  (let ((*simulation* simulation)
        (*message-queue* (simulation-messages simulation)))
    (call-with-parameters '() function)))

(defun call-watched (simulation function origin)
  "Call FUNCTION; warn that ORIGIN hogs the simulator's thread if a live one had to wait long."
  (if (live-p simulation)
      (let ((start (seconds-now)))
        (funcall function)
        (let ((seconds (- (seconds-now) start)))
          (when (> seconds *hog-seconds*)
            (warning-set (format nil "~A kept the simulator waiting for ~,1F s" origin seconds)))))
      (funcall function)))

(defun start-clock (simulation &key (rate *default-rate*))
  "Run SIMULATION live, in a thread of its own, at RATE. Return SIMULATION. Signals MISUSE if it
runs live already, WRONG-ARGUMENT for a rate that is neither a positive number nor :FREE."
  (check-rate rate)
  (check-not-over simulation 'start-clock)
  (when (live-p simulation) (reject-use "~A runs live already." simulation))
  (check-parameters)
  (setf (simulation-rate simulation) rate
        (simulation-stopping-p simulation) nil
        (simulation-paused-p simulation) nil
        (simulation-steps simulation) 0)
  (let ((started (make-semaphore "started")))
    (setf (simulation-thread simulation)
          (start-thread (lambda ()
                          (wait-on-semaphore started)
                          (call-as-owner simulation (lambda () (run-live simulation))))
                        (format nil "simulator of ~A" (simulation-name simulation))))
    (signal-semaphore started))
  simulation)

(defun stop-clock (simulation)
  "End the thread of the live SIMULATION after its current tick and wait for that. Commands under
way stay as they are; START-CLOCK goes on with them. Return SIMULATION."
  (let ((thread (simulation-thread simulation)))
    (when thread
      (setf (simulation-stopping-p simulation) t)
      (signal-semaphore (simulation-wake-up simulation))
      (unless (eq thread (current-thread)) (join-thread thread))
      (setf (simulation-thread simulation) nil)
      (answer-questions simulation)))
  simulation)

(defun end-run (simulation reason resources function)
  "Stop SIMULATION for good, for REASON, a sentence without its full stop, and call FUNCTION. Then
whatever was asked of SIMULATION and occupies RESOURCES, or has not even begun, is interrupted;
nothing can be asked of it any more."
  (unless (simulation-over simulation)
    (setf (simulation-over simulation) reason)
    (stop-clock simulation)
    (let ((*message-queue* (simulation-messages simulation)))
      (funcall function)
      (open-inbox simulation)
      (abandon simulation resources))))

;;; Steering.

(defun check-rate (rate)
  (check-argument rate rate (or (eq rate :free) (and (realp rate) (plusp rate)))
                  "a positive number of ticks per second, or :free"))

(defun steer (simulation)
  (signal-semaphore (simulation-wake-up simulation))
  (values))

(addition pause)
(defun pause (&optional (simulation (current-simulation)))
  "Let the live SIMULATION stand still after its current tick, until RESUME. Returns nothing."
  (setf (simulation-paused-p simulation) t
        (simulation-steps simulation) 0)
  (steer simulation))

(addition resume)
(defun resume (&optional (simulation (current-simulation)))
  "Let the live SIMULATION go on after PAUSE. Returns nothing."
  (setf (simulation-paused-p simulation) nil
        (simulation-steps simulation) 0)
  (steer simulation))

(addition step-ticks)
(defun step-ticks (&optional (count 1) (simulation (current-simulation)))
  "Pass COUNT ticks and then pause. A headless SIMULATION has passed them on return; a live one
passes them at its pace. Returns nothing."
  (check-argument step-ticks count (typep count '(integer 1)) "a number of ticks, 1 or more")
  (cond ((live-p simulation)
         (setf (simulation-steps simulation) count
               (simulation-paused-p simulation) t)
         (steer simulation))
        (t (run-ticks count simulation)
           (values))))

(addition set-rate)
(defun set-rate (rate &optional (simulation (current-simulation)))
  "Set the pace of SIMULATION to RATE, ticks per second or :FREE. Returns RATE. Signals
WRONG-ARGUMENT."
  (check-rate rate)
  (setf (simulation-rate simulation) rate)
  (steer simulation)
  rate)

(addition await-idle)
(defun await-idle (&optional (simulation (current-simulation)) (seconds 60))
  "Wait until nothing is left to do in the live SIMULATION, at most SECONDS. True if so."
  (let ((idle (make-semaphore "idle")))
    (flet ((look (simulation)
             (when (idle-p simulation) (signal-semaphore idle))))
      (asking (simulation)
        (add-observer #'look simulation)
        (look simulation))
      (unwind-protect (and (wait-on-semaphore idle seconds) t)
        (asking (simulation) (remove-observer #'look simulation))))))
