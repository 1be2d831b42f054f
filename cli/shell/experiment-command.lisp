;;;; experiment-command.lisp -- ./cli/ars-magna experiment, merge and compare.

(in-package :ars-magna.cli)

;;; The results are written to the standard output when an experiment is over, and nothing else is;
;;; progress goes to the error output.

;;; Values of options.

(defun parse-count (text)
  (let ((number (number-from-text text)))
    (if (and (integerp number) (<= 1 number 1000000000))
        number
        (reject-usage "~A takes a whole number from 1 to 1e9, in digits, not ~A." *option-name*
                      text))))

(defun parse-interval-width (text)
  (let ((number (number-from-text text)))
    (if (and number (< 0 number 1))
        number
        (reject-usage "--until takes the width of an interval, such as .02, not ~A." text))))

(defconstant +largest-count-of-shards+ 100000
  "The largest number of shards. The numbers of all shards must fit on a command line.")

(defun parse-shard-count (text)
  (let ((count (number-from-text text)))
    (if (and (integerp count) (<= 1 count +largest-count-of-shards+))
        count
        (reject-usage "--shards takes a number of parts, from 1 to ~D, not ~A."
                      +largest-count-of-shards+ text))))

(defun parse-shard (text)
  "Return a cons (index . count) for TEXT, which has the form I/N."
  (let* ((slash (position #\/ text))
         (index (and slash (ignore-errors (parse-integer text :end slash))))
         (count (and slash (ignore-errors (parse-integer text :start (1+ slash))))))
    (if (and index count (< -1 index count (1+ +largest-count-of-shards+)))
        (cons index count)
        (reject-usage "--shard takes I/N: shard I of N shards, with I from 0 to N - 1 and N at ~
                       most ~D. It does not take ~A."
                      +largest-count-of-shards+ text))))

(defun parse-path (text)
  (if (string= text "")
      (reject-usage "~A takes the name of a file or directory, not an empty one." *option-name*)
      text))

(defparameter *experiment-options*
  '(("--trials" :trials parse-count) ("--workers" :workers parse-count) ("--out" :out parse-path)
    ("--until" :until parse-interval-width) ("--time-limit" :time-limit parse-seconds)
    ("--plot" :plot nil) ("--quiet" :quiet nil)
    ("--shard" :shard parse-shard) ("--parallel" :parallel identity :optional)
    ("--slurm" :slurm identity :optional) ("--shards" :shards parse-shard-count)
    ("--missing" :missing nil) ("--save-executable" :save-executable parse-path))
  "The options of the command `experiment`, in the format of *OPTIONS*.")

(defparameter *options-that-need-others*
  '(("--plot" :plot :out) ("--shard" :shard :out) ("--parallel" :parallel :out)
    ("--slurm" :slurm :out) ("--missing" :missing :out) ("--missing" :missing :shards)
    ("--shards" :shards :parallel :slurm :missing))
  "Lists (option key other-key...): the option needs one of the options with the other keys.")

(defparameter *options-that-exclude-others*
  '((:shard :parallel :slurm :missing :save-executable) (:until :shard) (:until :parallel)
    (:until :slurm) (:until :missing) (:time-limit :missing))
  "Lists of keys of options that exclude each other.")

