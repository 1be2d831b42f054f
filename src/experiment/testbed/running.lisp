;;;; running.lisp -- RUN-TESTBED, and what TESTBED tells about a testbed.

(in-package :ars-magna.experiment)

(export '(write-testbed-list))

(addition start-agent)
(defun start-agent (agent)
  "Start AGENT, the name of a plan or function, in the current simulation: begin the plan, or call
the function without arguments. Errors end the trial, but a plan's failures leave the game to go on.
Return nothing. Signals UNKNOWN-NAME."
  (cond ((and (symbolp agent) (find-procedure agent nil)) (begin-plan agent))
        ((and agent (symbolp agent) (fboundp agent)) (funcall agent))
        (t (reject-name "agent" agent '())))
  (values))

(defun resolve-agent (testbed name)
  "Return the agent NAME: a plan or function of that very name, or else an agent of TESTBED."
  (let ((names (mapcar #'first (testbed-agents testbed))))
    (cond ((agent-p name) name)
          ((and name (symbolp name) (find name names :test #'same-name-p)))
          (t (reject-name "agent" name names)))))

(defun resolve-knob (operator testbed setting)
  "Return SETTING, a list (knob value), with the symbol of a knob of TESTBED."
  (unless (typep setting 'named-form)
    (reject-argument operator 'knobs setting "lists (knob value)"))
  (list (or (find (first setting) (testbed-knobs testbed) :test #'same-name-p)
            (reject-name "knob" (first setting) (testbed-knobs testbed)))
        (second setting)))

(addition run-testbed)
(defun run-testbed (name &key agents knobs (seeds 100) tuning (workers 1) directory
                              (stream *error-output*))
  "Run AGENTS in the testbed NAME, all on the same SEEDS, a number. Return results, as
RUN-EXPERIMENT does: AGENT is a factor, and the score is the first measure. AGENTS are names of
plans or functions, or of agents of the testbed; by default all of these. KNOBS are lists (knob
value). If TUNING is true, the seeds are those to write agents with, else those to test them.
WORKERS, DIRECTORY and STREAM are as for RUN-EXPERIMENT. Signals UNKNOWN-NAME, WRONG-ARGUMENT, and
the errors of RUN-EXPERIMENT and DEFEXPERIMENT."
  (let ((testbed (find-testbed name)))
    (unless (and (proper-list-p agents) (proper-list-p knobs))
      (reject-argument 'run-testbed 'agents (list agents knobs) "lists of agents and of knobs"))
    (run-experiment-object
     (testbed-experiment testbed
                         (loop for agent in (or agents (mapcar #'first (testbed-agents testbed)))
                               collect (resolve-agent testbed agent))
                         :settings (loop for setting in knobs
                                         collect (resolve-knob 'run-testbed testbed setting))
                         :tuning tuning)
     seeds workers directory stream)))

(defun run-experiment-object (experiment seeds workers directory stream)
  (run-experiment (experiment-name experiment) :trials seeds :workers workers
                  :directory directory :stream stream))

;;; Telling.

(defun agent-name-text (agent)
  (string-downcase agent))

(defun knob-line (name)
  (let* ((parameter (find-parameter name)) (default (parameter-default parameter)))
    (format nil "~A, ~A~@[ ~A~]; default ~(~A~). ~A" (parameter-name parameter)
            (describe-type (parameter-type parameter))
            (and (string/= "" (parameter-unit parameter)) (parameter-unit parameter))
            ;; As it can be typed.
            (if (symbolp default) (prin1-to-string default) (value-text default))
            (one-line (parameter-sentence parameter)))))

(defun write-testbed-section (title lines stream)
  (when lines
    (format stream "~%~A~%" title)
    (dolist (line lines) (write-wrapped (one-line line) stream :first "  - "))))

(defun write-testbed (testbed stream)
  (write-wrapped (format nil "~(~A~): ~A" (testbed-name testbed)
                         (one-line (testbed-documentation testbed)))
                 stream)
  (write-testbed-section "Rules" (testbed-rules testbed) stream)
  (write-testbed-section "Knobs" (mapcar #'knob-line (testbed-knobs testbed)) stream)
  (write-testbed-section (format nil "Agents, by the score ~(~A~)" (testbed-score testbed))
                         (loop for (name text) in (testbed-agents testbed)
                               collect (format nil "~(~A~): ~A" name text))
                         stream)
  (write-testbed-section "Claims" (mapcar #'first (testbed-claims testbed)) stream)
  (write-testbed-section "Sources" (testbed-sources testbed) stream)
  (write-testbed-section "Seeds"
                         (list (format nil "for tuning from ~D on; for testing from ~D on"
                                       (1+ (first-seed testbed t)) (1+ (first-seed testbed nil))))
                         stream))

(addition testbed)
(defun testbed (name &optional (stream *standard-output*))
  "Write the rules, knobs, agents, claims and sources of the testbed NAME to STREAM. Return the
testbed. Signals UNKNOWN-NAME."
  (let ((testbed (find-testbed name)))
    (write-testbed testbed stream)
    testbed))

(defun write-testbed-list (stream)
  "Write the names of all testbeds to STREAM, with a sentence on each."
  (dolist (testbed (all-testbeds))
    (write-wrapped (first-sentence (testbed-documentation testbed)) stream
                   :first (format nil "  ~(~20A~)" (testbed-name testbed)))))
