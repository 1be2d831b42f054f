;;;; replaying.lisp -- REPLAY-TRIAL: running a trial again where you can watch it.

(in-package :ars-magna.experiment)

(export '(rerun-trial call-outside-trial trial-prompt-line *replayed-trial-line* await-real-time
          row-of-trial row-differences measure-values))

;;; Workers run trials in their own threads, without output. Here a trial runs in your thread: you
;;; see its output and can stop it between two ticks. It takes the same course, as variables have
;;; their top-level values, as in a worker, whatever this thread has bound. Functions that inspect
;;; the trial are called aside: with the reader, printer, dice and debugger from outside the trial.

(defparameter *inspection-variables*
  (list *random-state-variable*
        '*package* '*readtable* '*read-default-float-format* '*read-base* '*print-base*
        '*print-radix* '*print-case* '*print-pretty* '*print-readably* '*print-escape*
        '*print-circle* '*print-length* '*print-level* '*print-array* '*print-gensym* '*asker*)
  "Variables with one value for a trial and another for functions that inspect it.")

(defstruct (outside (:constructor make-outside (values hook)) (:copier nil))
  "The values of *INSPECTION-VARIABLES* and the debugger's hook outside of a trial."
  (values '() :type list)
  (hook nil :read-only t))

(defvar *context-outside-trial* nil "The OUTSIDE of the trial that this thread runs again, or NIL.")

(defun call-outside-trial (function)
  "Call FUNCTION, which inspects a trial that runs again. The *INSPECTION-VARIABLES* have their
values from outside the trial; values that FUNCTION sets are kept. Its errors are not the trial's."
  (let ((outside *context-outside-trial*))
    (progv *inspection-variables* (outside-values outside)
      (let ((*inspecting-p* t))
        (with-debugger-hook ((outside-hook outside))
          (unwind-protect (call-allowing-exits function)
            (drop-unsignalled-errors *message-queue*)
            (setf (outside-values outside) (mapcar #'symbol-value *inspection-variables*))))))))

(defun call-with-inspection-context (function)
  "Call FUNCTION, which runs a trial and may use CALL-OUTSIDE-TRIAL."
  (let ((*context-outside-trial* (make-outside (mapcar #'symbol-value *inspection-variables*)
                                               (debugger-hook))))
    (unwind-protect (funcall function)
      (mapc #'set *inspection-variables* (outside-values *context-outside-trial*)))))

(defun call-as-in-worker (function)
  "Call FUNCTION with the global values of *SIMULATION-VARIABLES*, as in a new thread. Entering a
debugger without a user is an error of the trial."
  (progv *simulation-variables* (mapcar #'global-value *simulation-variables*)
    (let ((*asker* nil))
      (answering-debugger ((lambda (condition somebody-p)
                             (unless somebody-p (throw 'broken-off condition))))
        (funcall function)))))

(defun complete-and-inspect-trial (experiment result then)
  (keep-history)
  (complete-trial experiment result)
  (setf (simulation-gate (current-simulation))
        (lambda (simulation)
          (reject-use "The trial ended at tick ~D; no more ticks of this trial can pass."
                      (simulation-tick simulation))))
  (funcall then result))

(defun rerun-trial (experiment condition trial &key gate (then #'identity) journal)
  "Run TRIAL of CONDITION of EXPERIMENT as RUN-TRIAL does, but in this thread and with output. When
the trial ends, call THEN with the result while the trial's simulation exists. Return the result."
  (let ((result (make-result condition trial (trial-seed experiment trial)))
        (begun-p nil))
    (flet ((run ()
             (call-in-trial (lambda ()
                              (setf begun-p t)
                              (complete-and-inspect-trial experiment result then))
                            experiment condition trial :gate gate :journal journal)))
      (call-with-inspection-context
       (lambda ()
         (call-as-in-worker
          (lambda ()
            (block nil
              (handler-bind ((error (lambda (condition)
                                      (unless begun-p
                                        (set-error-outcome result (text-of-condition condition))
                                        (return)))))
                (prepare-trials experiment condition)
                (run))))))))
    result))

;;;; REPLAY-TRIAL

;;; Pace and steps: waiting at the gate, between two ticks.

(defun await-real-time (due simulation)
  "Wait until the real time DUE, in seconds. Meanwhile serve other threads' requests to SIMULATION."
  (loop with never = (make-semaphore "never")
        for left = (- due (seconds-now))
        do (answer-questions (timeline-custody (simulation-timeline simulation)))
        while (plusp left)
        do (serve-and-wait-once never (min left 0.02))))

(defun paced-gate (rate)
  "Return a gate: a function that is called before each tick and lets RATE ticks a second pass."
  (let ((due nil))
    (lambda (simulation)
      (unless due
        (when *display-opener*
          (handler-case (open-display (first (simulation-robots simulation)))
            (error (condition) (warning-set (text-of-condition condition)))))
        (setf due (seconds-now)))
      (unless (eq rate :free)
        (await-real-time due simulation)
        (setf due (+ (max due (- (seconds-now) 0.25d0)) (/ 1d0 rate))))
      1)))

(defun asked-to-stop-p (step simulation)
  "If STEP is T, ask the user; else call STEP with SIMULATION. Return true if the trial must stop."
  (call-outside-trial (lambda ()
                        (if (functionp step)
                            (eq :stop (funcall step simulation))
                            (not (y-or-n-p "Tick ~D. Let the next tick pass?"
                                           (simulation-tick simulation)))))))

(defun replay-gate (until rate step stop)
  "Return a gate for the arguments UNTIL, RATE and STEP of REPLAY-TRIAL. Calling STOP ends a trial."
  (let ((pace (and rate (paced-gate rate))))
    (lambda (simulation)
      (let ((left (if until (- until (simulation-tick simulation)) most-positive-fixnum)))
        (when (or (not (plusp left)) (and step (asked-to-stop-p step simulation)))
          (funcall stop))
        (when pace (funcall pace simulation))
        (if (or pace step) 1 left)))))

;;; Comparison with the table.

(defun row-of-trial (experiment condition trial directory)
  "Return the texts of the row that DIRECTORY has for TRIAL of CONDITION. Signals MISUSE if none."
  (let ((file (rows-file (existing-table-directory directory)))
        (place (1+ (seed-column (columns experiment))))
        (number (value-text trial)))
    (check-file-header file (columns experiment))
    (do-rows (texts file)
      (when (and (string= number (nth place texts))
                 (eq condition (condition-of-texts experiment texts)))
        (return-from row-of-trial texts)))
    (reject-use "There is no row of trial ~D of ~A in ~A." trial (condition-name condition)
                (native-name (directory-path directory)))))

(defun row-differences (experiment result parts row directory)
  "Return a list of texts on how RESULT of EXPERIMENT differs from ROW, a row in DIRECTORY."
  (loop for column in (columns experiment)
        for now in (result-texts experiment result)
        for then in row
        unless (string= now then)
          collect (if (string= "fingerprint" column)
                      (format nil "its code or configuration is different~@[; changed since: ~
                                   ~{~A~^, ~}~]"
                              (changed-parts-since-run (result-condition result) parts
                                                       (directory-path directory)))
                      (format nil "~A is ~:[~A~;~*empty~], and ~:[~A~;~*empty~] in the row"
                              column (string= "" now) now (string= "" then) then))))

;;; Running the trial.

(defun collect-journal (journal)
  "Return the journal of the current simulation if JOURNAL is true. If JOURNAL is the name of a
file, also save the journal there."
  (when journal
    (when (typep journal '(or string pathname)) (save-journal journal))
    (journal-up-to-now (current-simulation))))

(defvar *replayed-trial-line* nil
  "The prompt line for the trial that REPLAY-TRIAL runs in this thread, or NIL.")

(defun trial-prompt-line (experiment condition trial)
  "Return the prompt line that opens TRIAL of CONDITION of EXPERIMENT."
  (format nil "trial ~(~A~) ~A ~D" (experiment-name experiment)
          ;; An experiment made for a trial is found by no number.
          (if (eq experiment (find-experiment (experiment-name experiment) nil))
              (1+ (position condition (experiment-conditions experiment)))
              (prompt-argument (condition-name condition)))
          trial))

(defun run-for-replay (experiment condition trial until rate step journal then)
  "Run TRIAL of CONDITION of EXPERIMENT; the other arguments are those of REPLAY-TRIAL. Return the
result, whether the trial was stopped, and its journal if JOURNAL is true."
  (let ((*replayed-trial-line* (trial-prompt-line experiment condition trial))
        (stopped-p nil) (kept nil))
    (labels ((look-around ()
               (call-outside-trial (lambda ()
                                     (setf kept (collect-journal journal))
                                     (funcall then))))
             (stop ()
               (let ((result (make-result condition trial 0)))
                 (note-final-state result)
                 (unless (shiftf stopped-p t) (look-around))
                 (throw 'stopped result))))
      (let ((result (catch 'stopped
                      (rerun-trial experiment condition trial
                                   :gate (replay-gate until rate step #'stop)
                                   :journal (and journal t)
                                   :then (lambda (result)
                                           (declare (ignore result))
                                           (look-around))))))
        (values result stopped-p kept)))))

(defun measure-values (experiment result)
  "Return lists (name value) of the measures in RESULT, a result of EXPERIMENT."
  (loop with shared = (make-hash-table :test 'equal)
        for (name) in (experiment-measures experiment)
        for text in (result-measures result)
        collect (list name (value-from-text text shared))))

(defun recorded-series (result)
  (loop with shared = (make-hash-table :test 'equal)
        for (tick . texts) in (result-series result)
        collect (cons tick (loop for text in texts collect (value-from-text text shared)))))

(defun replay-plist (experiment result stopped-p journal differences)
  (list :outcome (and (not stopped-p) (result-outcome result))
        :reason (if stopped-p "" (result-reason result))
        :ticks (result-ticks result)
        :digest (result-digest-text result)
        :measures (measure-values experiment result)
        :series (recorded-series result)
        :error (if stopped-p "" (result-error result))
        :journal journal
        :differences differences))

(defun check-replay-arguments (trial until then step journal directory)
  (check-argument replay-trial trial (and (integerp trial) (<= 1 trial +largest+))
                  "the number of a trial, counted from 1")
  (check-argument replay-trial until (or (null until) (whole-p until 0))
                  "a tick, 0 or more, or NIL")
  (check-argument replay-trial then (typep then '(or function (and symbol (not null))))
                  "a function of no arguments")
  (check-argument replay-trial step (typep step '(or function (member t nil)))
                  "T, NIL, or a function of a simulation")
  (check-argument replay-trial journal (typep journal '(or string pathname (member t nil)))
                  "T, NIL, or the name of a file")
  (check-argument replay-trial directory (typep directory '(or string pathname null))
                  "the name of a directory, or NIL"))

(addition replay-trial)
(defun replay-trial (experiment condition trial
                     &key until (then (constantly nil)) rate step journal trace directory)
  "Run TRIAL, a number, of CONDITION of EXPERIMENT again: the same run as in its row, plans
included. CONDITION is a number from 1, or an unambiguous part of its name. The trial runs in this
thread: you see what it writes, and PRINT-PLANS, WHY and *BREAK-ON-USER-ERROR* work as usual. THEN,
a function of no arguments, is called when the trial has ended or is stopped, while its simulation
still exists, for example to call SAVE-PICTURE.

  :until TICK   stops the trial at TICK, in the middle of what it does
  :rate R       lets R ticks a second pass (:FREE: no waiting), and opens the display, if any
  :step T       asks before each tick whether it may pass. Or give a function of the simulation: it
                is called before each tick, and stops the trial by returning :STOP
  :trace T      keeps a trace of plans, for WHY and SAVE-PLAN-TIMELINE
  :journal T    keeps a journal, for REPLAY and SAVE-ANIMATION; the name of a file also saves it
  :directory D  compares the result with its row in D

Return a plist: :outcome (\"success\", \"failure\", \"limit\", \"error\"; NIL if stopped),
:reason, :ticks, :digest (as in the row), :measures (lists (name value)), :series (what :each-tick
recorded, lists (tick value...)), :error, :journal, and :differences from the row, in words. Signals
UNKNOWN-NAME, WRONG-ARGUMENT, MISUSE (no such row), DAMAGED-TABLE."
  (check-replay-arguments trial until then step journal directory)
  (when rate (check-rate rate))
  (let* ((experiment (find-experiment experiment))
         (condition (find-condition experiment condition))
         (*trace-plans* (or trace *trace-plans*))
         (parts (and directory (prepare-condition experiment condition)))
         (row (and directory (row-of-trial experiment condition trial directory))))
    (multiple-value-bind (result stopped-p kept)
        (run-for-replay experiment condition trial until rate step journal then)
      (replay-plist experiment result stopped-p kept
                    (and row
                         (not stopped-p)
                         (row-differences experiment result parts row directory))))))