(defun option-with-key (key)
  (first (find key *experiment-options* :key #'second)))

(defun check-option-combination (options)
  "Signal USAGE-ERROR if OPTIONS cannot be combined."
  (flet ((given-p (key) (find key options :key #'first)))
    (loop for (option key . others) in *options-that-need-others*
          do (when (and (given-p key) (notany #'given-p others))
               (reject-usage "~A needs ~{~A~^ or ~}." option (mapcar #'option-with-key others))))
    (loop for keys in *options-that-exclude-others*
          for given = (remove-if-not #'given-p keys)
          do (when (rest given)
               (reject-usage "~A excludes ~A. Give only one." (option-with-key (first given))
                             (option-with-key (second given)))))))

;;; Running here.

(defun run-experiment-with-options (experiment options)
  (let ((directory (let ((out (option-value :out options)) (shard (option-value :shard options)))
                     (if shard (shard-directory out (car shard) (cdr shard)) out))))
    (when directory (ensure-results-directory directory))
    (apply #'run-experiment experiment
           :trials (option-value :trials options)
           :workers (option-value :workers options (processors))
           :until (option-value :until options)
           :shard (option-value :shard options)
           :directory directory
           :stream (and (not (option-value :quiet options)) *error-output*)
           (let ((seconds (option-value :time-limit options)))
             (and seconds (list :time-limit seconds))))))

(defun run-experiment-in-this-process (experiment options)
  (let ((shard (option-value :shard options)) (trials (trial-count experiment options)))
    (cond ((null shard)
           (report-results (run-experiment-with-options experiment options)
                           (option-value :plot options)))
          ((shard-has-trials-p shard trials) (run-experiment-with-options experiment options))
          (t (print-notice "shard ~D of ~D has no trials: there are only ~D of each condition."
                           (car shard) (cdr shard) trials)))
    0))

(defun report-interruption (command arguments options under-way)
  "Report that COMMAND with ARGUMENTS was interrupted, how many rows are kept, and how to continue.
UNDER-WAY is a text about a trial that took long, or NIL."
  (let* ((out (option-value :out options))
         (rows (and out (ignore-errors (count-rows out)))))
    (if out
        (print-notice "stopped with ~D row~:P in ~A~@[; ~A~]. To continue:~%  ~A"
                      (or rows 0) out under-way
                      (uiop:escape-sh-command
                       (append (program-command-line) (list command) arguments)))
        (print-notice "stopped; ~@[~A; ~]nothing is kept without --out DIR." under-way))))

(defun call-reporting-interruption (function command arguments options)
  "Call FUNCTION, which runs COMMAND with ARGUMENTS. Return the exit status, 130 if interrupted."
  (let ((under-way nil))
    (flet ((look (condition)
             (declare (ignore condition))
             (setf under-way (current-slow-trial-text))))
      (call-until-interrupted (lambda ()
                                (handler-bind ((user-interrupt #'look))
                                  (funcall function)))
                              (lambda ()
                                ;; The reader may have been stopped, too.
                                (ignore-errors
                                 (report-interruption command arguments options under-way))
                                130)))))

(defun print-missing-shards (experiment options)
  "Print, on one line, the numbers of the shards with missing rows."
  (format t "~{~D~^ ~}~%" (missing-shards experiment (trial-count experiment options)
                                          (option-value :shards options)
                                          (option-value :out options)))
  0)

(defun carry-out-experiment (experiment words options)
  "Run EXPERIMENT, named by the arguments WORDS, with OPTIONS. Return the exit status."
  (cond ((option-value :save-executable options)
         (save-program (option-value :save-executable options)))
        ((option-value :missing options) (print-missing-shards experiment options))
        ((option-value :parallel options)
         (run-by-script experiment words options "run.sh" "spread-parallel.sh" #'parallel-settings))
        ((option-value :slurm options)
         (run-by-script experiment words options "job.sh" "spread-slurm.sh" #'slurm-settings))
        (t (run-experiment-in-this-process experiment options))))

(defun print-loading-messages ()
  "Print the messages that loading files has left, because a shell has no prompt to show them."
  (dolist (message (take-messages))
    (print-notice "~A" (short-error-text (message-text message)))))

(defun experiment-from-words (words)
  "Return the experiment named by WORDS: its name, or a file and perhaps a name in the file."
  (prog1 (apply #'experiment-named words)
    (print-loading-messages)))

(defun experiment-command (arguments)
  (let* ((options (parse-options arguments :table *experiment-options* :others t))
         (words (option-values :other options)))
    (check-option-combination options)
    (unless (<= 1 (length words) 2)
      (reject-usage "experiment takes the name of an experiment, or a file and at most one name ~
                     in it~@[, not ~{~A~^ ~}~].~@[ Known: ~{~A~^, ~}.~]"
                    words (experiment-name-strings (all-experiments))))
    (when (option-value :save-executable options) (end-on-interrupt))
    (call-reporting-interruption
     (lambda () (carry-out-experiment (experiment-from-words words) words options))
     "experiment" arguments options)))

;;;; Tables

(defparameter *merge-options*
  '(("--out" :out parse-path) ("--plot" :plot nil))
  "The options of the command `merge`, in the format of *OPTIONS*.")

(defun merge-command (arguments)
  (let* ((options (parse-options arguments :table *merge-options* :others t))
         (directories (option-values :other options))
         (out (option-value :out options)))
    (unless (and directories out)
      (reject-usage "merge takes directories with results, and --out DIR."))
    (report-results (merge-results (loop for directory in directories
                                         append (or (directories-with-rows directory)
                                                    (reject-line "There are no rows in ~A, nor ~
                                                                  in shards below it."
                                                                 directory)))
                                   :to out)
                    (option-value :plot options))
    0))

;;; Comparing. Two words are directories, of versions of the code. Others are conditions or values
;;; of a factor, then results or an experiment. With --by, all words say where the results are.

(defparameter *compare-options*
  '(("--by" :by identity) ("--against" :against identity)
    ("--measure" :measure identity) ("--plot" :plot parse-path) ("--trials" :trials parse-count)
    ("--workers" :workers parse-count) ("--out" :out parse-path) ("--quiet" :quiet nil))
  "The options of the command `compare`, in the format of *OPTIONS*.")

(defun parse-condition (word)
  "Convert WORD to an argument of COMPARE-CONDITIONS: a condition's number, its name, or :ALL."
  (cond ((string-equal word "all") :all)
        ((and (plusp (length word)) (every #'digit-char-p word)) (parse-integer word))
        (t word)))

(defun results-from-words (words options)
  "Return the results for WORDS: a directory with results, or an experiment, which is then run."
  (if (and (null (rest words))
           (uiop:directory-exists-p (native-path-of-directory (first words)))
           (directories-with-rows (first words)))
      (read-results (first words))
      (run-experiment-with-options (experiment-from-words words) options)))

(defun make-comparison (words options)
  (let ((measure (option-values :measure options)) (factor (option-value :by options)))
    (if factor
        (compare-levels (results-from-words words options) factor
                        :against (option-value :against options) :measure measure)
        (destructuring-bind (first second &rest where) words
          (if where
              (compare-conditions (results-from-words where options)
                                  (parse-condition first) (parse-condition second) :measure measure)
              (compare-results first second :measure measure))))))

(defun check-compare-arguments (words options)
  (cond ((option-value :by options)
         (unless (<= 1 (length words) 2)
           (reject-usage "compare --by FACTOR takes a directory with results, or an experiment.")))
        ((option-value :against options)
         (reject-usage "--against VALUE needs --by FACTOR."))
        ((not (<= 2 (length words) 4))
         (reject-usage "compare takes two directories with results; or two conditions or values, ~
                        then a directory or experiment; or --by FACTOR and a directory or ~
                        experiment."))))

(defun compare-command (arguments)
  (let* ((options (parse-options arguments :table *compare-options* :others t))
         (words (option-values :other options)))
    (check-compare-arguments words options)
    (call-reporting-interruption
     (lambda ()
       (let ((comparison (make-comparison words options)))
         (when (option-value :plot options)
           (apply #'save-comparison-picture comparison (option-value :plot options)
                  (when (option-value :measure options)
                    (list :measure (option-value :measure options)))))
         0))
     "compare" arguments options)))
