;;;; origin.lisp -- what a table was made with, and when, in words.

(in-package :ars-magna.experiment)

(export '(experiment-file))

;;; None of it decides a trial, so it is in no fingerprint.

(defun libraries-of (system)
  "Return the names of the libraries that the system called SYSTEM stands on, through its core."
  (loop for name in (remove-if-not #'stringp (asdf:system-depends-on (asdf:find-system system)))
        if (string= "ars-magna" (asdf:primary-system-name name))
          append (libraries-of name)
        else collect name))

(defparameter *libraries*
  (and (asdf:find-system "ars-magna" nil)
       (loop for name in (libraries-of "ars-magna")
             for library = (asdf:registered-system name)
             collect (format nil "~A~@[ ~A~]" name
                             (and library (asdf:component-version library)))))
  "The names of the libraries that the simulator is built with, with their versions.")

(defun git-says (directory &rest arguments)
  "Return what git, called with ARGUMENTS, says of DIRECTORY, without spaces around it; NIL if there
is no git, or DIRECTORY is in no tree of it."
  (multiple-value-bind (status text)
      (run-command "git" (list* "-C" (native-name directory) arguments) :output :string)
    (and (eql 0 status) (string-trim '(#\Space #\Newline) text))))

(defun commit-text (directory)
  "Return the commit that DIRECTORY is at, and whether its files have changed since; or NIL."
  (let ((commit (git-says directory "rev-parse" "HEAD")))
    (and commit
         (format nil "commit ~A~@[~A~]" commit
                 (and (string/= "" (or (git-says directory "status" "--porcelain"
                                                 "--untracked-files=no" "--" ".")
                                       ""))
                      ", and changes since")))))

(defun experiment-file (experiment)
  "Return what the system calls the file that EXPERIMENT is from, or NIL."
  (let ((entry (lookup-entry (experiment-name experiment) *experiments*)))
    (and entry (source-file (entry-source entry)))))

(defun origin-lines (experiment)
  "Return what a table of EXPERIMENT that is written now is made with, a list of lines."
  (let* ((file (experiment-file experiment))
         ;; The program may have been carried to where there are no sources.
         (system (asdf:registered-system "ars-magna"))
         (home (and system (asdf:system-source-directory system)))
         (commits (list (and file
                             (commit-text (uiop:pathname-directory-pathname (native-path file))))
                        (and home (probe-file home) (commit-text home)))))
    (remove nil
            (list (format nil "Written ~A by ~A ~A, ~A." (date-and-time)
                          (lisp-implementation-type) (lisp-implementation-version)
                          (machine-type))
                  (format nil "~@[Libraries: ~{~A~^, ~}.~]" *libraries*)
                  (and (first commits) (format nil "Its file: ~A." (first commits)))
                  (and (second commits) (format nil "The simulator: ~A." (second commits)))))))
