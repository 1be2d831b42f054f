;;;; pacing.lisp -- the pace of ticks in real time, and their end (2.3, A).

(in-package :ars-magna.time)

(export '(timeline-thread pacing-thread-p check-rate clock-failure-text *user-can-resume-p*
          pass-then-pause pace hog-seconds seconds-now stop-pacing claim-pacing pacing-claimed-p
          unclaim-pacing call-without-clock users-code-in-progress users-code-in-debugger-p
          abort-hog))

;;; A thread passes ticks at the pace RATE, in ticks per second or :FREE, while there is anything to
;;; do (clock.lisp). Other threads control it: they set slots of the PACING structure and wake it.

(addition *default-rate*)
(defparameter *default-rate* 20
  "The default pace of live simulations: ticks per second, or :FREE.")

(addition *hog-seconds*)
(defparameter *hog-seconds* 0.5
  "A warning names a user's function, such as a continuation, that runs for more than this number of
seconds, at least 0.05, in the simulator's thread. STOP-SIMULATOR interrupts such a function after
the same time. Set the variable with SETF: a LET does not affect the simulator's threads.")

(defun hog-seconds ()
  "Return the value of *HOG-SECONDS*, or 0.05 if the value is invalid."
  (if (typep *hog-seconds* '(real 0.05 1000000)) *hog-seconds* 0.05))

(defstruct (pacing (:constructor make-pacing (timeline rate tick idle-p calls)) (:copier nil))
  "How a timeline is paced. The function TICK passes one tick; IDLE-P returns true if none is
needed. CALLS records the calls of users' code by the thread."
  (timeline nil :type timeline :read-only t)
  (rate nil)
  (tick nil :type function :read-only t)
  (idle-p nil :type function :read-only t)
  (calls nil :type user-calls :read-only t)
  (thread nil)
  ;; True when the thread has ended; and the semaphore that wakes those waiting for it.
  (over-p nil)
  (ended (make-semaphore "ended") :read-only t)
  (paused-p nil)
  ;; True when the next tick is due at once: the first one, and the one after a pause.
  (due-p t)
  ;; True when it should end; :REPLACED if another run follows and no thread has stopped this one.
  (stopping-p nil)
  ;; A text about the failure that has paused it, or NIL.
  (trouble nil :type (or null string))
  ;; The number of the call of users' code that a warning about slow code has named last.
  (hog nil)
  ;; How many ticks to pass although it is paused.
  (steps 0 :type fixnum))

(defun pacing-custody (pacing)
  (timeline-custody (pacing-timeline pacing)))

(defun wake-clock (pacing)
  (signal-semaphore (custody-wake-up (pacing-custody pacing))))

(defun seconds-now ()
  "Return the real time, on which results must not depend, in seconds since an arbitrary moment."
  (/ (float (get-internal-real-time) 1d0) internal-time-units-per-second))

(defmacro when-pacing ((pacing object) &body body)
  "If OBJECT's run was ever live, run BODY with PACING bound to its pacing; else return NIL."
  `(let ((,pacing (timeline-pacing (timeline-of ,object))))
     (when ,pacing ,@body)))

(defun timeline-thread (timeline)
  "Return the thread that paces TIMELINE; NIL if there is none, or if the thread was asked to stop."
  (when-pacing (pacing timeline)
    (and (not (pacing-stopping-p pacing)) (pacing-thread pacing))))

(defun pacing-thread-p (timeline)
  "True if this thread paces TIMELINE, or was the last thread to pace it."
  (when-pacing (pacing timeline) (eq (current-thread) (pacing-thread pacing))))

(addition live-p)
(defun live-p (&optional (simulation (current-simulation)))
  "True if SIMULATION runs live, in a separate thread."
  (and (timeline-thread (timeline-of simulation)) t))

(addition paused-p)
(defun paused-p (&optional (simulation (current-simulation)))
  "True if the live SIMULATION was paused."
  (when-pacing (pacing simulation) (pacing-paused-p pacing)))

(defvar *user-can-resume-p* t
  "True if an interactive user can resume a paused run while this thread waits.")

(defun clock-failure-text (simulation)
  "Return a text about the failure that has paused the live SIMULATION, or NIL."
  (when-pacing (pacing simulation) (pacing-trouble pacing)))

(defun pace (simulation)
  "Return the pace of SIMULATION: ticks per second, or :FREE; NIL if SIMULATION was never live."
  (when-pacing (pacing simulation) (pacing-rate pacing)))

;;; Pausing and resuming.

(define-argument-type 'rate
  (lambda (value) (or (eq value :free) (and (finite-p value) (<= 1/1000 value 1000000))))
  "a number of ticks per second, from 0.001 to 1000000, or :free")

(defun check-rate (rate)
  "Signal WRONG-ARGUMENT unless RATE is a valid pace."
  (check-argument-type 'set-rate 'rate rate 'rate))

(defun set-paused (simulation paused-p steps)
  "If PAUSED-P is true, pause the live SIMULATION after STEPS more ticks; otherwise resume it."
  (when-pacing (pacing simulation)
    (when (pacing-paused-p pacing) (setf (pacing-due-p pacing) t))
    (setf (pacing-steps pacing) steps
          (pacing-paused-p pacing) paused-p
          (pacing-trouble pacing) nil)
    (wake-clock pacing))
  (values))

(addition pause)
(defun pause (&optional (simulation (current-simulation)))
  "Pause the live SIMULATION after its current tick, until RESUME. Returns nothing."
  (set-paused simulation t 0))

(addition resume)
(defun resume (&optional (simulation (current-simulation)))
  "Resume the live SIMULATION after PAUSE. Returns nothing."
  (set-paused simulation nil 0))

(defun pass-then-pause (count simulation)
  "Pass COUNT ticks of the live SIMULATION, at its pace, then pause it. Returns nothing."
  (set-paused simulation t count))

(addition set-rate)
(defun set-rate (rate &optional (simulation (current-simulation)))
  "Set the pace of SIMULATION to RATE, from 0.001 to 1000000 ticks per second, or :FREE. Returns
RATE. Signals WRONG-ARGUMENT."
  (check-rate rate)
  (when-pacing (pacing simulation)
    (setf (pacing-rate pacing) rate)
    (wake-clock pacing))
  rate)

;;; The thread ends after its tick. Endless user code is aborted only when somebody stops the run.

(defun wait-for-thread-end (pacing seconds)
  (loop with due = (+ (seconds-now) seconds)
        ;; A thread that was woken may have been interrupted before it could wake the next one.
        when (or (pacing-over-p pacing)
                 (wait-while-answering (pacing-ended pacing) (min seconds 0.2)))
          do (signal-semaphore (pacing-ended pacing)) ; for other waiting threads
             (return t)
        until (> (seconds-now) due)))

(defun interrupt-hog (pacing)
  "If the thread of PACING is in users' code, abort this code and return true."
  (let* ((calls (pacing-calls pacing)) (count (user-calls-count calls)))
    (when (user-calls-origin calls)
      (interrupt-thread (pacing-thread pacing) (lambda () (abort-user-code count)))
      t)))

(defun force-thread-end (pacing)
  "Wait for the thread of PACING to end. Repeatedly interrupt users' code that does not return.
Signals MISUSE if the thread does not end."
  (loop repeat 10
        when (wait-for-thread-end pacing (hog-seconds))
          return t
        do (interrupt-hog pacing)
        finally (let ((origin (user-calls-origin (pacing-calls pacing))))
                  (reject-use "The simulator of ~A does not stop~@[: ~A cannot be interrupted~]."
                              (timeline-name (pacing-timeline pacing))
                              (and origin (text-of-origin origin))))))

(defun stop-pacing-thread (pacing)
  "End the thread of PACING after its current tick; if it is another thread, wait for its end."
  (swap-if-eq (pacing-stopping-p pacing) nil t)
  (wake-clock pacing)
  (unless (eq (pacing-thread pacing) (current-thread))
    (force-thread-end pacing)))

(defun claim-pacing (timeline)
  "Ask the thread that paces TIMELINE to end after its current tick, because this thread will
replace the run. Return true if the run was live and no thread had stopped it."
  (when-pacing (pacing timeline) (swap-if-eq (pacing-stopping-p pacing) nil :replaced)))

(defun pacing-claimed-p (timeline)
  "True if CLAIM-PACING has returned true for TIMELINE without a later call of UNCLAIM-PACING."
  (when-pacing (pacing timeline) (eq :replaced (pacing-stopping-p pacing))))

(defun unclaim-pacing (timeline)
  "Prevent a run that will replace the stopped run of TIMELINE from becoming live."
  (when-pacing (pacing timeline) (swap-if-eq (pacing-stopping-p pacing) :replaced t)))

(defun stop-pacing (timeline)
  "End the thread that paces TIMELINE after its current tick. If it is another thread, wait for its
end. Return TIMELINE. Signals MISUSE if the thread is in users' code that cannot be interrupted."
  (when-pacing (pacing timeline) (stop-pacing-thread pacing))
  timeline)

(defun call-without-clock (timeline function)
  "Stop the thread that paces TIMELINE's world. Call FUNCTION with custody, and return its value."
  (let ((custody (timeline-custody timeline)))
    (loop
      (block busy
        (return (call-with-custody custody function
                                   (lambda ()
                                     (let ((pacing (custody-pacing custody)))
                                       (if pacing
                                           (stop-pacing-thread pacing)
                                           (ask-owner custody (constantly nil))))
                                     (return-from busy))))))))

;;; Warnings about slow users' code. A second thread checks twice in *HOG-SECONDS* where the
;;; simulation's thread is. A call seen three times in a row has lasted for that long.

(defun watch-for-hogs (pacing)
  "Warn about users' code that does not return to the thread of PACING, until that thread ends."
  (loop with calls = (pacing-calls pacing) and seen = nil and looks = 0
        until (wait-for-thread-end pacing (/ (hog-seconds) 2))
        do (let ((origin (user-calls-origin calls)) (count (user-calls-count calls)))
             (cond ((or (null origin) (/= count (or seen -1)) (user-calls-waiting-p calls))
                    (setf seen (and origin count) looks 1))
                   ((= 3 (incf looks))
                    (setf (pacing-hog pacing) count)
                    (warn-at-once (format nil "~A has kept the simulator waiting for ~,1F s and is ~
                                               still running; (stop-simulator) interrupts it"
                                          (text-of-origin origin) (hog-seconds))))))))

(defun users-code-in-progress (simulation)
  "Return two values: a text that names the users' code in the thread of the live SIMULATION, and
the number of calls of users' code that have begun in this thread. Return NIL if the thread is not
in users' code, or waits in a debugger."
  (when-pacing (pacing simulation)
    (let* ((calls (pacing-calls pacing))
           (origin (and (not (user-calls-waiting-p calls)) (user-calls-origin calls))))
      (and origin (values (text-of-origin origin) (user-calls-count calls))))))

(defun users-code-in-debugger-p (simulation)
  "True if the thread of the live SIMULATION is in users' code that waits in a debugger."
  (when-pacing (pacing simulation)
    (let ((calls (pacing-calls pacing)))
      (and (user-calls-origin calls) (user-calls-waiting-p calls) t))))

(defun abort-hog (simulation)
  "If a warning has named users' code of the live SIMULATION that still runs, abort it. True if so."
  (when-pacing (pacing simulation)
    (and (eql (pacing-hog pacing) (user-calls-count (pacing-calls pacing)))
         (interrupt-hog pacing))))
