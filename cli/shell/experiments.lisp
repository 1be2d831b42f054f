;;;; experiments.lisp -- the experiment that a user means by a file, a name, or both; its results.

(in-package :ars-magna.cli)

;;; A file is meant by its exact name, or without its type; a defined experiment, such as those of
;;; worlds/, by its name. The exact name of a file goes first, then an experiment.

(defun experiment-name-strings (experiments)
  (mapcar (lambda (experiment) (string-downcase (experiment-name experiment))) experiments))

(defun find-experiment-in (name experiments)
  (find name experiments :key #'experiment-name :test #'same-name-p))

(defun experiments-in-file (file experiments)
  "Return those of EXPERIMENTS that FILE itself defines. If there are none, return all EXPERIMENTS:
files loaded by FILE define them."
  (or (remove (native-name (truename file)) experiments :key #'experiment-file :test-not #'equal)
      experiments))

(defun load-experiments (path)
  "Load the Lisp file PATH and return its experiments. Signals BAD-LINE if there are none."
  ;; Output of the file goes to the error output.
  (let ((before (all-experiments)) (*standard-output* *error-output*))
    (unwind-protect (call-refusing-exits (lambda () (load-lisp path)))
      (finish-output *error-output*))
    (or (experiments-in-file path (set-difference (all-experiments) before))
        (reject-line "~A defines no experiment; a file of experiments needs a DEFEXPERIMENT."
                     (native-name path)))))

(defun reject-experiment (name known)
  (let ((names (experiment-name-strings known)))
    (reject-line "There is no experiment ~A.~@[ Did you mean ~A?~] Known: ~{~A~^, ~}."
                 name (nearest-name name names) names)))

(defun reject-file-or-experiment (name)
  (let ((known (experiment-name-strings (all-experiments))))
    (reject-line "There is no file ~A, nor an experiment of that name.~@[ Did you mean ~A?~]~@[ ~
                  Known: ~{~A~^, ~}.~]"
                 name (nearest-name name known) known)))

(defun single-experiment (file experiments)
  (if (rest experiments)
      (reject-line "~A has several experiments: ~{~A~^, ~}. Name one after the file."
                   file (sort (experiment-name-strings experiments) #'string<))
      (first experiments)))

(defun experiments-named (word)
  "Load the file WORD and return its experiments, or return a list of the experiment named WORD.
Signals BAD-LINE if there is neither."
  (let* ((path (path-of-name word))
         (known (find-experiment-in word (all-experiments)))
         (file (or (and (pathname-name path) (existing-path path))
                   (and (not known) (existing-lisp-file word)))))
    (cond (file (load-experiments file))
          (known (list known))
          (t (reject-file-or-experiment word)))))

(defun experiment-named (word &optional name)
  "Return the experiment named by WORD, a file or an experiment. If the file has several
experiments, NAME names the one to return. Signals BAD-LINE if there is no such experiment."
  (let ((experiments (experiments-named word)))
    (cond ((null name) (single-experiment word experiments))
          ((find-experiment-in name experiments))
          ((find-experiment-in name (all-experiments)))
          (t (reject-experiment name experiments)))))

(defun ensure-results-directory (name)
  "Return the path of the directory NAME. Make the directory if it does not exist."
  (handler-case (ensure-store-directory name)
    (misuse (condition) (reject-line "~A" condition))))

;;; What is said of results.

(defun report-results (results plot)
  "Print RESULTS. If they have a directory, write the text there, too; with PLOT, also pictures."
  (print-results results *standard-output*)
  (when (results-directory results)
    (overwrite-file (lambda (out) (call-with-page-width (lambda () (print-results results out))))
                     (merge-pathnames "summary.txt" (results-directory results))
                     "the summary" :remedy "remove it, or give another directory"))
  (when plot (save-result-pictures results (results-directory results))))
