;;;; testbeds.lisp -- ./cli/ars-magna testbed.

(in-package :ars-magna.cli)

(defun parse-setting (text)
  "Return a list (name value), strings, for TEXT, which has the form NAME=VALUE."
  (let ((equals (position #\= text)))
    (unless equals (reject-usage "--knob takes NAME=VALUE, such as dynamism=64, not ~A." text))
    (list (subseq text 0 equals) (subseq text (1+ equals)))))

(defparameter *testbed-options*
  '(("--agent" :agent identity) ("--load" :load identity) ("--seeds" :seeds parse-count)
    ("--knob" :knob parse-setting) ("--tuning" :tuning nil) ("--out" :out parse-path)
    ("--workers" :workers parse-count) ("--all" :all nil) ("--quiet" :quiet nil))
  "The options of the command `testbed`, in the format of *OPTIONS*.")

(defun testbed-named (name)
  (or (find-testbed name nil)
      (let ((names (mapcar (lambda (testbed) (string-downcase (testbed-name testbed)))
                           (all-testbeds))))
        (reject-line "There is no testbed ~A.~@[ Did you mean ~A?~] Known: ~{~A~^, ~}."
                     name (nearest-name name names) names))))

(defun full-name (symbol)
  (format nil "~(~A::~A~)" (package-name (symbol-package symbol)) symbol))

(defun agents-named (text names)
  "Return the agents of the name or full name TEXT: those among NAMES, and plans and functions that
are no agents of other testbeds."
  (let* ((end (position #\: text))
         (name (subseq text (if end (1+ (position #\: text :from-end t)) 0))))
    (remove-if-not (lambda (symbol)
                     (and (or (member symbol names)
                              (and (users-symbol-p symbol) (agent-p symbol)
                                   (notany (lambda (testbed)
                                             (assoc symbol (testbed-agents testbed)))
                                           (all-testbeds))))
                          (or (null end)
                              (eq (symbol-package symbol)
                                  (find-package (string-upcase (subseq text 0 end)))))))
                   (find-all-symbols (string-upcase name)))))

(defun agent-named (text testbed)
  "Return the agent TEXT: one of TESTBED, or the name of a plan or function of the user."
  (let* ((names (mapcar #'first (testbed-agents testbed)))
         (agents (agents-named text names)))
    (cond ((rest agents)
           (reject-line "There are several agents ~A: ~{~A~^, ~}. Rename yours, or use a full name."
                        text (sort (mapcar #'full-name agents) #'string<)))
          (agents (first agents))
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
      (list symbol (handler-case (read-data-from-string text 0)
                     (error () (reject-line "~A of ~A is no value." text name)))))))

(defun run-agents (testbed agents options)
  "Run AGENTS in TESTBED by OPTIONS. Print their scores and, of several, the differences."
  (let* ((knobs (loop for setting in (option-values :knob options)
                      collect (knob-setting setting testbed)))
         (out (option-value :out options
                            (format nil "out/~(~A~)~:[~;-tuning~]/" (testbed-name testbed)
                                    (option-value :tuning options))))
         (results (run-testbed (testbed-name testbed)
                               :agents agents :knobs knobs
                               :seeds (option-value :seeds options 100)
                               :tuning (option-value :tuning options)
                               :workers (option-value :workers options (processors))
                               :directory (progn (ensure-results-directory out) out)
                               :stream (and (not (option-value :quiet options)) *error-output*))))
    (report-results results nil)
    (when (rest agents)
      (terpri)
      (compare-levels results "agent" :against (string-downcase (first agents))
                                      :measure (testbed-score testbed)))
    (format t "~%The table is in ~A; compare it with: ars-magna compare --by agent ~:*~A~%" out)))

(defun agents-from-options (testbed options)
  "Return the agents to run: those of the options; after --load, also those of TESTBED."
  (let ((agents (loop for name in (option-values :agent options)
                      collect (agent-named name testbed))))
    (remove-duplicates (append agents
                               (when (or (null agents) (option-values :load options))
                                 (mapcar #'first (testbed-agents testbed))))
                       :from-end t)))

(defun run-one-testbed (name options)
  (let ((testbed (testbed-named name)))
    (if (intersection '(:agent :seeds :knob :tuning :out) (mapcar #'first options))
        (run-agents testbed (agents-from-options testbed options) options)
        (testbed (testbed-name testbed)))))

(defun save-all-pages (options)
  (let ((out (or (option-value :out options) (reject-usage "--all needs --out DIR."))))
    (ensure-results-directory out)
    (dolist (file (save-testbed-pages out :seeds (option-value :seeds options 100)
                                          :workers (option-value :workers options (processors))))
      (format t "~A~%" (native-name file)))))

(defun testbed-command (arguments)
  (let* ((options (parse-options arguments :table *testbed-options* :others t))
         (words (option-values :other options)))
    (load-files-before-prompt (option-values :load options))
    (when (rest words) (reject-usage "testbed takes the name of one testbed."))
    (call-reporting-interruption
     (lambda ()
       (cond ((option-value :all options) (save-all-pages options))
             (words (run-one-testbed (first words) options))
             (t (write-testbed-list *standard-output*)))
       0)
     "testbed" arguments options)))
