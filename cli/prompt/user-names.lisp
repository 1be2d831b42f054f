;;;; user-names.lisp -- robots are called by their names in ARS-USER, wherever they were defined.

(in-package :ars-magna.cli)

;;; The variable of a robot is a symbol of the package that its world was written in. ARS-USER
;;; imports the robots that the prompt may command, so that (robot-turn robbie 1 nil) means what it
;;; says. What the user has defined under such a name himself stays as it is; and a robot that he
;;; defines under it is another one, his own.

(defun user-package () (find-package :ars-user))

(defun defined-p (symbol)
  (or (boundp symbol) (fboundp symbol)))

(defun other-robot-p (symbol)
  (and (not (eq (symbol-package symbol) (user-package)))
       (boundp symbol)
       (robot-p (symbol-value symbol))))

(defun call-by-its-name (name)
  "Let NAME, a robot's variable, be known in ARS-USER, unless its name means something else there."
  (multiple-value-bind (known status) (find-symbol (symbol-name name) (user-package))
    (unless (eq known name)
      ;; What has merely been read, or is a robot's of another world, gives way.
      (when (and (member status '(:internal :external))
                 (or (not (defined-p known)) (other-robot-p known)))
        (unintern known (user-package))
        (setf status nil))
      (unless status (import (list name) (user-package))))))

(defun call-by-name (names)
  (mapc #'call-by-its-name names))

(defun with-own-name (form)
  "Return FORM, with a name of ARS-USER's own if it would define another world's robot anew."
  (if (and (consp form)
           (eq 'defrobot (first form))
           (consp (rest form))
           (symbolp (second form))
           (eq (second form) (find-symbol (symbol-name (second form)) (user-package)))
           (other-robot-p (second form)))
      (destructuring-bind (operator name &rest clauses) form
        (unintern name (user-package))
        (list* operator (intern (symbol-name name) (user-package)) clauses))
      form))
