;;;; open-trial.lisp -- a trial that a prompt is in: lines are read between its ticks.

(in-package :ars-magna.cli)

(defstruct (open-trial (:constructor make-open-trial (experiment condition number directory))
                       (:copier nil))
  "A trial that a prompt has entered."
  (experiment nil :read-only t)
  (condition nil :read-only t)
  (number 0 :type integer :read-only t)
  ;; The directory of its row, or NIL.
  (directory nil :type (or null string) :read-only t)
  ;; A line has been read in it.
  (begun-p nil :type boolean)
  ;; How many ticks are to pass before the next line, and whether to report when they have.
  (steps 0 :type (integer 0))
  (stepped-p nil :type boolean)
  ;; After a rewind, a function to call when these ticks have passed again; else NIL.
  (restore nil :type (or null function))
  ;; The progress line at a terminal, or NIL.
  (progress nil)
  ;; Ticks pass by themselves, at RATE, the next when it is DUE.
  (running-p nil :type boolean)
  (rate *default-rate*)
  (due 0d0 :type double-float)
  ;; The user has pressed Control-C while ticks passed; it is being left.
  (interrupted-p nil :type boolean)
  (left-p nil :type boolean)
  ;; Its result, once it is over, and the tick at which it was changed.
  (result nil)
  (changed nil :type (or null integer)))

;;; Steering.

(defun check-trial-not-over (trial)
  (when (open-trial-result trial)
    (reject-line "The trial is over. TRIAL name condition number opens one, TRIAL OFF leaves it.")))

(defun pause-trial (trial)
  (setf (open-trial-running-p trial) nil
        (open-trial-steps trial) 0))

(defun resume-trial (trial)
  (check-trial-not-over trial)
  (setf (open-trial-running-p trial) t
        (open-trial-due trial) (seconds-now)))

(defun set-trial-rate (trial rate)
  (check-trial-not-over trial)
  (setf (open-trial-rate trial) rate
        (open-trial-due trial) (seconds-now)))

(defun step-trial (trial count)
  (check-trial-not-over trial)
  (unless (whole-p count 1)
    (reject-line "N cannot be ~D. Give a number of ticks, from 1 to 1e9." count))
  (setf (open-trial-running-p trial) nil
        (open-trial-stepped-p trial) t)
  (incf (open-trial-steps trial) count))

(defun trial-pace-text (trial)
  (cond ((open-trial-result trial) "over")
        ((open-trial-running-p trial) (rate-text (open-trial-rate trial)))
        (t "paused")))

(defun trial-pace (trial)
  "Return two values: how TRIAL passes time (:RUNNING, :PAUSED or :ENDED), and its rate or NIL."
  (cond ((open-trial-result trial) :ended)
        ((plusp (open-trial-steps trial)) :running)
        ((open-trial-running-p trial) (values :running (open-trial-rate trial)))
        (t (values :paused (open-trial-rate trial)))))

;;;; The prompt inside of a trial

;;; The prompt's own thread runs the trial, and reads lines at its gate, between two ticks. So what
;;; lines see stands still and belongs to the trial: robots, plans, variables. A line that needs
;;; time says so, and gets it when it is done. At a terminal or window, ticks pass at the set rate
;;; while nothing is typed. Everything that leaves the trial, be it a line, an error or Control-C,
;;; unwinds it; nothing else needs to be ended.

