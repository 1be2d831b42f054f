;;;; achieving.lisp -- achieve, perceive, belief: working for goals.

(in-package :ars-magna.rpl.constructs)

(addition goal-failure)
(define-condition goal-failure (plan-failure)
  ((operator :initarg :operator :initform nil :reader failed-goal-operator)
   (goal :initarg :goal :initform nil :reader failed-goal))
  (:documentation "A plan could not reach a goal."))

(addition unknown-goal)
(define-condition unknown-goal (goal-failure)
  ((known :initarg :known :initform '() :reader unknown-goal-known))
  (:documentation "No DEF-GOAL matches the goal."))

(addition goal-not-achieved)
(define-condition goal-not-achieved (goal-failure)
  ()
  (:documentation "The plan for a goal has ended, but the goal is not believed."))

(addition failed-goal failed-goal-operator unknown-goal-known)
(setf (documentation 'failed-goal 'function)
      "Return the goal that failed, such as (on a b)."
      (documentation 'failed-goal-operator 'function)
      "Return the operator of the goal that failed, ACHIEVE, PERCEIVE or BELIEF."
      (documentation 'unknown-goal-known 'function)
      "Return a list of the patterns of all goals that are defined for the operator.")

(defmethod write-failure ((failure unknown-goal) stream)
  (format stream "No def-goal matches (~A). ~:[There is none for ~A~;Known: ~:*~{~A~^, ~}~*~]"
          (goal-text (failed-goal-operator failure) (failed-goal failure))
          (mapcar #'pattern-text (unknown-goal-known failure))
          (plain-name (failed-goal-operator failure))))

(defmethod write-failure ((failure goal-not-achieved) stream)
  (format stream "(~A) has ended, but the goal is not believed"
          (goal-text (failed-goal-operator failure) (failed-goal failure))))

;;; Running. A frame of one of these remembers a goal-run.

(defstruct (goal-run (:constructor make-goal-run (operator goal)) (:copier nil))
  "One execution of OPERATOR for GOAL, such as (on a b). VALUE is the result."
  (operator nil :type symbol :read-only t)
  (goal nil :read-only t)
  (value nil))

(defun goal-run-form (goal-run)
  (list (goal-run-operator goal-run) (goal-run-goal goal-run)))

(defun fail-goal (class task frame &rest arguments)
  (let ((goal-run (frame-data frame)))
    (unwind task frame
            (failure-of (apply #'make-condition class
                               :operator (goal-run-operator goal-run) :goal (goal-run-goal goal-run)
                               arguments)
                        task frame))))

(defun enter-goal (goal values frame)
  (enter-application (goal-procedure goal) values frame))

(defun run-goal (task frame)
  (let ((goal-run (frame-data frame)))
    (multiple-value-bind (goal values)
        (choose-goal (goal-run-operator goal-run) (goal-run-goal goal-run))
      (if goal
          (enter-goal goal values frame)
          (fail-goal 'unknown-goal task frame
                     :known (mapcar #'goal-pattern
                                    (operator-goals (goal-run-operator goal-run))))))))

(defun ask-belief (frame otherwise)
  "Begin the plan that finds out whether the goal of FRAME is believed. If no plan does so, continue
with the value OTHERWISE. Return what a step returns."
  (multiple-value-bind (goal values) (choose-goal 'belief (goal-run-goal (frame-data frame)))
    (if goal
        (enter-goal goal values frame)
        (values frame otherwise))))

(define-construct achieve (goal)
  "Make the robot believe GOAL, in a plan. GOAL is evaluated, such as `(on ,a ,b).
If the matching DEF-GOAL of BELIEF says that GOAL is believed already, return that value and do
nothing. If not, run the matching DEF-GOAL of ACHIEVE and return its value. Fails with UNKNOWN-GOAL
if no ACHIEVE matches, and with GOAL-NOT-ACHIEVED if GOAL is not believed afterwards. If no BELIEF
matches, ACHIEVE succeeds when the plan succeeds. (From CRAM and XFRM.)"
  (:arguments goal)
  (:parts (goal function (value-lambda goal scope)))
  (:steps
   (begin
    (setf memory (make-goal-run 'achieve (funcall goal environment)))
    (next asked)
    (ask-belief frame nil))
   (asked
    (cond ((fluent-value (single-value value)) (values (frame-up frame) value))
          (t (next done)
             (run-goal task frame))))
   (done
    (setf (goal-run-value memory) value)
    (next checked)
    (ask-belief frame t))
   (checked
    (if (fluent-value (single-value value))
        (values (frame-up frame) (goal-run-value memory))
        (fail-goal 'goal-not-achieved task frame)))))

(define-construct perceive (goal)
  "Find out whether GOAL holds, in a plan, by the matching DEF-GOAL of PERCEIVE. The plan of
PERCEIVE should not change the world. GOAL is evaluated, such as `(on ,a ,b). Return whether GOAL is
believed afterwards, by the matching DEF-GOAL of BELIEF. If no BELIEF matches, return the value of
the plan of PERCEIVE. Fails with UNKNOWN-GOAL if no PERCEIVE matches. Also fails if the plan of
PERCEIVE fails. (From CRAM and XFRM, except for the return value.)"
  (:like achieve)
  (:steps
   (begin
    (setf memory (make-goal-run 'perceive (funcall goal environment)))
    (next seen)
    (run-goal task frame))
   (seen
    (next checked)
    (ask-belief frame value))
   (checked (values (frame-up frame) value))))

(define-construct belief (goal)
  "Return whether the robot believes GOAL, in a plan: the value of the matching DEF-GOAL of BELIEF.
The plan of BELIEF should not change the world. GOAL is evaluated, such as `(on ,a ,b). Fails with
UNKNOWN-GOAL if no BELIEF matches. (From XFRM, except for the syntax.)"
  (:like achieve)
  (:steps
   (begin
    (setf memory (make-goal-run 'belief (funcall goal environment)))
    (next answered)
    (run-goal task frame))
   (answered (values (frame-up frame) value))))

;;; Looking.

(macrolet ((define-current-forms (&rest nodes)
             `(progn
                ,@(loop for node in nodes
                        collect `(defmethod current-form ((node ,node) frame)
                                   (if (frame-data frame)
                                       (goal-run-form (frame-data frame))
                                       (node-form node)))))))
  (define-current-forms achieve-node perceive-node belief-node))

(addition goals-under-way)
(defun goals-under-way (&optional (task (current-task)))
  "Return a list of the goals, such as (achieve (on a b)), of TASK (default: the calling task),
innermost first. Each goal serves the goal after it. The goals of the tasks around TASK come last."
  (mapcar #'goal-run-form
          (remove-if-not #'goal-run-p (mapcar #'frame-data (and task (frames-around task))))))
