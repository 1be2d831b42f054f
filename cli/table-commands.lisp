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
  "Do what ./cli/ars-magna merge ARGUMENTS does. Return the status to exit with."
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
