;;;; pacing.lisp -- ticks that pass by themselves, in a thread of their own (manual 2.3, A).

(in-package :ars-magna.time)

;;; The thread passes ticks at the pace RATE, a number of ticks per second or :FREE, for as long as
;;; anything is to be done; while all is idle it sleeps, and simulated time stands still. Between
;;; ticks it answers questions. Others steer it by setting its fields and waking it. What a tick is,
;;; and whether there is anything to do, is said by functions. This is the only file that reads
;;; the real clock, and no result depends on what it reads.

(addition *default-rate*)
(defparameter *default-rate* 20
  "The pace of a live simulation unless another is given: ticks per second, or :FREE.")

(addition *hog-seconds*)
(defparameter *hog-seconds* 0.5
  "A continuation that keeps the simulator's thread for longer earns a warning, in seconds.")

(defstruct (pacing (:constructor make-pacing (rate tick idle-p)) (:copier nil))
  "How a timeline is paced. TICK passes one tick, IDLE-P says whether none is needed."
  (rate nil)
  (tick nil :type function :read-only t)
  (idle-p nil :type function :read-only t)
  (paused-p nil)
  (stopping-p nil)
  ;; How many ticks to pass although it is paused.
  (steps 0 :type fixnum))

(defun seconds-now ()
  "Return the real time, in seconds since some moment. No result may depend on it."
  (/ (float (get-internal-real-time) 1d0) internal-time-units-per-second))

(addition live-p)
(defun live-p (&optional (simulation (current-simulation)))
  "True if SIMULATION runs in a thread of its own."
  (and (timeline-thread (timeline-of simulation)) t))

(addition paused-p)
(defun paused-p (&optional (simulation (current-simulation)))
  "True if the live SIMULATION has been told to pause."
  (let ((pacing (timeline-pacing (timeline-of simulation))))
    (and pacing (pacing-paused-p pacing))))

(defun pace (simulation)
  "Return the pace of SIMULATION: ticks per second, or :FREE; NIL if it never ran live."
  (let ((pacing (timeline-pacing (timeline-of simulation))))
    (and pacing (pacing-rate pacing))))

;;; Resting.

(defun sleep-until-woken (timeline seconds)
  "Sleep for SECONDS (NIL: for as long as it takes), but not while somebody wants something."
  (setf (timeline-asleep-p timeline) t)
  (memory-barrier)
  (unless (timeline-questions timeline)
    (wait-on-semaphore (timeline-wake-up timeline) seconds))
  (setf (timeline-asleep-p timeline) nil))

(defun nothing-to-do-p (pacing)
  (if (pacing-paused-p pacing)
      (zerop (pacing-steps pacing))
      (funcall (pacing-idle-p pacing))))

(defun rest-thread (timeline pacing)
  "Sleep for as long as there is nothing to do (reading 88)."
  (setf (timeline-asleep-p timeline) t)
  (memory-barrier)
  (when (and (nothing-to-do-p pacing)
             (null (timeline-questions timeline))
             (not (pacing-stopping-p pacing)))
    ;; The timeout covers tests that come true without anybody posting.
    (wait-on-semaphore (timeline-wake-up timeline) 1))
  (setf (timeline-asleep-p timeline) nil))

(defun keep-pace (timeline pacing due)
  "Sleep until the time DUE, in seconds; return when the next tick is due."
  (let ((rate (pacing-rate pacing)))
    (if (eq rate :free)
        (seconds-now)
        (loop for left = (- due (seconds-now))
              while (and (plusp left)
                         (not (pacing-stopping-p pacing))
                         (eql rate (pacing-rate pacing)))
              do (sleep-until-woken timeline left)
                 (answer-questions timeline)
              finally (return (+ (max due (- (seconds-now) 0.25d0)) (/ 1d0 (float rate 1d0))))))))

;;; The thread.

(defun pass-tick (pacing)
  "Pass a tick. Trouble that no user code answers for is reported and pauses the clock."
  (handler-bind ((error (lambda (trouble)
                          (unless *break-on-user-error*
                            (error-set "The simulator failed and is paused; RESUME goes on: "
                                       (princ-to-string trouble))
                            (setf (pacing-paused-p pacing) t)
                            (return-from pass-tick)))))
    (funcall (pacing-tick pacing)))
  (when (plusp (pacing-steps pacing)) (decf (pacing-steps pacing))))

