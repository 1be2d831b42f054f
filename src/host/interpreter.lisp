;;;; interpreter.lisp -- functions that are interpreted, and what they have closed over.

(in-package :ars-magna.host)

(export '(environment-p environment-values fixed-slot-p))

;;; An SBCL that was built without SB-EVAL has no interpreted functions: there nothing is one.

;;; A function that is interpreted, as those of plans that programs make are, has its variables in
;;; an ENVIRONMENT of the interpreter's, which all functions made there share.

#+#.(cl:if (cl:find-package "SB-EVAL") '(:and) '(:or))
(progn
  (defun environment-p (object)
    "True if OBJECT is an environment of the interpreter's."
    (internal (:sb-eval #:env-p) object))

  (defun environment-values (environment)
    "Return a list of the values of the variables, and of the functions, in ENVIRONMENT and around."
    (loop for each = environment then (internal (:sb-eval #:env-parent) each)
          while each
          append (mapcar #'cdr (internal (:sb-eval #:env-vars) each))
          append (mapcar #'cdr (internal (:sb-eval #:env-funs) each))))

  (defun interpreted-p (object)
    (internal-type-p object :sb-kernel #:interpreted-function))

  (defun interpreted-environment (function)
    (internal (:sb-eval #:interpreted-function-env) function))

  (defun (setf interpreted-environment) (environment function)
    (setf (internal (:sb-eval #:interpreted-function-env) function) environment))

  (defun copy-interpreted (function)
    (internal (:sb-eval #:make-interpreted-function)
              :name (internal (:sb-eval #:interpreted-function-name) function)
              :lambda-list (internal (:sb-eval #:interpreted-function-lambda-list) function)
              :env (interpreted-environment function)
              :declarations (internal (:sb-eval #:interpreted-function-declarations) function)
              :documentation (internal (:sb-eval #:interpreted-function-documentation) function)
              :body (internal (:sb-eval #:interpreted-function-body) function)
              :source-location (internal (:sb-eval #:interpreted-function-source-location)
                                         function)))

  (defun same-interpreted-p (function other)
    "True if FUNCTION and OTHER are interpreted, and made by the same form."
    (and (interpreted-p function)
         (interpreted-p other)
         (eq (internal (:sb-eval #:interpreted-function-body) function)
             (internal (:sb-eval #:interpreted-function-body) other)))))

#-#.(cl:if (cl:find-package "SB-EVAL") '(:and) '(:or))
(progn
  (defun environment-p (object)
    "True if OBJECT is an environment of the interpreter's: never, as this SBCL has none."
    (declare (ignore object))
    nil)
  (defun environment-values (environment) (declare (ignore environment)) '())
  (defun interpreted-p (object) (declare (ignore object)) nil)
  (defun interpreted-environment (function) function)
  (defun (setf interpreted-environment) (environment function)
    (declare (ignore function))
    environment)
  (defun copy-interpreted (function) function)
  (defun same-interpreted-p (function other) (eq function other)))

(defun fixed-slot-p (name)
  "True unless what is in the slot NAME of environments belongs to those who have them."
  (not (member name '("PARENT" "VARS" "FUNS") :test #'string=)))
