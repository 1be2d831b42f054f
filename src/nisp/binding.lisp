;;;; binding.lisp -- forms that bind variables with declared types: LET, \, DEFFUNC and kin.

(in-package :ars-magna.nisp)

;;; From here on LET means ours in this package.

(public let)
(defmacro let (bindings &body body)
  "Evaluate BODY with BINDINGS in force, as CL:LET; a hyphen and a type may follow each binding:
(let ((v init) - TYPE (w init)) ...) (manual 3.1)."
  `(cl:let ,(untyped-bindings bindings) ,@body))

(public \\)
(defmacro \\ (lambda-list &body body)
  "Return the function (lambda LAMBDA-LIST BODY...); a hyphen and a type may follow each parameter
(manual 3.1). The name is one backslash, typed as two. See reading 4."
  `#'(lambda ,(untyped-lambda-list lambda-list "\\") ,@body))

(defun check-continuation (lambda-list body)
  "Signal MALFORMED-DEFINITION, or warn, if LAMBDA-LIST of a CONTINUATION with BODY seems to be what
is to be done."
  (let ((*print-pretty* nil) (*print-case* :downcase) (shown (abridged lambda-list)))
    (when (consp lambda-list)
      (cond ((some #'constantp (ldiff lambda-list (member-if #'lambda-keyword-p lambda-list)))
             (reject-clause "continuation" shown
                            (format nil "parameters before what is to be done: (continuation (err ~
                                         &rest results) ~S)" shown)))
            ((and (null body) (symbolp (first lambda-list)) (fboundp (first lambda-list)))
             (doubt-definition "continuation: ~S are its parameters, and nothing is done. Write ~
                                (continuation (err &rest results) ~:*~S)." shown))))))

(defun doubt-codes (variable body)
  "Warn of what BODY, of a CONTINUATION, compares VARIABLE, its first parameter, with and that is no
error code."
  (map-comparisons (lambda (subject word form)
                     (declare (ignore form))
                     (cl:let ((doubt (and (eq subject variable) (code-doubt word))))
                       (when doubt (doubt-definition "continuation: ~A" doubt))))
                   body))

(public continuation)
(defmacro continuation (lambda-list &body body)
  "Return a function for a robot command to call with an error code (NIL: none) and what else it
reports. Like LAMBDA, but types may follow the parameters and unused ones are no matter
(manual 3.1.1; reading 39)."
  (let ((lambda-list (untyped-lambda-list lambda-list "continuation")))
    (check-continuation lambda-list body)
    (doubt-codes (first lambda-list) body)
    `#'(lambda ,lambda-list
         (declare (ignorable ,@(lambda-list-variables lambda-list)))
         ,@body)))

(eval-when (:compile-toplevel :load-toplevel :execute)
  (defun expand-procedure (operator name definition)
    "Return the DEFUN for what follows NAME in an OPERATOR form: a hyphen and the result type, if
given, then the parameters and the body."
    (let ((definition (if (hyphen-p (first definition)) (cddr definition) definition))
          (operator (format nil "~(~A ~A~)" operator name)))
      (check-function-name operator name)
      (when (or (null definition) (not (listp (first definition))))
        (reject-clause operator (first definition) "a list of parameters after the result type"))
      `(defun ,name ,(untyped-lambda-list (first definition) operator)
         ,@(rest definition)))))

(public deffunc)
(defmacro deffunc (name &rest definition)
  "Define NAME as a function without side effects: (deffunc name - TYPE (args) body...). Types may
follow the parameters (manual 3.1)."
  (expand-procedure 'deffunc name definition))

(public defproc)
(defmacro defproc (name &rest definition)
  "Define NAME as a procedure with side effects: (defproc name - TYPE (args) body...). Types may
follow the parameters (manual 3.1)."
  (expand-procedure 'defproc name definition))
