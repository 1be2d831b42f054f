;;;; texts.lisp -- the texts beside the sources: of usage, and of scripts that are written.

(in-package :ars-magna.cli)

;;; They are read when this file is loaded, so that a saved program has them with it.

(defparameter *texts*
  (loop for name in '("usage.txt" "usage-experiment.txt" "usage-merge.txt" "usage-compare.txt"
                      "spread-parallel.sh" "spread-slurm.sh")
        collect (list name (file-text (asdf:system-relative-pathname
                                       "ars-magna" (format nil "cli/shell/~A" name)))))
  "Lists (name text).")

(defparameter *version* (asdf:component-version (asdf:find-system "ars-magna"))
  "The version of this program.")

(defun text-called (name)
  (second (assoc name *texts* :test #'string=)))

(defun with-settings (text settings)
  "Return TEXT, of a script, with SETTINGS, lists (variable value comment), in their place."
  (let ((mark "@SETTINGS@"))
    (with-output-to-string (out)
      (write-string text out :end (search mark text))
      (format out "~:{~A=~A~40T# ~A~:^~%~}"
              (loop for (variable value comment) in settings
                    collect (list variable (uiop:escape-sh-token (princ-to-string value))
                                  comment)))
      (write-string text out :start (+ (search mark text) (length mark))))))
