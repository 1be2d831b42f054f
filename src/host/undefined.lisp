;;;; undefined.lisp -- names that the compiler finds used, and that nobody has defined.

(in-package :ars-magna.host)

(export '(undefined-name still-undefined-p))

(defun undefined-name (condition)
  "Return the name that CONDITION, a warning of the compiler's, says is not defined, and whether as
a :FUNCTION or :VARIABLE; NIL if it says something else."
  (let ((arguments (and (typep condition '(and warning simple-condition))
                        (simple-condition-format-arguments condition))))
    (when (and (proper-list-p arguments)
               (= 2 (length arguments))
               (member (first arguments) '(:function :variable)))
      (values (second arguments) (first arguments)))))

(defun still-undefined-p (name kind)
  "True if NAME is not defined as KIND, a :FUNCTION or :VARIABLE, by now either."
  (ecase kind
    (:function (not (fboundp name)))
    (:variable (not (or (boundp name) (known-variable-p name nil))))))
