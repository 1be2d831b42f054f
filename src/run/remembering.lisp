;;;; remembering.lisp -- what was given to a run from outside, remembered as it was then.

(in-package :ars-magna.run)

;;; Whoever has given a plan a list or a structure, or a fluent a value, may change that later; so
;;; may the plan. What is remembered of it is therefore a copy, and what is done again with it has a
;;; copy of that. Objects of a run in it are named, as in a journal, to be found in another run.

(defstruct (named (:constructor make-named (reference)) (:copier nil))
  "Stands for the object of a run that REFERENCE, which EXTERNALIZE has returned, names."
  (reference nil :type list :read-only t))

(defun name-object (object)
  "Return what stands for OBJECT, of which no copy is to be made, in what is remembered."
  (if (nameable-p object)
      (let ((reference (externalize object)))
        (if (eq reference object) object (make-named reference)))
      object))

(defun memorized (arguments)
  "Return the list ARGUMENTS, to be remembered as they are now. See RECALLED."
  (copy-values arguments #'name-object))

(defun recalled (arguments simulation)
  "Return ARGUMENTS, which MEMORIZED has returned, as they were, for SIMULATION."
  (copy-values arguments (lambda (object)
                           (if (named-p object)
                               (internalize (named-reference object) simulation)
                               object))))

(define-shared named)
