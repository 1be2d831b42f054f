;;;; definitions.lisp -- what all defining forms share: where they stand, what is wrong with them.

(in-package :ars-magna.base)

;;; A defining form is checked when it is expanded and carried out when that is evaluated. In
;;; both, *DEFINITION* says which one it is, so that an error names file and line, and restarts
;;; leave the definition out, read it again from its file, or take another form instead.

(defvar *definition* nil
  "The definition that is being expanded or carried out: a list (source operator name), or NIL. The
operator is a symbol or string.")

(defun current-source ()
  "Return the source of the definition that is being carried out, or NIL if it was typed."
  (first *definition*))

(defun clause-place (clause)
  "Return where CLAUSE of the definition at hand stands, such as \"yard.lisp, line 7\", or NIL."
  (destructuring-bind (&optional (source (source-here)) operator name) *definition*
    (when source
      (format nil "~A~@[, line ~D~]" (source-file source)
              (clause-line (source-file source) operator name clause)))))

(defun reject-clause (definition clause expected)
  "Signal MALFORMED-DEFINITION about CLAUSE of DEFINITION (a string such as \"defmap watson\")."
  (error 'malformed-definition :definition definition :clause clause :expected expected
                               :place (clause-place clause)))

;;; Restarts.

(defun read-value (what)
  "Ask the user for WHAT, a form; return a list of it."
  (format *query-io* "~&~A: " what)
  (finish-output *query-io*)
  (list (read *query-io*)))

(defun call-with-definition-restarts (function replace)
  "Call FUNCTION. A user who chooses so leaves the definition at hand out, or has REPLACE called
with another form for it: read again from its file, or typed."
  (destructuring-bind (source operator name) *definition*
    (restart-case (funcall function)
      (skip-definition ()
        :report (lambda (stream) (format stream "Leave (~(~A ~A~) ...) out." operator name))
        nil)
      (read-again ()
        :test (lambda (condition) (declare (ignore condition)) (source-file source))
        :report (lambda (stream)
                  (format stream "Read (~(~A ~A~) ...) again from ~A."
                          operator name (source-file source)))
        (funcall replace (read-definition-again (source-file source) operator name)))
      (use-value (form)
        :report (lambda (stream) (format stream "Use another form for (~(~A ~A~) ...)."
                                         operator name))
        :interactive (lambda () (read-value "A form to define it by"))
        (funcall replace form)))))

(defun call-as-definition (source operator name function)
  "Call FUNCTION, which carries out the definition (OPERATOR NAME ...) from SOURCE."
  (let ((*definition* (list source operator name)))
    (call-with-definition-restarts function #'eval)))

(defun expand-definition (form function)
  "Return the expansion of FORM, (operator name ...): what FUNCTION returns, a list of forms that
carry it out and as second value a list of forms to come before. The whole returns the name."
  (destructuring-bind (operator &optional name &rest clauses) form
    (declare (ignore clauses))
    (let ((*definition* (list (source-here) operator name)))
      (call-with-definition-restarts
       (lambda ()
         (multiple-value-bind (forms before) (funcall function)
           `(progn
              ,@before
              (call-as-definition ',(current-source) ',operator ',name
                                  (lambda () ,@forms))
              ',name)))
       #'identity))))
