;;;; remembering.lisp -- what was given to a run from outside, remembered as it was then.

(in-package :ars-magna.run)

;;; Whoever has given a plan a list or a structure, or a fluent a value, may change that later; so
;;; may the plan. What is remembered of it is therefore a copy, and what is done again with it has a
;;; copy of that. Objects of a run in it are named, as in a journal, to be found in another run. A
;;; function is copied with what it has closed over: what SCHEDULE is to do acts on the run in which
;;; it happens.

(defstruct (named (:constructor make-named (reference)) (:copier nil))
  "Stands for the object of a run that REFERENCE, which EXTERNALIZE has returned, names."
  (reference nil :type list :read-only t))

(defun name-object (object)
  "Return what stands for OBJECT, of which no copy is to be made, in what is remembered."
  (cond ((nameable-p object)
         (let ((reference (externalize object)))
           (if (eq reference object) object (make-named reference))))
        ((null *simulation*) object)
        ((eq object *simulation*) (make-named '(:the :simulation)))
        ((eq object (simulation-world *simulation*)) (make-named '(:the :world)))
        (t object)))

(defun memorized (arguments)
  "Return the list ARGUMENTS, to be remembered as they are now. See RECALLED."
  (copy-values arguments #'name-object))

(defun recalled (arguments simulation)
  "Return ARGUMENTS, which MEMORIZED has returned, as they were, for SIMULATION."
  (copy-values arguments (lambda (object)
                           (if (named-p object)
                               (internalize (named-reference object) simulation)
                               object))))

;;; Whether what a fork asks for is what was asked for.

(defun alike-atoms-p (one other)
  "True if ONE and OTHER, no conses, are EQUAL, functions of one code, or of one type and nameless:
each run has its own."
  (or (equal one other)
      (and (functionp one) (functionp other) (same-code-p one other))
      (not (or (typep one '(or number symbol character string function))
               (not (eq (class-of one) (class-of other)))))))

(defun alike-trees-p (one other)
  (loop while (and (consp one) (consp other))
        do (unless (alike-trees-p (pop one) (pop other)) (return-from alike-trees-p nil)))
  (alike-atoms-p one other))

(defun alike-p (one other)
  "True if ONE and OTHER, externalized or memorized, may be the same for two runs."
  (and (tree-p one) (tree-p other) (alike-trees-p one other)))

(define-shared named)
