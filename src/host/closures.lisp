;;;; closures.lisp -- the variables and values that closures close over, compiled or interpreted.

(in-package :ars-magna.host)

(export '(environment-p environment-values interpreter-only-slot-p closure-p closure-values
                        copy-closure
          replace-closure-values value-cell-p cell-value exit-cell-p make-value-cell))

;;; An SBCL built without SB-EVAL has no interpreted functions, so no object is one.

;;; An interpreted function, such as those of plans that programs make, has its variables in an
;;; ENVIRONMENT of the interpreter. All functions made there share it.

#+#.(cl:if (cl:find-package "SB-EVAL") '(:and) '(:or))
(progn
  (defun environment-p (object)
    "True if OBJECT is an environment of SBCL's interpreter."
    (internal (:sb-eval #:env-p) object))

  (defun environment-values (environment)
    "Return the values of the variables and functions in ENVIRONMENT and its outer environments."
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
    "True if FUNCTION and OTHER are interpreted functions made by the same form."
    (and (interpreted-p function)
         (interpreted-p other)
         (eq (internal (:sb-eval #:interpreted-function-body) function)
             (internal (:sb-eval #:interpreted-function-body) other)))))

#-#.(cl:if (cl:find-package "SB-EVAL") '(:and) '(:or))
(progn
  (defun environment-p (object)
    "Return NIL: this SBCL has no interpreter."
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

(defun interpreter-only-slot-p (name)
  "True if the slot NAME of an interpreter's environment never holds users' variables or functions."
  (not (member name '("PARENT" "VARS" "FUNS") :test #'string=)))

;;; A closure is code and values. A closed-over variable that is assigned to is a CELL, which all
;;; its closures share. Interpreted functions close over their environment.

(defun interpreted-closure-p (object)
  (and (interpreted-p object)
       (environment-values (interpreted-environment object))
       t))

(declaim (inline compiled-closure-p closure-p))
(defun compiled-closure-p (object)
  (internal (:sb-kernel #:closurep) object))

(defun closure-p (object)
  "True if OBJECT is a function that closes over something."
  (or (compiled-closure-p object)
      (and (internal (:sb-kernel #:funcallable-instance-p) object)
           (interpreted-closure-p object))))

(defun closure-values (closure)
  "Return a list of the values and cells that CLOSURE closes over."
  (if (compiled-closure-p closure)
      (internal (:sb-kernel #:%closure-values) closure)
      (list (interpreted-environment closure))))

(sb-ext:define-load-time-global **closure-copier**
    (symbol-function (internal-name :sb-impl '#:copy-closure))
  "The function that copies a closure.")

(defun copy-closure (closure)
  "Return a new closure with the code, values and cells of CLOSURE."
  (if (compiled-closure-p closure)
      (funcall (the function **closure-copier**) closure)
      (copy-interpreted closure)))

(defun replace-closure-values (closure function)
  "Replace each value and cell in CLOSURE by what FUNCTION returns for it. Return CLOSURE."
  (declare (type function function))
  (if (compiled-closure-p closure)
      (let ((count 0))
        (declare (type fixnum count))
        (internal (:sb-kernel #:do-closure-values) (value closure)
          (declare (ignorable value))
          (incf count))
        (dotimes (index count)
          (internal (:sb-kernel #:%closure-index-set)
                    closure index
                    (funcall function (internal (:sb-kernel #:%closure-index-ref) closure index)))))
      (setf (interpreted-environment closure)
            (funcall function (interpreted-environment closure))))
  closure)

(declaim (inline value-cell-p))
(defun value-cell-p (object)
  "True if OBJECT is a cell: the place of a closed-over variable that is assigned to."
  (and (internal (:sb-kernel #:%other-pointer-p) object)
       (= (internal-value :sb-vm #:value-cell-widetag)
          (internal (:sb-kernel #:%other-pointer-widetag) object))))

(defun cell-value (cell)
  "Return the value of the closed-over variable whose place is CELL. Can be set."
  (internal (:sb-kernel #:value-cell-ref) cell))

(defun (setf cell-value) (value cell)
  (internal (:sb-kernel #:value-cell-set) cell value))

(defun exit-cell-p (cell)
  "True if CELL belongs to a block or tag to which a closure can still exit. Such a cell holds a
stack address: an integer too large for other uses."
  (typep (cell-value cell) '(integer #.(ash #x700000000000 -1) #.(ash #x7FFFFFFFFFFF -1))))

(defun make-value-cell (value)
  "Return a new cell for a closed-over variable with VALUE."
  (internal (:sb-kernel #:make-value-cell) value))
