;;;; commands.lisp -- the first argument of ./cli/ars-magna, if it is no option: what is to be done.

(in-package :ars-magna.cli)

(defparameter *shell-commands*
  '(("experiment" experiment-command)
    ("merge" merge-command)
    ("compare" compare-command))
  "Lists (name function): the function gets the arguments that follow, a list of strings, and
returns the status to exit with. What it does is said in usage-NAME.txt.")

(defun find-command-called (name)
  (or (find name *shell-commands* :key #'first :test #'string=)
      (reject-usage "There is no command ~A, nor a file of that name.~@[ Did you mean ~A?~] Known: ~
                     ~{~A~^, ~}."
                    name
                    (nearest-name name (mapcar #'first *shell-commands*))
                    (mapcar #'first *shell-commands*))))

(defun usage-of-command (name)
  "Return the text of usage for the command NAME, or for all if that is NIL or none."
  (or (and name (text-called (format nil "usage-~A.txt" name)))
      (text-called "usage.txt")))

(defun run-command-called (name arguments)
  "Do the command NAME with ARGUMENTS. Return the status to exit with."
  (let ((command (find-command-called name)) (*error-output* (text-output 2)))
    (unwind-protect (funcall (second command) arguments)
      ;; What Lisp itself writes there, such as warnings, stays in the stream until then.
      (ignore-errors (finish-output *error-output*)))))
