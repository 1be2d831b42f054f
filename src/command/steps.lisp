;;;; steps.lisp -- which functions carry operations on, and what these need.

(in-package :ars-magna.command)

;;; An operation has the name of a function that carries it on, its step. A file that says how far a
;;; command is may name what is a step, and no other function. Our own steps trust what they are
;;; called with, so DEFINE-STEP says what that must be. What GO-ON is told of in a user's program is
;;; a step of users' commands: these are called with care, and check what they get.

(defun note-step (step fits-p)
  "Let the function called STEP carry on each operation that the function FITS-P is true of; those
of users' commands, if it is :GUARDED."
  (setf (get step 'step) fits-p)
  step)

(defmacro define-step (name (operation needs) documentation &body body)
  "Define the function NAME, a step of OPERATION, which runs BODY. It trusts that NEEDS, a form, is
true, such as (robot-p (operation-resource operation)); an operation from a file is refused where
that is false."
  `(progn
     (note-step ',name (lambda (,operation) (declare (ignorable ,operation)) ,needs))
     (defun ,name (,operation) ,documentation ,@body)))

(defun use-step (step)
  "Return STEP, the name of a function that GO-ON is told of. Signals an error if it is one of ours
that DEFINE-STEP has not defined."
  (cond ((get step 'step) step)
        (*marking-p* (error "~S is not defined by DEFINE-STEP" step))
        (t (note-step step :guarded))))

(defun step-p (name)
  "True if the symbol NAME is that of a function which carries operations on."
  (and (get name 'step) (fboundp name) t))

(defun using-step (form)
  "Return FORM, a call with a step as its second argument, such that USE-STEP is told of a quoted
one when what it stands in is loaded."
  (destructuring-bind (function operation step &rest more) form
    (if (typep step '(cons (eql quote) (cons (and symbol (not null)) null)))
        `(,function ,operation (load-time-value (use-step ,step)) ,@more)
        form)))

(define-compiler-macro go-on (&whole form &rest arguments)
  (if (and (eq 'go-on (first form)) (rest arguments)) (using-step form) form))

(define-compiler-macro go-on-now (&whole form &rest arguments)
  (if (and (eq 'go-on-now (first form)) (rest arguments)) (using-step form) form))
