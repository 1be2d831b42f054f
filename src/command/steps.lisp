;;;; steps.lisp -- which functions carry operations on: those that GO-ON is told of.

(in-package :ars-magna.command)

;;; An operation has the name of a function that carries it on. A file that says how far a command
;;; is may name what is a step, and no other function. What GO-ON is told of in a program's text is
;;; a step from when that is loaded.

(defmacro define-step (name (operation &optional (resource t) (subject t) &rest arguments)
                       &body body)
  "Define the function NAME of OPERATION, a step of commands. RESOURCE and SUBJECT are types of what
OPERATION has as such, ARGUMENTS of its first arguments: a saved run in which they are others is
refused."
  `(progn
     (setf (get ',name 'step) '(,resource ,subject ,@arguments))
     (defun ,name (,operation) ,@body)))

(defun note-step (step)
  "Let the function called STEP be one that carries an operation on, if it is not yet. Return STEP."
  (unless (get step 'step)
    (setf (get step 'step) '(t t)))
  step)

(defun step-suits-p (step resource subject arguments)
  "True if RESOURCE, SUBJECT and ARGUMENTS of an operation are such as STEP needs."
  (destructuring-bind (resource-type subject-type &rest types) (get step 'step)
    (and (typep resource resource-type)
         (typep subject subject-type)
         (<= (length types) (length arguments))
         (every #'typep arguments types))))

(defun step-p (name)
  "True if the symbol NAME is that of a function which carries operations on."
  (and (get name 'step) (fboundp name) t))

(defun noting-step (form)
  "Return FORM, a call with a step as its second argument, such that a quoted one is noted when what
it stands in is loaded."
  (destructuring-bind (function operation step &rest more) form
    (if (typep step '(cons (eql quote) (cons (and symbol (not null)) null)))
        `(,function ,operation (load-time-value (note-step ,step)) ,@more)
        form)))

(define-compiler-macro go-on (&whole form &rest arguments)
  (if (and (eq 'go-on (first form)) (rest arguments)) (noting-step form) form))

(define-compiler-macro go-on-now (&whole form &rest arguments)
  (if (and (eq 'go-on-now (first form)) (rest arguments)) (noting-step form) form))