(defun run-paced (timeline pacing)
  (loop with due = (seconds-now)
        until (or (pacing-stopping-p pacing)
                  ;; Stopped from within and started again: another thread has taken over.
                  (not (eq (current-thread) (timeline-thread timeline))))
        do (answer-questions timeline)
           (cond ((nothing-to-do-p pacing)
                  (rest-thread timeline pacing)
                  (setf due (seconds-now)))
                 (t (setf due (keep-pace timeline pacing due))
                    (unless (pacing-stopping-p pacing)
                      (pass-tick pacing))))))

(defun start-pacing (timeline tick idle-p rate caller)
  "Let a new thread pass ticks of TIMELINE at RATE by calling TICK, as long as IDLE-P is false, both
functions of no arguments. The thread works inside CALLER, a function of a function that calls it.
Signals MISUSE if it is live already, WRONG-ARGUMENT for a rate that is neither a number from
0.001 to 1000000 nor :FREE."
  (check-rate rate)
  (when (live-p timeline) (reject-use "~A runs live already." (timeline-name timeline)))
  (let ((started (make-semaphore "started"))
        (pacing (make-pacing rate tick idle-p)))
    (setf (timeline-pacing timeline) pacing
          (timeline-thread timeline)
          (start-thread (lambda ()
                          (wait-on-semaphore started)
                          (funcall caller (lambda () (run-paced timeline pacing))))
                        (format nil "simulator of ~A" (timeline-name timeline))))
    (signal-semaphore started))
  timeline)

(defun stop-pacing (timeline)
  "End the thread of TIMELINE after its current tick and wait for that. Return TIMELINE."
  (let ((thread (timeline-thread timeline)))
    (when thread
      (setf (pacing-stopping-p (timeline-pacing timeline)) t)
      (signal-semaphore (timeline-wake-up timeline))
      (unless (eq thread (current-thread)) (join-thread thread))
      (setf (timeline-thread timeline) nil)
      (answer-questions timeline)))
  timeline)

(defun call-watched (object function origin)
  "Call FUNCTION; warn that ORIGIN hogs the simulator's thread if a live one had to wait long."
  (if (live-p object)
      (let ((start (seconds-now)))
        (funcall function)
        (let ((seconds (- (seconds-now) start)))
          (when (> seconds *hog-seconds*)
            (warning-set (format nil "~A kept the simulator waiting for ~,1F s" origin seconds)))))
      (funcall function)))

;;; Steering.

(define-argument-type 'rate
  (lambda (value) (or (eq value :free) (and (finite-p value) (<= 1/1000 value 1000000))))
  "a number of ticks per second, from 0.001 to 1000000, or :free")

(defun check-rate (rate)
  "Signal WRONG-ARGUMENT unless RATE can be the pace of a clock."
  (check-of-type 'set-rate 'rate rate 'rate))

(defun steer (simulation &key (rate nil rate-p) (paused-p nil paused-p-p) steps)
  "Change how SIMULATION is paced, and wake it. Without effect if it never ran live."
  (let* ((timeline (timeline-of simulation)) (pacing (timeline-pacing timeline)))
    (when pacing
      (when steps (setf (pacing-steps pacing) steps))
      (when paused-p-p (setf (pacing-paused-p pacing) paused-p))
      (when rate-p (setf (pacing-rate pacing) rate))
      (signal-semaphore (timeline-wake-up timeline)))
    (values)))

(addition pause)
(defun pause (&optional (simulation (current-simulation)))
  "Let the live SIMULATION stand still after its current tick, until RESUME. Returns nothing."
  (steer simulation :steps 0 :paused-p t))

(addition resume)
(defun resume (&optional (simulation (current-simulation)))
  "Let the live SIMULATION go on after PAUSE. Returns nothing."
  (steer simulation :steps 0 :paused-p nil))

(defun let-pass (count simulation)
  "Let COUNT ticks of the live SIMULATION pass, at its pace, and then pause. Returns nothing."
  (steer simulation :steps count :paused-p t))

(addition set-rate)
(defun set-rate (rate &optional (simulation (current-simulation)))
  "Set the pace of SIMULATION to RATE, from 0.001 to 1000000 ticks per second, or :FREE. Returns
RATE. Signals WRONG-ARGUMENT."
  (check-rate rate)
  (steer simulation :rate rate)
  rate)
