;;;; visit.lisp -- a trial that a prompt is in: lines are read between its ticks.

(in-package :ars-magna.cli)

(defstruct (visit (:constructor make-visit (experiment condition trial directory)) (:copier nil))
  "A trial that the prompt is in."
  (experiment nil :read-only t)
  (condition nil :read-only t)
  (trial 0 :type integer :read-only t)
  ;; The directory of its row, or NIL.
  (directory nil :type (or null string) :read-only t)
  ;; A line has been read in it.
  (begun-p nil :type boolean)
  ;; How many ticks are to pass before the next line, and whether to report when they have.
  (steps 0 :type (integer 0))
  (stepped-p nil :type boolean)
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

(defun check-visit-goes-on (visit)
  (when (visit-result visit)
    (reject-line "The trial is over. TRIAL name condition number opens one, TRIAL OFF leads out.")))

(defun pause-visit (visit)
  (setf (visit-running-p visit) nil
        (visit-steps visit) 0))

(defun resume-visit (visit)
  (check-visit-goes-on visit)
  (setf (visit-running-p visit) t
        (visit-due visit) (seconds-now)))

(defun set-visit-rate (visit rate)
  (check-visit-goes-on visit)
  (setf (visit-rate visit) rate
        (visit-due visit) (seconds-now)))

(defun step-visit (visit count)
  (check-visit-goes-on visit)
  (unless (whole-p count 1)
    (reject-line "N cannot be ~D. Give a number of ticks, from 1 to 1e9." count))
  (setf (visit-running-p visit) nil
        (visit-stepped-p visit) t)
  (incf (visit-steps visit) count))

(defun visit-text (visit)
  (cond ((visit-result visit) "over")
        ((visit-running-p visit) (rate-text (visit-rate visit)))
        (t "paused")))

(defun pace-of-visit (visit)
  "Return how time passes in VISIT: :RUNNING, :PAUSED or :ENDED; and at what rate, or NIL."
  (cond ((visit-result visit) :ended)
        ((plusp (visit-steps visit)) :running)
        ((visit-running-p visit) (values :running (visit-rate visit)))
        (t (values :paused (visit-rate visit)))))

;;;; The prompt inside of a trial

;;; The prompt's own thread runs the trial, and reads lines at its gate, between two ticks. So what
;;; lines see stands still and belongs to the trial: robots, plans, variables. A line that needs
;;; time says so, and gets it when it is done. At a terminal or window, ticks pass at the set rate
;;; while nothing is typed. Everything that leaves the trial, be it a line, an error or Control-C,
;;; unwinds it; nothing else needs to be ended.

(defun leave-visit (session &optional (next #'values))
  "Leave the trial of SESSION; then call NEXT. The trial's messages on this are not shown."
  (setf (visit-left-p (session-visit session)) t)
  (stop-listening session)
  (throw 'left-visit next))

(defun call-outside (session function)
  "Call FUNCTION where SESSION is in no trial: if it is in one, leave that first."
  (if (session-visit session)
      (leave-visit session function)
      (funcall function)))

;;; Has a line changed the run? Then it is no longer the experiment's.

(defun visit-state ()
  "Return what determines the course of the current simulation: a digest, and the pending requests."
  (list (state-digest *simulation* t) (timeline-inbox (timeline-of *simulation*))))

(defun note-if-changed (session visit before)
  "Say so if the run in VISIT is no longer in the state BEFORE."
  (unless (or (visit-changed visit) (every #'eql before (visit-state)))
    (setf (visit-changed visit) (simulation-tick *simulation*))
    (format (session-console session) "~&~:[From here on, this is not the experiment's run any ~
                                       more~;This has no effect: the trial is over~].~%"
            (visit-result visit))))

;;; Lines.

(defun answer-others ()
  "Answer what other threads, such as a window's, ask of the current simulation."
  (answer-questions (timeline-custody (timeline-of *simulation*))))

(defun await-typed-line (session seconds)
  "Wait until a line is typed for SESSION, for SECONDS at most. True if there is one."
  (let ((console (session-console session)))
    (unless (or (session-batch-p session) (unanswered-p console))
      (with-lock ((session-lock session)) (show-prompt console "Robot> "))))
  (loop with end = (+ (seconds-now) seconds)
        for left = (- end (seconds-now))
        do (answer-others)
        thereis (or (reader-lines (session-reader session))
                    (typed-within-p (session-input session) (max 0 (min 0.05 left))))
        while (plusp left)))

(defun begin-visit (session visit)
  "Let users call robots by their names, and see them if there can be a window."
  (unless (shiftf (visit-begun-p visit) t)
    (call-by-name (robots-here))
    (when (display-wanted-p session)
      (announce-display (session-robot) '()))))

(defun visit-line (session visit)
  (call-aside
   (lambda ()
     (tell-whereabouts session)
     (begin-visit session visit)
     (let ((before (visit-state)))
       (call-guarded session (lambda ()
                               (when (watched-p session)
                                 (loop until (await-typed-line session 1)))
                               (let ((*while-typing* #'answer-others))
                                 (next-line-inside session))))
       (note-if-changed session visit before))
     (call-guarded session (lambda () (show-messages session)))
     (when (session-over-p session) (leave-visit session)))))

;;; Between ticks.

(defun tell-stop (session visit)
  "Say that the ticks which were to pass in VISIT have passed, or were stopped."
  (when (shiftf (visit-interrupted-p visit) nil)
    (answered (session-console session))
    (setf (visit-stepped-p visit) t))
  (when (and (zerop (visit-steps visit)) (shiftf (visit-stepped-p visit) nil))
    (when (visit-progress visit) (end-progress (shiftf (visit-progress visit) nil)))
    (format (session-console session) "~&Tick ~D.~%" (simulation-tick *simulation*))))

(defun next-due (visit)
  "Return when the tick after the one of VISIT that is due now will be."
  (let ((rate (visit-rate visit)))
    (if (eq :free rate)
        (seconds-now)
        (+ (max (visit-due visit) (- (seconds-now) 0.25d0)) (/ 1d0 rate)))))

(defun wait-for-tick (session visit)
  "Wait until the next tick is due in VISIT. NIL if a line was typed before."
  (let ((left (if (eq :free (visit-rate visit)) 0 (- (visit-due visit) (seconds-now)))))
    (if (watched-p session)
        (unless (call-aside (lambda () (await-typed-line session left)))
          (setf (visit-due visit) (next-due visit))
          t)
        (progn (when (plusp left) (await-time (visit-due visit) *simulation*))
               (setf (visit-due visit) (next-due visit))
               t))))

(defun tick-passes-p (session visit)
  (cond ((plusp (visit-steps visit))
         (when (session-terminal-p session)
           (unless (visit-progress visit)
             (setf (visit-progress visit) (make-progress-line (session-console session))))
           (note-progress (visit-progress visit) "Tick ~D, ~D to go. Control-C pauses."
                          (simulation-tick *simulation*) (visit-steps visit)))
         (decf (visit-steps visit))
         t)
        ((visit-running-p visit) (wait-for-tick session visit))))

(defun visit-gate (session visit)
  (lambda (simulation)
    (declare (ignore simulation))
    (when (visit-left-p visit) (leave-visit session))
    (tell-stop session visit)
    (loop until (tick-passes-p session visit) do (visit-line session visit))
    1))
