;;;; rolling-out.lisp -- a trial of a plan in a fork of its run.

(in-package :ars-magna.rpl-projecting)

;;; A run is forked once for a question: that fork, the moment, never goes on. Each rollout is a
;;; fork of it with a seed of its own; so all begin alike, also if the run goes on meanwhile, and
;;; any of them can be looked at again.

(defvar *rolling-out* nil
  "True where a rollout runs: there TRY-BEST chooses by chance, and PROJECT knows nothing.")

(defun call-in-peace (function print)
  "Call FUNCTION, which runs a rollout: no plan is at work around it, and nobody is to answer. What
it writes is lost unless PRINT is true."
  (let ((*rolling-out* t)
        (*standard-output* (if print *standard-output* (make-broadcast-stream)))
        (*error-output* (if print *error-output* (make-broadcast-stream)))
        (*break-on-user-error* nil)
        (*break-on-plan-failures* nil)
        (*step-plans* nil)
        (*trace-plans* nil))
    (call-apart function)))

;;; The moment.

(defun twin-in (fork interface)
  "Return what INTERFACE is in FORK."
  (let ((name (robot-name (interface-robot interface))))
    (find-if (lambda (participant)
               (and (interface-p participant)
                    (eq name (robot-name (interface-robot participant)))))
             (simulation-participants fork))))

(defun lighten (moment)
  "Let MOMENT, a fork, keep no journal and no trace of plans. Return it."
  (setf (simulation-journal moment) nil)
  (dolist (participant (simulation-participants moment))
    (when (interface-p participant) (stop-trace (interface-runner participant))))
  moment)

(defun twin-question (question interface)
  "Return what QUESTION is for INTERFACE, of a fork."
  (find-if (lambda (wish)
             (and (question-p wish) (eq (question-token question) (question-token wish))))
           (interface-wishes interface)))

;;; The rollout.

(defun whose-end-counts (question)
  "Return the task whose end is that of a rollout for QUESTION, a twin; NIL if it is what the asking
task does next."
  (cond ((question-subject question))
        ((and (question-branches question) (not (eq :branch (option question :until))))
         (task-top (wish-task question)))))

(defun begin-rollout (question branch)
  "Let begin what QUESTION, of a fork, asks about: its BRANCH, if it has such. Return the task whose
end counts, or NIL: see NOTE-ENDED."
  (let ((interface (wish-interface question)) (task (wish-task question)))
    (call-with-plans (lambda ()
                       (cond ((null task) (forget-wish question))
                             ((question-branches question) (grant-wish question branch))
                             ((question-subject question)
                              (grant-wish question (nothing-known question)))
                             (t (grant-wish question :do-it))))
                     interface)
    (if (and (null task) (null (question-subject question)))
        (begin-in interface (question-plan question) (question-arguments question) #'identity)
        (whose-end-counts question))))

(defun nothing-known (question)
  "Return the projection without rollouts that PROJECT returns for QUESTION in a rollout."
  (make-projection (text-of question) (simulation-tick) (option question :horizon) '()))

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
          (reject-argument (operator-of question) :cost cost
                           "a function that returns a number, or positive infinity for the worst"))
        cost))))

(defvar *asked* nil
  "The question of a plan that rollouts are run for, or NIL.")

(defun check-wanted ()
  "Throw to ABANDONED if the plan whose question is to be answered does not wait for that any more."
  (when (and *asked* (unwanted-wish-p *asked*))
    (throw 'abandoned nil)))

(defun broken-off (condition &optional option)
  "Return what a rollout is that CONDITION broke off, an error of the function OPTION or of others:
how it has ended, with which result, at no cost, and OPTION."
  (values :failed (make-condition 'lisp-failure :condition condition) nil option))

(defun with-cost (question how result)
  "Return HOW a rollout for QUESTION has ended, with which RESULT, and at what cost."
  (handler-case (values how result (cost-of question))
    (error (condition) (broken-off condition :cost))))

(defun go-to-end (question interface begin over)
  "Call BEGIN, which returns the task whose end counts or NIL, and let ticks of the current
simulation pass until what QUESTION is about has ended; OVER is called after each. Return how it has
ended, with which result, at what cost, and the option whose function broke it off, if any."
  (handler-case
      (let* ((last (+ (simulation-tick) (option question :horizon)))
             (task (funcall begin))
             (how (pass-until interface
                              (lambda ()
                                (check-wanted)
                                (funcall over)
                                (end-of task question interface))
                              last)))
        (with-cost question how (if task (task-result task) (question-result question))))
    (error (condition) (broken-off condition))))

(defun run-rollout (scene trial seed question interface begin)
  "Return the rollout number TRIAL, with SEED, of SCENE, having run it in the current simulation:
see GO-TO-END."
  (let* ((start (simulation-tick))
         (runner (interface-runner interface))
         (steps (counted-steps runner))
         (trails '()))
    (multiple-value-bind (how result cost broken)
        (go-to-end question interface begin
                   (lambda () (setf trails (note-places (current-simulation) trails))))
      (make-rollout scene trial seed how result (- (simulation-tick) start) cost
                    (- (counted-steps runner) steps)
                    (ways-along trails trial (outcome-word how))
                    broken))))

(defun roll-out-in-fork (scene trial seed then)
  "Return the values of THEN, a function that is called with the rollout number TRIAL, with SEED, of
SCENE, where that has ended in a fork of the scene's moment."
  (let ((fork (fork-simulation (scene-moment scene) :seed seed)))
    (unwind-protect
         (call-in-fork
          fork
          (lambda ()
            (let* ((original (scene-question scene))
                   (interface (twin-in fork (wish-interface original)))
                   (question (twin-question original interface)))
              (funcall then (run-rollout scene trial seed question interface
                                         (lambda ()
                                           (begin-rollout question (scene-branch scene))))))))
      (release-fork fork))))

(defun roll-out (scene trial seed &key (then #'identity) print)
  "Return the rollout number TRIAL, with SEED, of SCENE; or what THEN returns, which is called with
it where it has ended. Nothing happens in any other run. What plans write there is lost unless PRINT
is true, or the option :PRINT of the question."
  (let* ((question (scene-question scene))
         (output *standard-output*) (errors *error-output*)
         (then (lambda (rollout)
                 (let ((*standard-output* output) (*error-output* errors))
                   (funcall then rollout)))))
    (call-in-peace (lambda ()
                     (let ((*fork-asker* (operator-of question)))
                       (if (scene-moment scene)
                           (roll-out-in-fork scene trial seed then)
                           (roll-out-in-belief scene trial seed then))))
                   (or print (option question :print)))))
