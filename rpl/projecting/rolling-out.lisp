;;;; rolling-out.lisp -- a trial of a plan, in a fork of its run or in a world believed in.

(in-package :ars-magna.rpl-projecting)

;;; A run is forked once for a question: that fork, the moment, never goes on. Each rollout is a
;;; fork of it with a seed of its own; so all begin alike, also if the run goes on meanwhile, and
;;; any of them can be looked at again.

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

(defun lighten (moment)
  "Let MOMENT, a fork, keep no journal and no trace of plans, and tell nobody of errors. Return it."
  (setf (simulation-journal moment) nil
        (message-queue-error-policy (simulation-messages moment)) :collect)
  (dolist (participant (simulation-participants moment))
    (when (interface-p participant) (stop-trace (interface-runner participant))))
  moment)

;;; The rollout.

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
    (cond ((question-subject question))
          ((null task)
           (begin-in interface (question-plan question) (question-arguments question) #'identity))
          ((and (question-branches question) (not (eq :branch (option question :until))))
           (task-top task)))))

(defun nothing-known (question)
  "Return the projection without rollouts that PROJECT returns for QUESTION in a rollout."
  (make-projection (text-of question) (simulation-tick) (option question :horizon) '()))

(defun roll-out-in-fork (scene trial seed then)
  (let ((fork (fork-simulation (scene-moment scene) :seed seed)))
    (unwind-protect
         (call-in-fork
          fork
          (lambda ()
            (let* ((original (scene-question scene))
                   (interface (interface-of (interface-robot (wish-interface original)) fork))
                   (question (find (question-token original)
                                   (remove-if-not #'question-p (interface-wishes interface))
                                   :key #'question-token)))
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
                     (let ((*fork-asker* (question-operator question)))
                       (if (scene-moment scene)
                           (roll-out-in-fork scene trial seed then)
                           (roll-out-in-belief scene trial seed then))))
                   (or print (option question :print)))))
