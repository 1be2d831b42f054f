;;;; files.lisp -- the files in the directory of an experiment.

(in-package :ars-magna.experiment)

(defun file-in (directory name)
  (merge-pathnames (native-path name) directory))

(defun rows-file (directory) (file-in directory "rows.csv"))
(defun series-file (directory) (file-in directory "series.csv"))
(defun machine-file (directory) (file-in directory "machine.csv"))
(defun description-file (directory) (file-in directory "experiment.txt"))

(defun lock-file (directory) (file-in directory ".lock"))

(defun check-plain (file)
  "Signal DAMAGED-TABLE if what is called FILE, if anything, is no file of bytes."
  (let ((trouble (cond ((dangling-link-p file) "it is a link to a file that there is not")
                       ((and (probe-file file) (not (plain-file-p file)))
                        "it is a directory, pipe, socket or device"))))
    (when trouble
      (reject-table file nil "~A. Remove it, or give another directory." trouble))))

(defun check-files-plain (directory)
  "Signal DAMAGED-TABLE if what is called like a file of DIRECTORY is no file of bytes."
  (mapc #'check-plain (list (rows-file directory) (series-file directory) (machine-file directory)
                            (description-file directory))))

(defun directory-called (name)
  "Return the absolute path of the directory NAME, a string or pathname."
  (uiop:ensure-directory-pathname
   (merge-pathnames (path-called name :directory t) (base-directory))))
