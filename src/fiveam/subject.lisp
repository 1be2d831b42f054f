;;;; subject.lisp -- a form that is tried, with all that its trials go by.

(in-package :ars-magna.fiveam)

(defstruct (subject (:constructor make-subject
                        (function form package robots parameters clean limit))
                    (:copier nil))
  "FUNCTION, made of FORM, which somebody wrote in PACKAGE, is tried with ROBOTS under PARAMETERS,
lists (name value), without noise if CLEAN is true, for LIMIT ticks."
  (function nil :read-only t)
  (form nil :read-only t)
  (package nil :type package :read-only t)
  (robots '() :type list :read-only t)
  (parameters '() :read-only t)
  (clean nil :read-only t)
  (limit 0 :read-only t))

(defconstant +usual-limit+ 100000 "For how many ticks a trial may go on unless its author says.")

;;; Its trials, as those of an experiment.

(defun parameter-parts (parameters operator)
  "Return PARAMETERS, lists (name value) that OPERATOR was given, as EXPERIMENT-FROM takes them."
  (unless (and (proper-list-p parameters)
               (every (lambda (part) (and (proper-list-p part) (= 2 (length part)))) parameters))
    (reject-argument operator 'parameters parameters "lists (name value)"))
  (loop for (name value) in parameters
        for symbol = (parameter-symbol (find-parameter name))
        collect (list (list symbol value) value)))

(defun experiment-of (subject operator seed)
  "Return an experiment of SUBJECT's trials from SEED on. OPERATOR is who wants it."
  (let ((limit (subject-limit subject)))
    (unless (integerp seed) (reject-argument operator 'seed seed "an integer"))
    (unless (whole-p limit 1)
      (reject-argument operator 'limit limit "a number of ticks from 1 to 1e9"))
    (let ((experiment (experiment-from operator (string-downcase operator)
                                       :robots (subject-robots subject)
                                       :run (subject-function subject)
                                       :seed seed :limit limit
                                       :parameters (parameter-parts (subject-parameters subject)
                                                                    operator)
                                       :clean (subject-clean subject))))
      (setf (experiment-package experiment) (subject-package subject))
      experiment)))

;;; From what its author wrote.

(defun robot-names (operator robots form)
  "Return the names in ROBOTS, a name or a list. Signals MALFORMED-DEFINITION if there is none."
  (let ((names (ensure-list (if (and (consp robots) (eq 'quote (first robots)))
                                (second robots)
                                robots))))
    (unless (and (proper-list-p names) names (every #'symbolp names))
      (reject-clause operator form
                     "an option :robots, with the name of a robot or a list of names of one map"))
    names))

(defun parameters-form (operator parameters)
  "Return a form for the lists (name value) that PARAMETERS mean: lists (name form), or a form."
  (if (and (consp parameters) (consp (first parameters)))
      `(list ,@(loop for part in parameters
                     do (unless (and (proper-list-p part) (= 2 (length part))
                                     (symbolp (first part)))
                          (reject-clause operator part
                                         "(parameter form), as in :parameters ((max-speed* 2))"))
                     collect `(list ',(first part) ,(second part))))
      parameters))

(defun subject-maker (operator form robots parameters clean limit)
  "Return a form for the subject that OPERATOR, a macro of this name, was given in these."
  (doubt-nested-run form)
  (let ((names (robot-names operator robots form)))
    `(make-subject (lambda ()
                     (declare (special ,@(variables-among names)))
                     ,form)
                   ',form (find-package ,(package-name *package*)) ',names
                   ,(parameters-form operator parameters) ,clean ,limit)))
