;;;; progress.lisp -- how time goes in a run: the rate as set and as reached, and whether it stands.

(in-package :ars-magna.clim)

(defstruct (progress (:copier nil))
  "How time goes. STATE is a word, MORE a text that goes on from it or NIL; RATE as set, a number or
:FREE, or NIL; REACHED in ticks a second, or NIL if that is not known."
  (state :still :type symbol :read-only t)
  (more nil :type (or null string) :read-only t)
  (rate nil :read-only t)
  (reached nil :type (or null real) :read-only t))

(defstruct (pulse (:copier nil))
  "What was seen of a run before: the tick at the last look and how many calls of users' code there
had been; the tick and second from which on the rate is being measured, and that rate."
  (last-tick 0 :type fixnum)
  (calls nil :type (or null fixnum))
  (tick 0 :type fixnum)
  (seconds 0d0 :type double-float)
  (reached nil :type (or null real)))

(defun begin-pulse (simulation)
  (let ((tick (simulation-tick simulation)))
    (make-pulse :last-tick tick :tick tick :seconds (seconds-now))))

(defun state-words (state)
  (ecase state
    (:running "running")
    (:paused "paused")
    (:still "not live: ticks pass when a program asks for them")
    (:forked "in a fork: ticks pass when lines ask for them")
    (:ended "the trial is over: TRIAL OFF leads out")
    (:stopped "stopped: the line RESUME goes on")
    (:over "over")
    (:idle "idle: time stands still until there is something to do")
    (:waiting "waiting for a plan")
    (:busy "busy in")
    (:broken "stopped: a program has broken")))

(defun rate-text (rate)
  (cond ((eq rate :free) "as fast as possible")
        (rate (format nil "~A/s" (number-text rate)))))

(defun progress-text (progress)
  (format nil "~@[~A~]~@[ (~A reached)~]  ~A~@[ ~A~]"
          (rate-text (progress-rate progress))
          (rate-text (progress-reached progress))
          (state-words (progress-state progress))
          (progress-more progress)))

;;; Looking.

(defun busy-p (simulation pulse)
  "Return in words what users' code has kept SIMULATION waiting since the last look, or NIL."
  (multiple-value-bind (text calls) (users-code-under-way simulation)
    (and (eql calls (shiftf (pulse-calls pulse) calls))
         (= (simulation-tick simulation) (pulse-last-tick pulse))
         text)))

(defun rate-set (simulation)
  "Return at what rate ticks pass in SIMULATION, as set; NIL if there is none."
  (if (live-p simulation)
      (simulation-rate simulation)
      (nth-value 1 (ars-magna.cli:pace-of simulation))))

(defun paused-here-p (simulation)
  "True if time stands still in SIMULATION until RESUME: it is paused, or a trial that is."
  (if (live-p simulation)
      (paused-p simulation)
      (eq :paused (ars-magna.cli:pace-of simulation))))

(defun state-of (simulation pulse)
  "Return the state of SIMULATION, and NIL or a text that goes on from what that is called."
  (let ((busy (busy-p simulation pulse)))
    (cond ((and (simulation-over simulation)
                (not (eq :ended (ars-magna.cli:pace-of simulation))))
           :over)
          ;; In a trial or fork the prompt lets ticks pass.
          ((not (live-p simulation))
           (or (ars-magna.cli:pace-of simulation) (if (headless-p simulation) :still :stopped)))
          ((users-code-broken-p simulation)
           (values :broken (ars-magna.cli:asker-of-break simulation)))
          (busy (values :busy busy))
          ((paused-p simulation) :paused)
          ((not (idle-p simulation)) :running)
          ((let ((*simulation* simulation)) (plans)) :waiting)
          (t :idle))))

(defconstant +measure+ 10 "From how many ticks on a rate is measured.")

(defun begin-measuring (pulse tick seconds)
  (setf (pulse-tick pulse) tick
        (pulse-seconds pulse) seconds))

(defun measure (pulse tick seconds)
  "Return how many ticks a second have passed of late; it is TICK at SECONDS."
  (let ((ticks (- tick (pulse-tick pulse))) (elapsed (- seconds (pulse-seconds pulse))))
    (when (or (minusp ticks) (and (> elapsed 0.9) (or (>= ticks +measure+) (> elapsed 5))))
      (setf (pulse-reached pulse) (and (not (minusp ticks)) (rounded (/ ticks elapsed))))
      (begin-measuring pulse tick seconds))
    (pulse-reached pulse)))

(defun rounded (rate)
  "Return RATE without the digits that nobody wants."
  (if (< rate 20) (/ (round rate 1/10) 10) (round rate)))

(defun progress-of (simulation pulse)
  "Return how time goes in SIMULATION, of which PULSE knows what was seen before."
  (multiple-value-bind (state more) (state-of simulation pulse)
    (let ((tick (simulation-tick simulation)) (seconds (seconds-now)))
      (setf (pulse-last-tick pulse) tick)
      (unless (eq state :running)
        (setf (pulse-reached pulse) nil)
        (begin-measuring pulse tick seconds))
      (make-progress :state state :more more
                     :rate (rate-set simulation)
                     :reached (and (eq state :running) (measure pulse tick seconds))))))
