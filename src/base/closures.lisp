;;;; closures.lisp -- what functions have closed over.

(in-package :ars-magna.base)

;;; A closure is code and values. A variable that is closed over and assigned to is a CELL, which
;;; all closures over it share.

;;; A function that is interpreted, as those of plans that programs make are, has its variables in
;;; an ENVIRONMENT of the interpreter's, which all functions made there share.

(defun environment-p (object)
  "True if OBJECT is an environment of the interpreter's."
  (env-p object))

(defun fixed-slot-p (name)
  "True unless what is in the slot NAME of environments belongs to those who have them."
  (not (member name '("PARENT" "VARS" "FUNS") :test #'string=)))

(defun environment-values (environment)
  "Return a list of the values of the variables, and of the functions, in ENVIRONMENT and around."
  (loop for each = environment then (env-parent each)
        while each
        append (mapcar #'cdr (env-vars each))
        append (mapcar #'cdr (env-funs each))))

(defun interpreted-closure-p (object)
  (and (typep object 'sb-kernel:interpreted-function)
       (environment-values (interpreted-function-env object))
       t))

(declaim (inline closure-p))
(defun closure-p (object)
  "True if OBJECT is a function that has closed over something."
  (or (sb-kernel:closurep object)
      (and (sb-kernel:funcallable-instance-p object) (interpreted-closure-p object))))

(defun closure-values (closure)
  "Return a list of what CLOSURE has closed over."
  (if (sb-kernel:closurep closure)
      (sb-kernel:%closure-values closure)
      (list (interpreted-function-env closure))))

(define-global +closure-copier+
    (symbol-function (find-symbol "COPY-CLOSURE" "SB-IMPL"))
  "The function that copies a closure.")

(defun copy-closure (closure)
  "Return a new closure of the same code over the same values and cells."
  (if (sb-kernel:closurep closure)
      (funcall (the function +closure-copier+) closure)
      (make-interpreted-function
       :name (interpreted-function-name closure)
       :lambda-list (interpreted-function-lambda-list closure)
       :env (interpreted-function-env closure)
       :declarations (interpreted-function-declarations closure)
       :documentation (interpreted-function-documentation closure)
       :body (interpreted-function-body closure)
       :source-location (interpreted-function-source-location closure))))

(defun replace-closure-values (closure function)
  "Let CLOSURE have closed over what FUNCTION returns for each value and cell."
  (declare (type function function))
  (if (sb-kernel:closurep closure)
      (let ((count 0))
        (declare (type fixnum count))
        (sb-kernel:do-closure-values (value closure)
          (declare (ignorable value))
          (incf count))
        (dotimes (index count)
          (sb-kernel:%closure-index-set
           closure index (funcall function (sb-kernel:%closure-index-ref closure index)))))
      (setf (interpreted-function-env closure)
            (funcall function (interpreted-function-env closure))))
  closure)

(declaim (inline cell-p))
(defun cell-p (object)
  "True if OBJECT is the cell of a variable."
  (and (sb-kernel:%other-pointer-p object)
       (= sb-vm:value-cell-widetag (sb-kernel:%other-pointer-widetag object))))

(defun cell-value (cell)
  "Return the value of the variable of CELL. Can be set."
  (sb-kernel:value-cell-ref cell))

(defun (setf cell-value) (value cell)
  (sb-kernel:value-cell-set cell value))

(defun exit-cell-p (cell)
  "True if CELL belongs to a block or tag that closures exit to, and that has not been left. It
holds a place on the stack, which looks like an integer that nobody would use."
  (typep (sb-kernel:value-cell-ref cell) '(integer #.(ash #x700000000000 -1)
                                                   #.(ash #x7FFFFFFFFFFF -1))))

(defun make-cell (value)
  "Return a new cell for a variable with VALUE."
  (sb-kernel:make-value-cell value))
