;;;; kinds-of-files.lisp -- what a file holds, for somebody who has given it to the wrong function.

(in-package :ars-magna.base)

(defparameter *file-beginnings*
  '((:journal ";;;; A journal of ARS MAGNA"
     "it is a journal; (replay FILE) and (load-journal FILE) read it")
    (:run ";;;; A run of ARS MAGNA"
     "it is a saved run; (load-simulation FILE) and (with-loaded-simulation (FILE) ...) read it")
    (:table "experiment,fingerprint,condition,"
     "it is the table of an experiment; (read-results DIRECTORY) reads the directory that it is in")
    (:image "P2" "it is an image; (import-map FILE) reads the .yaml file that names it")
    (:image "P5" "it is an image; (import-map FILE) reads the .yaml file that names it")
    (:floor "image:" "it is the description of a map; (import-map FILE) reads it")
    (:lisp "(in-package" "it is Lisp; (load FILE) reads it")
    (:lisp "(def" "it is Lisp; (load FILE) reads it"))
  "Lists (kind beginning advice) of files, as they are saved.")

(defun beginning-of-file (path)
  "Return the first characters of the file PATH, or an empty text if it cannot be read."
  (or (ignore-errors
       (and (plain-file-p path)
            (with-open-file (in path :external-format :latin-1)
              (let ((text (make-string 60)))
                (subseq text 0 (read-sequence text in))))))
      ""))

(defun known-beginning (path)
  "Return the list (kind beginning advice) of the file PATH, or NIL."
  (find-if (lambda (beginning)
             (starts-with-subseq beginning (beginning-of-file path)))
           *file-beginnings* :key #'second))

(defun file-advice (path kind)
  "Return in words what is in the file PATH, and what reads it, if that is another kind of file than
KIND, a keyword; else NIL."
  (let ((entry (known-beginning path)))
    (and entry
         (not (eq kind (first entry)))
         (third entry))))

(defun check-not-foreign (file kind what)
  "Signal MISUSE if there is something called FILE that is neither empty nor of KIND, a WHAT, whole
or damaged, or that cannot be told."
  (let ((path (ignore-errors (probe-file file))))
    (unless (or (null path)
                (ignore-errors
                 (and (plain-file-p path)
                      (or (string= "" (beginning-of-file path))
                          (eq kind (first (known-beginning path)))))))
      (reject-use "~A is no ~A, and is left as it is. Give another name." (shown-name file) what))))
