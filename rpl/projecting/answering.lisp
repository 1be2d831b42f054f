;;;; answering.lisp -- the answer to a question: its projections, and what follows.

(in-package :ars-magna.rpl-projecting)

(defun charge-for-rollouts (projections question)
  "Let the plans that ask QUESTION, where their steps have a budget, pay for those of PROJECTIONS."
  (count-steps (loop for projection in projections
                     sum (reduce #'+ (projection-rollouts projection) :key #'rollout-steps))
               (interface-runner (wish-interface question))
               (wish-task question)))

(defun project-branch (question moment branch)
  "Return the projection of BRANCH of QUESTION by rollouts from MOMENT, see SCENE."
  (let ((scene (make-scene question moment branch)))
    (make-projection (text-of question branch)
                     (if moment (simulation-tick moment) 0)
                     (option question :horizon)
                     (loop for trial from 1 to (option question :trials)
                           collect (roll-out scene trial (seed-of-trial question trial))))))

(defun tell-of-errors (question projections)
  "Say once, if functions that QUESTION gives have broken off rollouts of PROJECTIONS, in how many
they did, and why the first time."
  (let* ((rollouts (mapcan (lambda (projection) (copy-list (projection-rollouts projection)))
                           projections))
         (broken (remove-if-not #'rollout-broken rollouts)))
    (when broken
      (report-user-error (error-of (first broken))
                         (format nil "the function ~S of ~A, in ~D of ~D rollouts; the first time"
                                 (rollout-broken (first broken)) (question-operator question)
                                 (length broken) (length rollouts))))))

(defun project-branches (question moment)
  "Return a list of projections, one for each branch of QUESTION, or of the one that there is."
  (let ((projections (loop for branch below (max 1 (length (question-branches question)))
                           collect (project-branch question moment branch))))
    (tell-of-errors question projections)
    projections))

;;; Questions of plans.

(defun answer-by-chance (question)
  "Answer QUESTION, in a rollout: by any branch, or a projection that knows nothing."
  (grant-wish question
              (if (question-branches question)
                  (roll-index (length (question-branches question))
                              (runner-dice (interface-runner (wish-interface question))))
                  (nothing-known question))))

(defun answer-by-rollouts (question)
  "Answer QUESTION, of a plan, by what rollouts tell. Return :LATER if nobody wants that any more."
  (let* ((interface (wish-interface question))
         (moment (and (null (option question :world))
                      (let ((*fork-asker* (question-operator question)))
                        (lighten (fork-at-rest interface)))))
         (projections (catch 'abandoned
                        (let ((*asked* question)) (project-branches question moment)))))
    (cond ((null projections) :later)
          (t (charge-for-rollouts projections question)
             (if (question-branches question)
                 (let ((best (best-of projections)))
                   (when (option question :tell)
                     (call-user-code (option question :tell) "the function :TELL of a TRY-BEST"
                                     projections best))
                   (grant-wish question best))
                 (grant-wish question (first projections)))))))

(defmethod serve-wish ((question question))
  (if *rolling-out*
      (answer-by-chance question)
      (answer-by-rollouts question)))
