;;;; steps.lisp -- which functions carry operations on: those that GO-ON is told of.

(in-package :ars-magna.command)

;;; An operation has the name of a function that carries it on. A file that says how far a command
;;; is may name what is a step, and no other function. What GO-ON is told of in a program's text is
;;; a step from when that is loaded.

(defun note-step (step)
  "Let the function called STEP be one that carries an operation on. Return STEP."
  (setf (get step 'step) t)
  step)

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
