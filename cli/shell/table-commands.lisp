;;;; table-commands.lisp -- ./cli/ars-magna merge and compare: what is done with tables there are.

(in-package :ars-magna.cli)

(defparameter *merge-options*
  '(("--out" :out parse-path) ("--plot" :plot nil))
  "The options of the command MERGE, as in *OPTIONS*.")

(defun tables-in (directory)
  "Return the names of the directories with rows at and below DIRECTORY. Signals BAD-LINE."
  (or (directories-with-rows directory)
      (reject-line "There are no rows in ~A, nor in shards below it." directory)))

(defun merge-command (arguments)
  (let* ((options (parse-options arguments :table *merge-options* :others t))
         (directories (option-values :other options))
         (out (option-value :out options)))
    (unless (and directories out)
      (reject-usage "merge takes directories with results, and --out DIR."))
    (report-results (merge-results (loop for directory in directories
                                         append (tables-in directory))
                                   :to out)
                    (option-value :plot options))
    0))

;;; Comparing. Two words are directories, of two versions of the code; what else follows says in
;;; which results or experiment they are conditions, or values of what varies. With --by, all words
;;; say that.

(defparameter *compare-options*
  '(("--by" :by identity) ("--against" :against identity)
    ("--measure" :measure identity) ("--plot" :plot parse-path) ("--trials" :trials parse-count)
    ("--workers" :workers parse-count) ("--out" :out parse-path) ("--quiet" :quiet nil))
  "The options of the command COMPARE, as in *OPTIONS*.")

(defun condition-word (word)
  "Return what COMPARE-CONDITIONS takes for WORD: a condition's number, its name, or :ALL."
  (cond ((string-equal word "all") :all)
        ((and (plusp (length word)) (every #'digit-char-p word)) (parse-integer word))
        (t word)))

(defun results-directory-p (word)
  (and (uiop:directory-exists-p (native-path-of-directory word))
       (directories-with-rows word)))

(defun results-meant (words options)
  "Return the results that WORDS stand for: a directory with them, or an experiment, which is run."
  (if (and (null (rest words)) (results-directory-p (first words)))
      (read-results (first words))
      (results-of (known-experiment words) options)))

(defun comparison-wanted (words options)
  (let ((measure (option-values :measure options)) (factor (option-value :by options)))
    (if factor
        (compare-levels (results-meant words options) factor
                        :against (option-value :against options) :measure measure)
        (destructuring-bind (first second &rest where) words
          (if where
              (compare-conditions (results-meant where options)
                                  (condition-word first) (condition-word second) :measure measure)
              (compare-results first second :measure measure))))))

(defun check-words (words options)
  (cond ((option-value :by options)
         (unless (<= 1 (length words) 2)
           (reject-usage "compare --by FACTOR takes a directory with results, or an experiment.")))
        ((option-value :against options)
         (reject-usage "--against VALUE goes with --by FACTOR."))
        ((not (<= 2 (length words) 4))
         (reject-usage "compare takes two directories with results; or two conditions, or values, ~
                        and the directory or experiment they are in; or --by FACTOR and that."))))

(defun compare-command (arguments)
  (let* ((options (parse-options arguments :table *compare-options* :others t))
         (words (option-values :other options)))
    (check-words words options)
    (call-stoppable
     (lambda ()
       (let ((comparison (comparison-wanted words options)))
         (when (option-value :plot options)
           (apply #'save-comparison-picture comparison (option-value :plot options)
                  (when (option-value :measure options)
                    (list :measure (option-value :measure options)))))
         0))
     "compare" arguments options)))
