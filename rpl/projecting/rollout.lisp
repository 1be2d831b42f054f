;;;; rollout.lisp -- what came of one trial of a plan, in a fork or in a world believed in.

(in-package :ars-magna.rpl-projecting)

(defstruct (scene (:constructor make-scene (question moment branch)) (:copier nil))
  "Where rollouts begin: in forks of MOMENT, a fork itself, in which the twin of QUESTION waits for
its answer, by taking its BRANCH, a number; or, without a MOMENT, in a world believed in."
  (question nil :read-only t)
  (moment nil :read-only t)
  (branch 0 :type fixnum :read-only t))

(addition rollout-p rollout-seed rollout-state rollout-ticks rollout-cost)
(defstruct (rollout (:constructor make-rollout
                        (scene trial seed state result ticks cost steps ways &optional broken))
                    (:copier nil))
  "One trial, number TRIAL, of what a projection is about. RESULT is a value or a failure, STEPS how
many steps of plans count, WAYS where robots went. BROKEN is the option, :COST or :WORLD, of whose
function the failure is an error."
  (scene nil :type scene :read-only t)
  (trial 0 :type fixnum :read-only t)
  (seed 0 :type integer :read-only t)
  (state :limit :type keyword :read-only t)
  (result nil :read-only t)
  (ticks 0 :type real :read-only t)
  (cost nil :type (or null real) :read-only t)
  (steps 0 :type integer :read-only t)
  (ways '() :type list :read-only t)
  (broken nil :type (or null keyword) :read-only t))

(document-functions
  rollout-p "True of rollouts: trials of a plan that a projection has made."
  rollout-seed "Return the integer from which all chance in the rollout came."
  rollout-state "Return how the rollout ended: :succeeded, :failed, :evaporated, :deadlock,
:stopped; :limit, if its horizon came first; or :runaway, if plans took a million steps in a tick
without waiting."
  rollout-ticks "Return how many ticks the rollout took."
  rollout-cost "Return the number that the function :cost returned at the end, or NIL without one.")

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
