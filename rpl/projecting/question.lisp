;;;; question.lisp -- what is to be found out by rollouts, and the answer.

(in-package :ars-magna.rpl-projecting)

;;; A question is a wish of an interface: so it is copied with the plans, and in a fork its twin
;;; tells which task waits for the answer, and with which arguments. Twins have the same TOKEN.

(defstruct (question (:include wish) (:constructor %make-question) (:copier nil))
  "A question that rollouts answer: which of the texts BRANCHES is best for the rest of the plan;
how PLAN, called with ARGUMENTS, may end; or how the task SUBJECT may end. OPERATOR asks. In a
rollout, ENDED and RESULT say how the branch or plan on trial has ended."
  (token (gensym "QUESTION") :type symbol :read-only t)
  (operator nil :type symbol :read-only t)
  ;; Of a question that is asked outside of plans.
  (driver nil :read-only t)
  (robot nil :read-only t)
  (branches '() :type list :read-only t)
  (plan nil :read-only t)
  (arguments '() :type list :read-only t)
  (subject nil :type (or null task) :read-only t)
  (options '() :type list :read-only t)
  (ended nil :type (or null keyword))
  (result nil))

(defvar *rolling-out* nil
  "True while this thread runs a rollout: TRY-BEST is random then, and PROJECT makes no rollouts.")

(defvar *current-question* nil
  "The question of a plan for which this thread runs rollouts, or NIL.")

(defun question-option (question key)
  (getf (question-options question) key))

(defmethod awaited-text ((question question))
  (format nil "~:[a projection of ~A~;the best of ~A branches~]"
          (question-branches question)
          (if (question-branches question)
              (length (question-branches question))
              (cut (question-text question) 60))))

(defun question-text (question &optional (branch 0))
  "Return the full text of the plan, the task or the branch number BRANCH that QUESTION is about."
  (cond ((question-branches question) (nth branch (question-branches question)))
        ((question-subject question) (task-label (question-subject question) #'whole-form-text))
        (t (let ((plan (question-plan question)))
             (whole-form-text
              (append (list (or (if (procedure-p plan) (procedure-name plan) plan)
                                'interp-lambda))
                      (question-arguments question)
                      (and (question-robot question)
                           (list :robot (name-of-robot (question-robot question))))))))))

(defun name-of-robot (robot)
  "Return the name of ROBOT, a robot or its name."
  (if (robot-p robot) (robot-name robot) robot))

(defun note-question-end (question state result)
  "Record, in a rollout, that the branch or plan tried by QUESTION has ended in STATE with RESULT."
  (when question
    (setf (question-ended question) state
          (question-result question) result)))

(defun note-ending-signal (question signal)
  "Record, in a rollout, that SIGNAL has ended QUESTION's trial. RETURN-FROM counts as success."
  (cond ((typep signal 'plan-failure) (note-question-end question :failed signal))
        ((escape-p signal) (note-question-end question :succeeded nil))
        ((eq signal :evaporate) (note-question-end question :evaporated nil))))

;;; Options.

(defparameter *default-trials* 20
  "The default number of rollouts in a projection.")
(defparameter *default-horizon* 600
  "The default number of ticks after which a rollout is abandoned.")

(defun check-option (operator name value)
  "Signal WRONG-ARGUMENT unless VALUE is valid for the option NAME of OPERATOR."
  (flet ((check (good-p expected)
           (unless good-p (reject-argument operator name value expected))))
    (ecase name
      (:trials (check (whole-p value 1 100000) "how many rollouts, from 1 to 100000"))
      (:horizon (check (whole-p value 1) "how many ticks, from 1 to 1e9"))
      (:seed (check (integerp value) "an integer"))
      (:until (check (member value '(:plan :branch)) ":plan or :branch"))
      ((:cost :tell :world) (check (function-designator-p value) "a function"))
      (:measure (check (parse-measure value)
                       (format nil "the name of a measure, or a list (name :over summary), with ~
                                    the summary ~A" (summary-text)))
       (find-measure (parse-measure value)))
      (:print))))

(defun checked-options (operator options)
  "Return the plist OPTIONS of OPERATOR, without options that are NIL, and with defaults for :TRIALS
and :HORIZON. Values may be fluents. Signals WRONG-ARGUMENT."
  (let ((given (loop for (name value) on options by #'cddr
                     for known = (fluent-value value)
                     when known
                       append (progn (check-option operator name known) (list name known)))))
    (append given (list :trials *default-trials* :horizon *default-horizon*))))

;;; Seeds. The same trial of all branches has the same one.

(defun hash-numbers (&rest numbers)
  "Return a hash code of NUMBERS, integers: an integer from 0 to 2^62 - 1."
  (let ((digest (make-digest)))
    (digest-add digest numbers)
    (ldb (byte 62 0) (digest-value digest))))

(defun seed-of-trial (question trial)
  "Return the seed of rollout number TRIAL of QUESTION. The seed comes from the option :SEED or else
from the run's seed, the tick, and the number of earlier questions in that tick."
  (let* ((interface (wish-interface question))
         (simulation (if interface (interface-simulation interface) *simulation*))
         (seed (question-option question :seed)))
    (cond (seed (hash-numbers seed trial))
          ((null simulation) (hash-numbers 0 trial))
          (t (hash-numbers (simulation-seed simulation)
                           (simulation-tick simulation)
                           (if (wish-task question) (served-wish-count interface) -1)
                           trial)))))

;;;; Answers

(defun charge-for-rollouts (projections question)
  "Charge steps in rollouts of PROJECTIONS to the plans that ask QUESTION, if steps have a budget."
  (count-steps (loop for projection in projections
                     sum (reduce #'+ (projection-rollouts projection) :key #'rollout-steps))
               (task-agent (wish-task question))
               (wish-task question)))

(defun project-branch (question moment branch)
  "Return a projection of branch number BRANCH of QUESTION, by rollouts from MOMENT."
  (let ((scene (make-rollout-start question moment branch)))
    (make-projection (question-text question branch)
                     (if moment (simulation-tick moment) 0)
                     (question-option question :horizon)
                     (loop for trial from 1 to (question-option question :trials)
                           collect (roll-out scene trial (seed-of-trial question trial))))))

(defun code-of-option (option)
  (if (eq option :measure) "the measure" (format nil "the function ~S" option)))

(defun report-function-errors (question projections)
  "Report in one message in how many rollouts QUESTION's functions failed, and the first error."
  (let* ((rollouts (mapcan (lambda (projection) (copy-list (projection-rollouts projection)))
                           projections))
         (broken (remove-if-not #'rollout-broken rollouts)))
    (when broken
      (report-user-error (rollout-error (first broken))
                         (format nil "~A of ~A, in ~D of ~D rollouts; the first error"
                                 (code-of-option (rollout-broken (first broken)))
                                 (question-operator question)
                                 (length broken) (length rollouts))))))

(defun project-branches (question moment)
  (let ((projections (loop for branch below (max 1 (length (question-branches question)))
                           collect (project-branch question moment branch))))
    (report-function-errors question projections)
    projections))

;;; Questions of plans.

(defun answer-by-chance (question)
  "Answer QUESTION inside of a rollout: by a random branch, or by a projection without rollouts."
  (grant-wish question
              (if (question-branches question)
                  (roll-index (length (question-branches question))
                              (agent-dice (task-agent (wish-task question))))
                  (projection-without-rollouts question))))

(defun answer-by-rollouts (question)
  "Answer QUESTION, asked by a plan, by rollouts. Return :LATER if the answer is no longer needed."
  (let* ((interface (wish-interface question))
         (moment (and (null (question-option question :world))
                      (let ((*fork-operator* (question-operator question)))
                        (disable-recording (fork-resting-simulation interface)))))
         (projections (catch 'abandoned
                        (let ((*current-question* question)) (project-branches question moment)))))
    (cond ((null projections) :later)
          (t (charge-for-rollouts projections question)
             (if (question-branches question)
                 (let ((best (index-of-best projections)))
                   (when (question-option question :tell)
                     (call-user-code (question-option question :tell)
                                     "the function :TELL of a TRY-BEST"
                                     projections best))
                   (grant-wish question best))
                 (grant-wish question (first projections)))))))

(defmethod serve-wish ((question question))
  (if *rolling-out*
      (answer-by-chance question)
      (answer-by-rollouts question)))
