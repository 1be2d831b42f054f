;;;; running.lisp -- how a trial of a plan goes on to its end, in whatever run it is.

(in-package :ars-magna.rpl-projecting)

(defvar *rolling-out* nil
  "True where a rollout runs: there TRY-BEST chooses by chance, and PROJECT knows nothing.")

(defun end-of (task question interface)
  "Return how the rollout has ended in which TASK, or else the asking task of QUESTION, is what
counts; NIL if it has not."
  (cond (task (how-over interface task))
        ((question-ended question))
        (t (how-over interface (task-top (wish-task question))))))

(defun cost-p (object)
  "True of real numbers, and of positive infinity, the worst; not of what is no number."
  (typecase object
    (float (or (finite-p object) (positive-infinity-p object)))
    (real t)))

(defun cost-of (question)
  "Return what the function :COST of QUESTION returns, or NIL without one. Signals WRONG-ARGUMENT."
  (let ((function (option question :cost)))
    (when function
      (let ((cost (funcall function)))
        (unless (cost-p cost)
          (reject-argument (question-operator question) :cost cost
                           "a function that returns a number, or positive infinity for the worst"))
        cost))))

(defvar *asked* nil
  "The question of a plan that rollouts are run for, or NIL.")

(defun broken-off (condition &optional option)
  "Return what a rollout is that CONDITION broke off, an error of the function OPTION or of others:
how it has ended, with which result, at no cost, and OPTION."
  (values :failed (make-condition 'lisp-failure :condition condition) nil option))

(defun with-cost (question how result)
  (handler-case (values how result (cost-of question))
    (error (condition) (broken-off condition :cost))))

(defun go-to-end (question interface begin over)
  "Call BEGIN, which returns the task whose end counts or NIL, and let ticks of the current
simulation pass until what QUESTION is about has ended, or OVER, which is called after each, says
how it ends. Return how it has ended, with which result, at what cost, and the option whose function
broke it off, if any."
  (handler-case
      (let* ((last (+ (simulation-tick) (option question :horizon)))
             (task (funcall begin))
             (how (pass-until interface
                              (lambda ()
                                ;; The plan that asked may not wait for that any more.
                                (when (and *asked* (unwanted-wish-p *asked*))
                                  (throw 'abandoned nil))
                                (or (funcall over) (end-of task question interface)))
                              last)))
        (with-cost question how (if task (task-result task) (question-result question))))
    (error (condition) (broken-off condition))))

;;; A plan that never waits would take a million steps in each tick, and bring nothing to light.

(defun runaway-test (runner)
  "Return a function that returns :RUNAWAY if the plans of RUNNER have taken as many steps as a
reaction may, or more, since it was called last, or made."
  (let ((steps (counted-steps runner)))
    (lambda ()
      (let ((before (shiftf steps (counted-steps runner))))
        (when (<= *runaway-limit* (- steps before)) :runaway)))))

(defun run-rollout (scene trial seed question interface begin)
  "Return the rollout number TRIAL, with SEED, of SCENE, having run it in the current simulation:
see GO-TO-END."
  (let* ((start (simulation-tick))
         (runner (interface-runner interface))
         (steps (counted-steps runner))
         (runaway (runaway-test runner))
         (trails '()))
    (multiple-value-bind (how result cost broken)
        (go-to-end question interface begin
                   (lambda ()
                     (setf trails (note-places (current-simulation) trails))
                     (funcall runaway)))
      (make-rollout scene trial seed how result (- (simulation-tick) start) cost
                    (- (counted-steps runner) steps)
                    (ways-along trails trial (outcome-word how))
                    broken))))
