;;;; rollout.lisp -- what came of one trial of a plan, in a fork or in a world believed in.

(in-package :ars-magna.rpl-projecting)

(defstruct (scene (:constructor make-scene (question moment branch)) (:copier nil))
  "Where rollouts begin: in forks of MOMENT, a fork itself, in which the twin of QUESTION waits for
its answer, by taking its BRANCH, a number; or, without a MOMENT, in a world believed in."
  (question nil :read-only t)
  (moment nil :read-only t)
  (branch 0 :type fixnum :read-only t))

(addition rollout-p)
(define-record (rollout (:constructor make-rollout
                            (scene trial seed state result ticks cost steps ways &optional broken)))
  "One trial of what a projection is about."
  (scene nil scene)
  (trial 0 fixnum "the number of the trial")
  (seed 0 integer "the integer from which all chance in the rollout came" :addition)
  (state :limit keyword "how the rollout ended: :succeeded, :failed, :evaporated, :deadlock,
:stopped; :limit, if its horizon came first; or :runaway, if plans took a million steps in a tick
without waiting" :addition)
  (result nil t "a value or a failure")
  (ticks 0 real "how many ticks the rollout took" :addition)
  (cost nil (or null real)
        "the number that the function :cost returned at the end, or NIL without one" :addition)
  (steps 0 integer "how many steps of plans count")
  (ways '() list "where robots went")
  (broken nil (or null keyword)
          "the option, :COST or :WORLD, of whose function the failure is an error, or NIL"))

(define-shared scene rollout)

(addition rollout-succeeded-p)
(defun rollout-succeeded-p (rollout)
  "True if what ROLLOUT tried succeeded within its horizon."
  (eq :succeeded (rollout-state rollout)))

(addition rollout-value)
(defun rollout-value (rollout)
  "Return what was returned in ROLLOUT if it succeeded, or NIL. It may be an object of a run that is
over."
  (and (rollout-succeeded-p rollout) (rollout-result rollout)))

(addition rollout-failure)
(defun rollout-failure (rollout)
  "Return the failure of ROLLOUT if it failed, or NIL."
  (and (eq :failed (rollout-state rollout))
       (rollout-result rollout)))

(defun error-of (rollout)
  (let ((failure (rollout-failure rollout)))
    (and (typep failure 'lisp-failure) (lisp-failure-condition failure))))

(defun reason-of (rollout)
  "Return in a word why ROLLOUT did not succeed: the class of its failure, or its state."
  (let ((failure (rollout-failure rollout)))
    (cond ((null failure) (rollout-state rollout))
          ((failure-class failure))
          (t (type-of failure)))))

(defun outcome-word (state)
  (case state
    (:succeeded "success")
    (:limit "limit")
    (t "failure")))

(defmethod print-object ((rollout rollout) stream)
  (print-unreadable-object (rollout stream :type t)
    (format stream "~D, ~(~A~)~@[: ~A~] after ~A tick~:P, seed ~D" (rollout-trial rollout)
            (rollout-state rollout)
            (and (rollout-failure rollout) (safe-text (reason-of rollout)))
            (rollout-ticks rollout) (rollout-seed rollout))))
