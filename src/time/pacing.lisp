;;;; pacing.lisp -- the pace of ticks that pass by themselves (manual 2.3, A).

(in-package :ars-magna.time)

(export '(timeline-thread pacer-p check-rate clock-trouble *waits-while-paused-p* let-pass pace
          hog-seconds seconds-now))

;;; A thread passes ticks at the pace RATE, a number of ticks per second or :FREE, for as long as
;;; anything is to be done (clock.lisp). Others steer it by setting its fields and waking it.

(addition *default-rate*)
(defparameter *default-rate* 20
  "The pace of a live simulation unless another is given: ticks per second, or :FREE.")

(addition *hog-seconds*)
(defparameter *hog-seconds* 0.5
  "For how many seconds a user's function, such as a continuation, may keep the simulator's thread
before a warning names it; also how long STOP-SIMULATOR waits before it interrupts one. At least
0.05. Threads of the simulator read it, so set it with SETF: a LET does not reach them.")

(defun hog-seconds ()
  "Return *HOG-SECONDS*, within bounds."
  (if (typep *hog-seconds* '(real 0.05 1000000)) *hog-seconds* 0.05))

(defstruct (pacing (:constructor make-pacing (timeline rate tick idle-p calls)) (:copier nil))
  "How a timeline is paced. TICK passes one tick, IDLE-P says whether none is needed, CALLS tells
what users' code the thread is in."
  (timeline nil :type timeline :read-only t)
  (rate nil)
  (tick nil :type function :read-only t)
  (idle-p nil :type function :read-only t)
  (calls nil :type user-calls :read-only t)
  (thread nil)
  ;; True when the thread has ended, and what then wakes one of those who wait for that.
  (over-p nil)
  (ended (make-semaphore "ended") :read-only t)
  (paused-p nil)
  ;; True when it is to end: :REPLACED if another run is to go on and nobody has stopped this one.
  (stopping-p nil)
  ;; What it has failed by and is paused for, in words, or NIL.
  (trouble nil :type (or null string))
  ;; The number of the call of users' code that was named last for keeping the thread waiting.
  (hog nil)
  ;; How many ticks to pass although it is paused.
  (steps 0 :type fixnum))

(defun pacing-custody (pacing)
  (timeline-custody (pacing-timeline pacing)))

(defun wake (pacing)
  (signal-semaphore (custody-wake-up (pacing-custody pacing))))

(defun seconds-now ()
  "Return the real time, in seconds since some moment. No result may depend on it."
  (/ (float (get-internal-real-time) 1d0) internal-time-units-per-second))

(defmacro if-paced ((pacing object) &body body)
  "Run BODY with PACING bound to how the run of OBJECT is paced. NIL if it never was."
  `(let ((,pacing (timeline-pacing (timeline-of ,object))))
     (when ,pacing ,@body)))

(defun timeline-thread (timeline)
  "Return the thread that paces TIMELINE, or NIL if none does, or it has been told to stop."
  (if-paced (pacing timeline)
    (and (not (pacing-stopping-p pacing)) (pacing-thread pacing))))

(defun pacer-p (timeline)
  "True if this thread is the one that paces TIMELINE, or did last."
  (if-paced (pacing timeline) (eq (current-thread) (pacing-thread pacing))))

(addition live-p)
(defun live-p (&optional (simulation (current-simulation)))
  "True if SIMULATION runs in a thread of its own."
  (and (timeline-thread (timeline-of simulation)) t))

(addition paused-p)
(defun paused-p (&optional (simulation (current-simulation)))
  "True if the live SIMULATION has been told to pause."
  (if-paced (pacing simulation) (pacing-paused-p pacing)))

(defvar *waits-while-paused-p* t
  "True if somebody sits where this thread waits, and may let a run go on that is paused.")

(defun clock-trouble (simulation)
  "Return in words what the live SIMULATION has failed by, if it is paused for that; else NIL."
  (if-paced (pacing simulation) (pacing-trouble pacing)))

(defun pace (simulation)
  "Return the pace of SIMULATION: ticks per second, or :FREE; NIL if it never ran live."
  (if-paced (pacing simulation) (pacing-rate pacing)))

;;; Steering.

(define-argument-type 'rate
  (lambda (value) (or (eq value :free) (and (finite-p value) (<= 1/1000 value 1000000))))
  "a number of ticks per second, from 0.001 to 1000000, or :free")

(defun check-rate (rate)
  "Signal WRONG-ARGUMENT unless RATE can be the pace of a clock."
  (check-of-type 'set-rate 'rate rate 'rate))

(defun steer (simulation paused-p steps)
  "Let SIMULATION be paused if PAUSED-P, but pass STEPS ticks, and wake it. Without effect if it
never ran live."
  (if-paced (pacing simulation)
    (setf (pacing-steps pacing) steps
          (pacing-paused-p pacing) paused-p
          (pacing-trouble pacing) nil)
    (wake pacing))
  (values))

(addition pause)
(defun pause (&optional (simulation (current-simulation)))
  "Let the live SIMULATION stand still after its current tick, until RESUME. Returns nothing."
  (steer simulation t 0))

(addition resume)
(defun resume (&optional (simulation (current-simulation)))
  "Let the live SIMULATION go on after PAUSE. Returns nothing."
  (steer simulation nil 0))

(defun let-pass (count simulation)
  "Let COUNT ticks of the live SIMULATION pass, at its pace, and then pause. Returns nothing."
  (steer simulation t count))

(addition set-rate)
(defun set-rate (rate &optional (simulation (current-simulation)))
  "Set the pace of SIMULATION to RATE, from 0.001 to 1000000 ticks per second, or :FREE. Returns
RATE. Signals WRONG-ARGUMENT."
  (check-rate rate)
  (if-paced (pacing simulation)
    (setf (pacing-rate pacing) rate)
    (wake pacing))
  rate)
