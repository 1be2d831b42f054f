;;;; executable.lisp -- this program as one file, with a user's experiments, to be run anywhere.

(in-package :ars-magna.cli)

;;; What is saved needs neither SBCL nor sources where it runs, but a machine of this kind. It is
;;; the same program, in which the user's file has been loaded: `./PROGRAM experiment NAME` runs
;;; what is in it, with the fingerprints that it would have here.

(defvar *beginning* nil "The function that this program has begun by calling.")

(defvar *saved-by-user-p* nil "True in a program that a user has saved.")

(defun program-words ()
  (list (or (and (not *saved-by-user-p*) (environment-value "ARS_MAGNA_PROGRAM"))
            (first (uiop:raw-command-line-arguments)))))

(defun save-program (name)
  "Save this program, as it is now, as the executable file NAME, and end this process."
  (settle-fingerprints)
  (setf *saved-by-user-p* t)
  (let ((path (native-path name)))
    (handler-case (progn (check-unprotected path)
                         (when (existing-path path) (delete-file path))
                         (sb-ext:save-lisp-and-die path :executable t :save-runtime-options t
                                                        :toplevel *beginning*))
      (error (condition)
        (reject-line "~A cannot be saved: ~A" name (one-line (own-text condition)))))))

(defun save-program-with (words name)
  "Save this program as the executable file NAME, with the experiments that WORDS, the file or name
of one, stand for. Signals BAD-LINE."
  ;; Who saves a Lisp ends it; so it is done by another process.
  (let* ((new (format nil "~A.new" name))
         (arguments (append (rest (program-words)) (list "experiment") words
                            (list "--save-executable" new))))
    (unless (eql 0 (run-attached (first (program-words)) arguments))
      (reject-line "~A could not be saved." name))
    (replace-file (native-path name) (native-path new))))