(defun leave-open-trial (session &optional (next #'values))
  "Leave the trial of SESSION; then call NEXT. The trial's messages about its end are not shown."
  (setf (open-trial-left-p (session-trial session)) t)
  (stop-listening session)
  (throw 'left-trial next))

(defun call-after-leaving-trial (session function)
  "Call FUNCTION outside of trials: if SESSION is in a trial, leave the trial first."
  (if (session-trial session)
      (leave-open-trial session function)
      (funcall function)))

;;; Has a line changed the run? Then it is no longer the experiment's.

(defun trial-state ()
  "Return a list that determines how the current run goes on: state digest and pending requests."
  (list (state-digest *simulation* t) (timeline-inbox (timeline-of *simulation*))))

(defun report-changed-trial (session trial before)
  "If the run in TRIAL is no longer in the state BEFORE, report that lines have changed the run."
  (unless (or (open-trial-changed trial) (every #'eql before (trial-state)))
    (setf (open-trial-changed trial) (simulation-tick *simulation*))
    (format (session-console session) "~&~:[The run was changed: it is not the experiment's run ~
                                       any more~;The change has no effect: the trial is over~].~%"
            (open-trial-result trial))))

;;; Lines.

(defun serve-other-threads ()
  (answer-questions (timeline-custody (timeline-of *simulation*))))

(defun await-typed-line (session seconds)
  "Wait for SECONDS at most until a line is typed for SESSION. Return true if a line was typed."
  (let ((console (session-console session)))
    (unless (or (session-batch-p session) (prompt-unanswered-p console))
      (with-lock ((session-lock session)) (show-prompt console "Robot> "))))
  (loop with end = (+ (seconds-now) seconds)
        for left = (- end (seconds-now))
        do (serve-other-threads)
        thereis (or (reader-lines (session-reader session))
                    (typed-input-within-p (session-input session) (max 0 (min 0.05 left))))
        while (plusp left)))

(defun begin-trial (session trial)
  "Make the robots' names known to Lisp, and open a window if windows are available."
  (unless (shiftf (open-trial-begun-p trial) t)
    (import-robot-names (current-robot-names))
    (when (display-wanted-p session)
      (open-display-or-report (session-robot) '()))))

(defun run-line-in-trial (session trial)
  (call-outside-trial
   (lambda ()
     (call-before-line-hooks session)
     (begin-trial session trial)
     (let ((before (trial-state)))
       (call-guarded session (lambda ()
                               (when (can-poll-input-p session)
                                 (loop until (await-typed-line session 1)))
                               (let ((*typing-callback* #'serve-other-threads))
                                 (run-nested-line session))))
       (report-changed-trial session trial before))
     (call-guarded session (lambda () (show-messages session)))
     (when (session-over-p session) (leave-open-trial session)))))

;;; Between ticks.

(defun call-restore (trial)
  (let ((restore (shiftf (open-trial-restore trial) nil)))
    (when restore (funcall restore))))

(defun end-repetition (session trial)
  "If the ticks before a rewind have passed again in TRIAL, show what is not hidden meanwhile."
  (when (open-trial-restore trial)
    (call-outside-trial (lambda () (show-messages session)))
    (call-restore trial)))

(defun report-trial-stop (session trial)
  "Report that the ticks which were to pass in TRIAL have passed, or were stopped."
  (when (shiftf (open-trial-interrupted-p trial) nil)
    (note-answered (session-console session))
    (setf (open-trial-stepped-p trial) t))
  (when (and (zerop (open-trial-steps trial)) (shiftf (open-trial-stepped-p trial) nil))
    (when (open-trial-progress trial) (end-progress (shiftf (open-trial-progress trial) nil)))
    (end-repetition session trial)
    (format (session-console session) "~&Tick ~D.~%" (simulation-tick *simulation*))))

(defun time-of-next-tick (trial)
  "Return the time, in seconds, of the tick of TRIAL that follows the tick due now."
  (let ((rate (open-trial-rate trial)))
    (if (eq :free rate)
        (seconds-now)
        (+ (max (open-trial-due trial) (- (seconds-now) 0.25d0)) (/ 1d0 rate)))))

(defun wait-for-tick (session trial)
  "Wait until the next tick is due in TRIAL. Return NIL if a line was typed before that tick."
  (let ((left (if (eq :free (open-trial-rate trial)) 0 (- (open-trial-due trial) (seconds-now)))))
    (if (can-poll-input-p session)
        (unless (call-outside-trial (lambda () (await-typed-line session left)))
          (setf (open-trial-due trial) (time-of-next-tick trial))
          t)
        (progn (when (plusp left) (await-real-time (open-trial-due trial) *simulation*))
               (setf (open-trial-due trial) (time-of-next-tick trial))
               t))))

(defun tick-passes-p (session trial)
  (cond ((plusp (open-trial-steps trial))
         (when (session-terminal-p session)
           (unless (open-trial-progress trial)
             (setf (open-trial-progress trial) (make-progress-line (session-console session))))
           (note-progress (open-trial-progress trial) "Tick ~D, ~D to go. Control-C pauses."
                          (simulation-tick *simulation*) (open-trial-steps trial)))
         (decf (open-trial-steps trial))
         t)
        ((open-trial-running-p trial) (wait-for-tick session trial))))

(defun make-trial-gate (session trial)
  (lambda (simulation)
    (declare (ignore simulation))
    (when (open-trial-left-p trial) (leave-open-trial session))
    (report-trial-stop session trial)
    (loop until (tick-passes-p session trial) do (run-line-in-trial session trial))
    1))
