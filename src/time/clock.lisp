;;;; clock.lisp -- a thread that passes ticks in real time (manual 2.3, A).

(in-package :ars-magna.time)

(export '(paused-without-steps-p start-pacing))

;;; While the run is idle the thread sleeps, and simulated time stands still. Between ticks it
;;; answers questions. It owns the world until it ends, for any reason. Functions given to it pass a
;;; tick, and tell whether there is anything to do.

;;; Resting.

(defun sleep-until-woken (custody seconds &optional (may-p (constantly t)))
  "If the function MAY-P returns true, sleep for SECONDS or until another thread asks a question."
  (setf (custody-asleep-p custody) t)
  (memory-barrier)
  (when (and (funcall may-p) (null (custody-questions custody)))
    (wait-on-semaphore (custody-wake-up custody) seconds))
  (setf (custody-asleep-p custody) nil))

(defun pause-in-effect-p (pacing)
  "True if the clock of PACING is paused, and no requested ticks remain to be passed."
  (and (pacing-paused-p pacing) (zerop (pacing-steps pacing))))

(defun paused-without-steps-p (simulation)
  "True if the live SIMULATION is paused, and no requested ticks remain to be passed."
  (when-pacing (pacing simulation) (pause-in-effect-p pacing)))

(defun paused-or-stopped-p (pacing)
  (or (pacing-stopping-p pacing) (pause-in-effect-p pacing)))

(defun nothing-to-do-p (pacing)
  (if (pacing-paused-p pacing)
      (pause-in-effect-p pacing)
      (funcall (pacing-idle-p pacing))))

(defun seconds-per-tick (pacing)
  (let ((rate (pacing-rate pacing)))
    (if (eq rate :free) 0d0 (/ 1d0 (float rate 1d0)))))

;; RESUME takes effect at once, even if it follows PAUSE so soon that this thread saw no pause.
(defun due-time (pacing last)
  "Return the time when the next tick is due for PACING, if the tick before was due at LAST."
  (if (pacing-due-p pacing)
      (min last (seconds-now))
      (+ last (seconds-per-tick pacing))))

(defun keep-pace (custody pacing last)
  "Sleep until the next tick is due, if the tick before was due at the time LAST, in seconds. Return
the time when the next tick was due; lateness of more than a quarter of a second is not made up."
  ;; The rate may change meanwhile.
  (loop for due = (due-time pacing last)
        for left = (- due (seconds-now))
        while (and (plusp left) (not (paused-or-stopped-p pacing)))
        do (sleep-until-woken custody left)
           (answer-questions custody)
        finally (setf (pacing-due-p pacing) nil)
                (return (max due (- (seconds-now) (if (eq :free (pacing-rate pacing)) 0 0.25d0))))))

(defun time-to-go-on (pacing last)
  "Return the time from which KEEP-PACE counts after a rest, if the tick before was due at LAST."
  (max last (- (seconds-now) (seconds-per-tick pacing))))

(defun rest-until-woken (custody pacing)
  "Sleep while there is nothing to do for PACING, at most a second."
  ;; The timeout covers tests that come true without a request (reading 88).
  (sleep-until-woken custody 1 (lambda ()
                                 (and (nothing-to-do-p pacing)
                                      (not (pacing-stopping-p pacing))))))

;;; Passing ticks.

(defun pause-after-failure (pacing trouble)
  "Pause the clock of PACING because of the condition TROUBLE, an error in the simulator itself."
  (let ((text (format nil "The simulator failed and is paused; RESUME continues: ~A"
                      (brief-condition-text trouble))))
    (queue-user-error trouble text text))
  (setf (pacing-paused-p pacing) t
        (pacing-trouble pacing) (brief-condition-text trouble)))

(defun pass-tick (pacing)
  "Pass a tick. An error in the simulator, not in users' code, is reported and pauses the clock."
  (handler-case (funcall (pacing-tick pacing))
    ((or error storage-condition) (trouble) (pause-after-failure pacing trouble)))
  (when (plusp (pacing-steps pacing)) (decf (pacing-steps pacing))))

(defun run-paced (custody pacing)
  "Pass ticks at the pace of PACING, until PACING is stopped or another thread has CUSTODY."
  (loop with last = (seconds-now)
        until (or (pacing-stopping-p pacing) (not (has-custody-p custody)))
        do (answer-questions custody)
           (cond ((nothing-to-do-p pacing)
                  (rest-until-woken custody pacing)
                  (setf last (time-to-go-on pacing last)))
                 (t (setf last (keep-pace custody pacing last))
                    ;; It may have been paused while it waited.
                    (unless (paused-or-stopped-p pacing)
                      (pass-tick pacing))))))

(defun release-pacing (custody pacing)
  "The thread of PACING ends, perhaps because it was killed. Release its custody."
  (in-any-case
    (unless (pacing-stopping-p pacing)
      (setf (pacing-stopping-p pacing) t)
      (unless *exiting-p*
        (let ((text (format nil "The simulator's thread was ended from outside. (simulator ROBOT) ~
                                 starts another.")))
          (queue-user-error :ended text text))))
    (when (eq pacing (custody-pacing custody))
      (setf (custody-pacing custody) nil))
    (give-up-custody custody)
    (setf (pacing-over-p pacing) t)
    (signal-semaphore (pacing-ended pacing))))

(defun run-pacing-thread (pacing ready start)
  "Signal the semaphore READY when this thread can be ended at any moment. Wait for the semaphore
START. Then pass ticks at the pace of PACING, if this thread has got custody."
  (let* ((custody (pacing-custody pacing))
         (*held-custodies* (list custody))
         (*user-calls* (pacing-calls pacing)))
    (in-any-case
      (progn (signal-semaphore ready)
             (wait-on-semaphore start)
             (run-paced custody pacing))
      (release-pacing custody pacing))))

;;; Starting.

(defun make-threads (pacing caller ready start)
  (let ((name (format nil "simulator of ~A" (timeline-name (pacing-timeline pacing)))))
    (setf (pacing-thread pacing)
          (start-thread (lambda ()
                          (funcall caller (lambda () (run-pacing-thread pacing ready start))))
                        name))
    (start-thread (lambda () (funcall caller (lambda () (watch-for-hogs pacing))))
                  (format nil "watcher of the ~A" name))))

;; A time limit may interrupt this at any moment: then the threads end, or the world is live. START
;; is signalled in any case, so that no thread waits for it for ever.
(defun start-threads (pacing caller)
  (let ((ready (make-semaphore "ready"))
        (start (make-semaphore "start"))
        (ready-p nil))
    (deferring-interrupts
      (in-any-case
        (allowing-interrupts
          (make-threads pacing caller ready start)
          (wait-on-semaphore ready)
          (setf ready-p t))
        (if ready-p
            (let ((custody (pacing-custody pacing)))
              (setf (timeline-pacing (pacing-timeline pacing)) pacing
                    (custody-pacing custody) pacing)
              (hand-over-custody custody (pacing-thread pacing)))
            (setf (pacing-stopping-p pacing) t))
        (signal-semaphore start)))))

(defun start-pacing (timeline tick idle-p rate caller &key paused-p)
  "Start a thread that passes ticks of TIMELINE at RATE. The thread calls TICK for each tick, while
IDLE-P returns false. If PAUSED-P is true, ticks pass only after RESUME. The thread calls CALLER
with a function that does all work of the thread. The thread takes over custody of TIMELINE from
this thread. Return TIMELINE. Signals MISUSE if TIMELINE is already live, and WRONG-ARGUMENT if RATE
is neither a number from 0.001 to 1000000 nor :FREE."
  (check-rate rate)
  (when (live-p timeline) (reject-use "~A already runs live." (timeline-name timeline)))
  (let ((pacing (make-pacing timeline rate tick idle-p
                             (make-user-calls (lambda () (stop-pacing timeline))))))
    (setf (pacing-paused-p pacing) paused-p)
    (start-threads pacing caller))
  timeline)
