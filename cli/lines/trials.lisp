;;;; trials.lisp -- which trial TRIAL means: one of an experiment, or a game of a testbed.

(in-package :ars-magna.cli)

;;; Which trial is meant.

(defun question-named (name)
  "Return the testbed or else the experiment of the name NAME, or NIL."
  (or (find-testbed name nil) (find-experiment name nil)))

(defun question-name (question)
  (if (testbed-p question) (testbed-name question) (experiment-name question)))

(defun all-questions ()
  "Return all experiments, except those on testbeds, and then all testbeds."
  (append (remove-if (lambda (experiment) (find-testbed (experiment-name experiment) nil))
                     (all-experiments))
          (all-testbeds)))

(defun question-names () (mapcar #'question-name (all-questions)))

(defun experiment-names-matching (start)
  "Return the names of experiments and testbeds that begin with START, or only START if START itself
is a name."
  (let ((question (question-named start)))
    (if question
        (list (question-name question))
        (items-with-prefix (string-upcase start) (question-names) #'string))))

(defun resolve-question (name)
  "Return the experiment or testbed named NAME, or the only one whose name begins with NAME. Signals
BAD-LINE."
  (let ((names (experiment-names-matching name)))
    (cond ((null names)
           (reject-unknown-name "experiment" name (question-names)
                                "TRIAL lists all; (load \"FILE\") loads others."))
          ((rest names) (reject-ambiguous name names))
          (t (question-named (first names))))))

(defun experiment-run-here (name)
  "Return the experiment NAME. Signals BAD-LINE for a testbed that was not run here."
  (or (find-experiment name nil)
      (reject-line "~(~A~) was not run here. Give the directory of its table." name)))

;;;; Games
;;; TRIAL tileworld bold,dynamism=64 3 opens a trial of an experiment made for it: one agent, and
;;; one value for each knob. A number or the whole name of a condition means a condition of the
;;; testbed's last run here, as in the lines that FAILURES shows.

(defun testbed-experiment-by-default (testbed)
  "Return the experiment that has run TESTBED last, or else that of all its agents."
  (or (find-experiment (testbed-name testbed) nil)
      (testbed-experiment testbed (mapcar #'first (testbed-agents testbed)))))

(defun condition-run-before (testbed text)
  "Return two values: the experiment of TESTBED, and its condition of the number or whole name TEXT;
or NIL."
  (let* ((experiment (testbed-experiment-by-default testbed))
         (conditions (experiment-conditions experiment))
         (number (ignore-errors (parse-integer text)))
         (condition (if number
                        (and (<= 1 number (length conditions)) (nth (1- number) conditions))
                        (find text conditions :key #'condition-name :test #'string-equal))))
    (when condition (values experiment condition))))

(defun word-of-agent (word)
  "Return the name of an agent that WORD, such as bold or agent=bold, stands for, or NIL."
  (cond ((not (find #\= word)) word)
        ((starts-with-subseq "agent=" word :test #'char-equal) (subseq word 6))))

(defun game-of-testbed (testbed text)
  "Return two values: an experiment on TESTBED with the agent and knobs of TEXT, and its condition.
The word TUNING in TEXT chooses the seeds for tuning. Signals BAD-LINE."
  (let* ((words (split-words (substitute #\Space #\, text)))
         (tuning (find "tuning" words :test #'string-equal))
         (agents (remove tuning (remove nil (mapcar #'word-of-agent words)) :test #'equal)))
    (unless (and agents (null (rest agents)))
      (reject-line "~A names ~:[no agent~;several agents~]. Give AGENT or AGENT,KNOB=VALUE. TRIAL ~
                    ~(~A~) lists agents and knobs." text agents (testbed-name testbed)))
    (let ((experiment (testbed-experiment
                       testbed (list (agent-named (first agents) testbed))
                       :settings (check-set-once
                                  (loop for word in (remove-if #'word-of-agent words)
                                        collect (knob-setting (parse-setting word) testbed)))
                       :tuning (and tuning t))))
      (values experiment (first (experiment-conditions experiment))))))

(defun trial-of-testbed (testbed text)
  "Return two values: an experiment on TESTBED, and its condition for TEXT. Signals BAD-LINE."
  (multiple-value-bind (experiment condition) (condition-run-before testbed text)
    (if condition (values experiment condition) (game-of-testbed testbed text))))

(defun resolve-condition (question text)
  "Return two values: an experiment, and its condition for TEXT. If QUESTION is an experiment, TEXT
is a number, counted from 1, or a part of a name. If QUESTION is a testbed, see TRIAL-OF-TESTBED."
  (if (testbed-p question)
      (trial-of-testbed question text)
      (values question
              (find-condition question (or (ignore-errors (parse-integer text)) text)))))

(defun count-of-trials (experiment)
  "Return how many trials EXPERIMENT can have: of a testbed, none with a seed of its other seeds."
  (let ((testbed (find-testbed (experiment-name experiment) nil)))
    (if testbed
        (let ((seeds (testbed-seeds testbed)))
          (abs (- (getf seeds :tuning 0) (getf seeds :testing 0))))
        1000000000)))

(defun check-trial-number (experiment number)
  "Signal BAD-LINE unless EXPERIMENT can have a trial of the NUMBER."
  (let ((count (count-of-trials experiment)))
    (unless (<= 1 number count)
      (reject-line "Trials of ~(~A~) have the numbers 1 to ~:[~D~;1e9~*~], not ~D. Give the number ~
                    of a trial, not its seed: trial 1 has the first seed, ~D."
                   (experiment-name experiment) (= count 1000000000) count number
                   (trial-seed experiment 1)))))

;;; What is there.

(defun write-experiments ()
  (if (all-questions)
      (dolist (question (all-questions))
        (write-filled (first-full-sentence (if (testbed-p question)
                                               (testbed-documentation question)
                                               (experiment-description question)))
                      27 (format nil "  ~(~A~)" (question-name question))))
      (format t "No experiment is defined. (load \"FILE\") loads a file that has some.~%")))

(defun write-experiment-conditions (experiment)
  (format t "~(~A~), ~D trials of each condition by default:~%" (experiment-name experiment)
          (experiment-trials experiment))
  (loop for condition in (experiment-conditions experiment)
        for number from 1
        do (write-trimmed-line "  ~3D  ~A" number (condition-name condition))))

(defun write-games (testbed)
  "Write the agents and knobs of TESTBED, and a line that opens a game."
  (let ((name (string-downcase (testbed-name testbed))))
    (write-filled (format nil "~A: ~A" name (one-line (testbed-documentation testbed))) 0)
    (loop for (agent text) in (testbed-agents testbed)
          do (write-filled text 20 (format nil "  ~(~A~)" agent)))
    (write-filled (format nil "~{~(~A~)~^, ~}" (testbed-knobs testbed)) 20 "  Knobs:")
    (write-filled (format nil "TRIAL ~A AGENT 1 opens the game of the first seed for testing. ~
                               AGENT,KNOB=VALUE sets a knob; AGENT,TUNING takes the seeds for ~
                               tuning. AGENT can be a plan or function of yours."
                          name)
                  0)))
