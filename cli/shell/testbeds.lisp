;;;; testbeds.lisp -- ./cli/ars-magna testbed.

(in-package :ars-magna.cli)

(defun parse-setting (text)
  "Return a list (name value), strings, for TEXT, which has the form NAME=VALUE."
  (let ((equals (position #\= text)))
    (unless (and equals (< 0 equals (1- (length text))))
      (reject-usage "--knob takes NAME=VALUE, such as dynamism=64, not ~A." text))
    (list (subseq text 0 equals) (subseq text (1+ equals)))))

(defparameter *testbed-options*
  '(("--agent" :agent identity) ("--load" :load identity) ("--seeds" :seeds parse-count)
    ("--knob" :knob parse-setting) ("--tuning" :tuning nil) ("--out" :out parse-path)
    ("--workers" :workers parse-count) ("--time-limit" :time-limit parse-seconds)
    ("--all" :all nil) ("--quiet" :quiet nil))
  "The options of the command `testbed`, in the format of *OPTIONS*.")

(defun testbed-option (key)
  (first (find key *testbed-options* :key #'second)))

(defun check-testbed-options (options words)
  "Signal USAGE-ERROR if one of OPTIONS would have no effect. WORDS are names of testbeds."
  (let ((given (remove :other (remove-duplicates (mapcar #'first options)))))
    (flet ((reject-if-given (keys control)
             (let ((key (find-if (lambda (key) (member key keys)) given)))
               (when key (reject-usage control (testbed-option key))))))
      (when (rest words)
        (reject-usage "testbed takes the name of one testbed, not ~{~A~^ and ~}." words))
      (dolist (key '(:seeds :out :workers :time-limit))
        (when (rest (option-values key options))
          (reject-usage "~A was given twice. Give it once." (testbed-option key))))
      (cond ((member :all given)
             (reject-if-given '(:agent :knob :tuning :time-limit)
                              "--all runs all agents for a page of results; leave out ~A.")
             (unless (member :out given) (reject-usage "--all needs --out DIR.")))
            ((null words)
             (reject-if-given (remove :load given)
                              "~A needs the name of a testbed, as in testbed tileworld."))))))

(defun testbed-named (name)
  (or (find-testbed name nil)
      (let ((names (mapcar (lambda (testbed) (string-downcase (testbed-name testbed)))
                           (all-testbeds))))
        (reject-line "There is no testbed ~A.~@[ Did you mean ~A?~] Known: ~{~A~^, ~}."
                     name (nearest-name name names) names))))

(defun full-name (symbol)
  (format nil "~(~A::~A~)" (package-name (symbol-package symbol)) symbol))

(defun playable-p (symbol)
  "True if SYMBOL names a plan, or a function of a program that can be called without arguments."
  (and (agent-p symbol)
       (null (agent-arguments-text symbol))
       (or (find-procedure symbol nil)
           (not (starts-with-subseq "SB-" (package-name (symbol-package symbol)))))))

(defun agents-named (text names)
  "Return the agents of the name or full name TEXT: those among NAMES, and plans and functions that
are no agents of other testbeds."
  (let* ((end (position #\: text))
         (name (subseq text (if end (1+ (position #\: text :from-end t)) 0))))
    (remove-if-not (lambda (symbol)
                     (and (or (member symbol names)
                              (and (users-symbol-p symbol) (playable-p symbol)
                                   (notany (lambda (testbed)
                                             (assoc symbol (testbed-agents testbed)))
                                           (all-testbeds))))
                          (or (null end)
                              (eq (symbol-package symbol)
                                  (find-package (string-upcase (subseq text 0 end)))))))
                   (symbols-named name))))

(defun symbols-named (name)
  "Return all symbols of the name NAME, which is in capitals unless it is written between bars."
  (let ((last (1- (length name))))
    (find-all-symbols (if (and (< 1 last) (char= #\| (char name 0) (char name last)))
                          (subseq name 1 last)
                          (string-upcase name)))))

(defun agent-with-arguments-text (text)
  "Return what is wrong with the plan or function TEXT of the user if it takes arguments, or NIL."
  (let ((symbol (find-if (lambda (symbol) (and (users-symbol-p symbol) (agent-p symbol)))
                         (symbols-named text))))
    (and symbol (agent-arguments-text symbol))))

(defun agent-named (text testbed)
  "Return the agent TEXT: one of TESTBED, or the name of a plan or function of the user."
  (let* ((names (mapcar #'first (testbed-agents testbed)))
         (agents (agents-named text names)))
    (cond ((rest agents)
           (reject-line "There are several agents ~A: ~{~A~^, ~}. Rename yours, or use a full name."
                        text (sort (mapcar #'full-name agents) #'string<)))
          (agents (first agents))
          ((agent-with-arguments-text text) (reject-line "~A" (agent-with-arguments-text text)))
          (t (reject-line "~A has no agent ~A, and no plan or function has that name.~@[ Did you ~
                           mean ~A?~] Known: ~{~A~^, ~}. --load FILE loads an agent of your own."
                          (string-downcase (testbed-name testbed)) text (nearest-name text names)
                          (mapcar #'string-downcase names))))))

(defun knob-setting (setting testbed)
  "Return (symbol value) for SETTING, two strings."
  (destructuring-bind (name text) setting
    (let* ((parameter (find-parameter name nil))
           (symbol (and parameter (find (parameter-name parameter) (testbed-knobs testbed)
                                        :test #'string-equal))))
      (unless symbol
        (reject-line "~(~A~) has no knob ~A. Known: ~{~(~A~)~^, ~}." (testbed-name testbed) name
                     (testbed-knobs testbed)))
      (list symbol (knob-value (parameter-of-variable symbol) text)))))

(defun knob-value (parameter text)
  "Return the value of PARAMETER, a knob, that the whole of TEXT is."
  (flet ((reject ()
           (reject-line "~A cannot be ~A. Give ~A." (parameter-name parameter) text
                        (describe-type (parameter-type parameter)))))
    (multiple-value-bind (value end)
        (handler-case (read-data-from-string text 0) (error () (reject)))
      (unless (= end (length text)) (reject))
      (handler-case (check-parameter-value parameter value) (wrong-argument () (reject)))
      value)))

(defun check-set-once (settings)
  "Return SETTINGS, lists (knob value). Signal BAD-LINE if a knob is set twice."
  (loop for ((knob) . others) on settings
        do (when (assoc knob others)
             (reject-line "The knob ~(~A~) is set twice. Set it once." knob)))
  settings)

(defun knob-settings (testbed options)
  "Return the settings of OPTIONS, lists (symbol value)."
  (check-set-once (loop for setting in (option-values :knob options)
                        collect (knob-setting setting testbed))))

;;; Running agents.

(defun progress-stream (options)
  (and (not (option-value :quiet options)) *error-output*))

(defun default-out (testbed knobs options)
  "Return the directory for the table of TESTBED with KNOBS, lists (knob value)."
  (format nil "out/~(~A~)~@[-~A~]~:[~;-tuning~]/" (testbed-name testbed)
          (and knobs (remove #\* (substitute-if #\- (lambda (char) (find char " /"))
                                               (settings-text knobs))))
          (option-value :tuning options)))

(defun prompt-command-line (options)
  "Return the shell's line that starts the prompt with the files of --load in OPTIONS."
  (uiop:escape-sh-command
   (append (program-command-line)
           (loop for file in (option-values :load options) append (list "--load" file)))))

(defun write-replay-advice (testbed agents knobs results options)
  "Say how to see the errors in RESULTS of AGENTS again, the first one in the debugger."
  (let ((*print-case* :downcase) (*print-pretty* nil) (*package* (find-package :keyword))
        (name (testbed-name testbed)))
    (format t "~%To see the first of these again, in the debugger, start the prompt and type the ~
               other~%lines. Once you have typed the first one, the lines above work there, ~
               too.~%~{  ~A~%~}"
            (list (prompt-command-line options)
                  (format nil "(run-testbed '~S :seeds 1 :agents '~S~@[ :knobs '~S~]~:[~; ~
                               :tuning t~])"
                          name (broken-agents agents results) knobs
                          (option-value :tuning options))
                  "(setf *break-on-user-error* t)"
                  (format nil "(replay-trial '~S 1 ~D)" name (first-broken-trial results))))))

(defun report-comparison (testbed results agents)
  "Print what RESULTS say of several AGENTS in TESTBED: their order, and how they differ."
  (when (rest agents)
    (terpri)
    (write-agents-order testbed results agents *standard-output*)
    (terpri)
    (compare-levels results "agent" :against (string-downcase (first agents))
                                    :measure (testbed-score testbed))))

(defun run-agents (testbed agents options)
  "Run AGENTS in TESTBED by OPTIONS. Print their scores and, of several, the differences. Return the
exit status."
  (let* ((knobs (knob-settings testbed options))
         (out (option-value :out options (default-out testbed knobs options)))
         (results (run-testbed (testbed-name testbed)
                               :agents agents :knobs knobs
                               :seeds (option-value :seeds options 100)
                               :tuning (option-value :tuning options)
                               :workers (option-value :workers options (processors))
                               :time-limit (option-value :time-limit options)
                               :directory (progn (ensure-results-directory out) out)
                               :stream (progress-stream options)))
         (broken (count-broken-trials results)))
    (report-results results nil)
    (cond ((plusp broken)
           (write-replay-advice testbed agents knobs results options)
           (print-notice "~D game~:P ended with an error or at the time limit, so agents are not ~
                          compared."
                         broken)
           1)
          (t (report-comparison testbed results agents)
             (format t "~%The table is in ~A; compare it with: ars-magna compare --by agent ~
                        ~:*~A~%"
                     out)
             0))))

(defun agents-from-options (testbed options)
  "Return the agents to run: those of the options; after --load, also those of TESTBED, unless one
of these is named."
  (let ((agents (loop for name in (option-values :agent options)
                      collect (agent-named name testbed)))
        (shipped (testbed-agents testbed)))
    (check-names-differ
     (remove-duplicates (append agents
                                (when (notany (lambda (agent) (assoc agent shipped)) agents)
                                  (and (or (null agents) (option-values :load options))
                                       (mapcar #'first shipped))))
                        :from-end t))))

(defun check-names-differ (agents)
  "Return AGENTS. Signal BAD-LINE if two have one name, by which tables know them."
  (loop for (agent . others) on agents
        do (when (member agent others :test #'string=)
             (reject-line "Two agents are called ~(~A~), so a table cannot tell them apart. Rename ~
                           one." agent)))
  agents)

(defun run-one-testbed (testbed options)
  (cond ((set-difference (mapcar #'first options) '(:load :other))
         (run-agents testbed (agents-from-options testbed options) options))
        (t (testbed (testbed-name testbed))
           0)))

(defun save-pages (testbeds options)
  "Write the pages of TESTBEDS into the directory of OPTIONS. Print their files as they are done."
  (let ((out (option-value :out options)))
    (ensure-results-directory out)
    (dolist (testbed testbeds)
      (dolist (file (save-testbed-pages out :names (list (testbed-name testbed))
                                            :seeds (option-value :seeds options 100)
                                            :workers (option-value :workers options (processors))
                                            :stream (progress-stream options)))
        (format t "~A~%" (native-name file))
        (finish-output)))
    0))

(defun check-loaded-agent-named (options words known)
  "Signal USAGE-ERROR if files were loaded for a testbed that was KNOWN before, and no agent is
named, so that none of the files would play."
  (when (and words
             (option-values :load options)
             (set-difference (mapcar #'first options) '(:load :other :all :agent))
             (not (find :all options :key #'first))
             (not (find :agent options :key #'first))
             (find (first words) known :key #'testbed-name :test #'string-equal))
    (reject-usage "--load needs --agent AGENT: which plan or function of ~A is to play?"
                  (first (option-values :load options)))))

(defun testbed-command (arguments)
  (let* ((options (parse-options arguments :table *testbed-options* :others t))
         (words (option-values :other options)))
    (check-testbed-options options words)
    (let ((known (all-testbeds)))
      (load-files-before-prompt (option-values :load options))
      (print-loading-messages)
      (check-loaded-agent-named options words known))
    (call-reporting-interruption
     (lambda ()
       (handler-bind ((bad-line (lambda (line) (reject-usage "~A" (bad-line-text line)))))
         (let ((testbed (and words (testbed-named (first words)))))
           (cond ((option-value :all options)
                  (save-pages (if testbed (list testbed) (all-testbeds)) options))
                 (testbed (run-one-testbed testbed options))
                 (t (write-testbed-list *standard-output*)
                    0)))))
     "testbed" arguments options)))
