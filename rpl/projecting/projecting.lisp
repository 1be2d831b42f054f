;;;; projecting.lisp -- project and try-best.

(in-package :ars-magna.rpl-projecting)

(defun plan-with-arguments (plan arguments)
  "Return a list of a plan and its arguments. PLAN is a plan for the list ARGUMENTS, or is itself a
list of a plan and its arguments. Signals UNKNOWN-NAME and WRONG-ARGUMENT."
  (flet ((reject (name value expected) (reject-argument 'project name value expected)))
    (unless (proper-list-p arguments) (reject :arguments arguments "a list"))
    (when (and (consp plan) arguments)
      (reject :arguments arguments "none, since the plan is a list with arguments"))
    (let ((call (if (consp plan) plan (cons plan arguments))))
      (unless (and (proper-list-p call)
                   (first call)
                   (typep (first call) '(or procedure symbol string)))
        (reject 'plan plan "the name of a plan, a list (name argument...), a plan, or a task"))
      call)))

(defun check-plan-arguments (plan arguments)
  "Signal WRONG-ARGUMENT unless PLAN takes the list ARGUMENTS."
  (check-arguments (if (procedure-p plan) plan (find-procedure plan)) arguments))

(defun split-projected-call (plan arguments robot)
  "Return three values: PLAN, its arguments and its robot. PLAN and ARGUMENTS are as for
PLAN-WITH-ARGUMENTS; or PLAN is a task. ROBOT is the option :ROBOT of PROJECT. Signals UNKNOWN-NAME
and WRONG-ARGUMENT."
  (flet ((reject (name value reason)
           (reject-argument 'project name value (format nil "none, since ~A" reason))))
    (when (task-p plan)
      (when arguments (reject :arguments arguments "a task has its arguments"))
      (when robot (reject :robot robot "a task has its robot"))
      (return-from split-projected-call plan))
    (destructuring-bind (plan . arguments) (plan-with-arguments plan arguments)
      (multiple-value-bind (arguments last-robot) (split-arguments plan arguments)
        (when (and robot last-robot)
          (reject :robot robot "the arguments of the plan end with :robot and a robot"))
        (values plan arguments (or robot last-robot))))))

(defun robot-of-question (robot options)
  "Return what a question with OPTIONS keeps for ROBOT, a robot or its name: in a believed world, a
robot has only its name in common with ROBOT. Signals UNKNOWN-NAME and MISUSE."
  (cond ((null robot) nil)
        ((null (getf options :world)) (drivable-robot robot))
        (t (name-of-robot (fluent-value robot)))))

(defun make-question (task interface plan arguments robot options)
  "Return a question about how PLAN may end. TASK asks it, or is NIL outside of plans. PLAN is a
task of INTERFACE, or a plan for the list ARGUMENTS and for ROBOT, or NIL for the default robot.
Signals UNKNOWN-NAME, WRONG-ARGUMENT and MISUSE."
  (let ((options (checked-options 'project options)))
    (if (task-p plan)
        (%make-question :operator 'project :task task :interface interface
                        :subject (check-projected-task plan interface (getf options :world))
                        :options options)
        (progn
          (check-plan-arguments plan arguments)
          (%make-question :operator 'project :task task :interface interface
                          :robot (robot-of-question robot options)
                          :driver (and interface (null task) (driver-for-plan robot plan))
                          :plan plan :arguments arguments :options options)))))

(defun check-projected-task (task interface world)
  "Return TASK. Signals WRONG-ARGUMENT unless TASK belongs to the plans of INTERFACE. Also signals
WRONG-ARGUMENT if there is a WORLD, because tasks do not exist in believed worlds."
  (when world
    (reject-argument 'project 'plan task
                     "a plan that has a name: with :world there are no tasks of this run"))
  (unless (and interface
               (task-runner task)
               (eq interface (runner-client (task-runner task)))
               (member interface (simulation-participants (interface-simulation interface))))
    (reject-argument 'project 'plan task "a task of the plans that drive the current robot"))
  task)

;;; In plans.

(defun asking-interface (task)
  (let ((interface (runner-client (task-runner task))))
    (if (interface-p interface)
        interface
        (reject-use "There is no run to project: PROJECT works in plans that run on a robot, see ~
                     RUN-PLAN."))))

(defun pose-question (question task)
  "Let TASK wait for the answer to QUESTION. Return +PARKED+."
  (park task question)
  (add-wish question)
  +parked+)

(defun question-of-plan (task plan arguments options)
  (multiple-value-bind (plan arguments robot)
      (split-projected-call (fluent-value plan) (fluent-value arguments) nil)
    (let ((question (make-question task (asking-interface task) plan arguments robot options)))
      (when (question-option question :world) (check-no-run-objects question))
      question)))

;; In a rollout of a plan for another robot, the frame of PROJECT binds that robot as ON-ROBOT does,
;; and keeps the question beside it.
(defun data-of-rollout (question task)
  "Return the data of the frame of PROJECT in TASK, in which the plan of QUESTION begins."
  (if (question-robot question)
      (bindings-for-robot (question-robot question) task (list (cons 'question question)))
      question))

(defun question-in-data (data)
  "Return the question in DATA, a value of DATA-OF-ROLLOUT."
  (if (task-bindings-p data)
      (cdr (assoc 'question (task-bindings-cells data)))
      data))

(define-construct project (plan &key arguments trials horizon seed cost measure world print
                                robot)
  "Return a projection of PLAN: how it ends in TRIALS rollouts, by default 20. A rollout is a fork
of the run with its own seed. In the fork, PLAN runs until it has ended or HORIZON ticks have
passed, by default 600. See PROJECTION-PROBABILITY and others.
  PLAN is a plan procedure or its name, to call with the list ARGUMENTS; or a list of a plan and
its arguments; or a task. Of a task, the remaining part is projected. Arguments may end with :ROBOT
and a robot, as for BEGIN-PLAN; in a plan, PLAN then begins as in ON-ROBOT.
  SEED, an integer, determines the seeds of rollouts. By default they depend on the run's seed and
the tick.
  COST, a function without arguments, is called in each fork at its end. COST returns a number, or
positive infinity for the worst.
  MEASURE, the name of a measure (see DEFMEASURE), is read in each fork at its end; or, as a list
(name :over summary), sampled at each tick, with the summary :MEAN, :SUM, :MAX or :MIN. See
PROJECTION-MEAN-MEASURE.
  WORLD, a function, makes worlds for rollouts that are no forks, such as a world that the robot
believes in. WORLD is called with a function and a seed, and must call that function inside of
(with-simulation (robot :seed seed) ...). Rollouts then use the robots, fluents and parameters of
that world. Objects of the true run in global variables can be read, but not changed or commanded.
PLAN must have a name, and ARGUMENTS must contain no objects of a run.
  PRINT, if true, shows what plans write in rollouts.
  ROBOT, a robot or its name, is what PLAN drives, by default as for BEGIN-PLAN. In a plan, write
:ROBOT at the end of PLAN's arguments instead.
  In a plan, PROJECT waits until all plans rest, and goes on in the same tick; PLAN begins as if
PROJECT called it. Elsewhere, as in a continuation, in a test or at the prompt, PLAN begins as by
BEGIN-PLAN. The run itself is not affected: its dice are not rolled, and messages and traces of
rollouts are dropped. In rollouts, PROJECT returns a
projection without rollouts. An error in a rollout is a failure of that rollout; errors in COST,
MEASURE or WORLD are reported by one message. Fails with CANNOT-FORK if the run cannot be forked.
(After McDermott's projection of reactive plans, 1992.)"
  (:arguments plan arguments trials horizon seed cost measure world print robot)
  (:parts (request function
                   (progn
                     (check-plan-quote plan form scope)
                     (when robot
                       (reject-clause (text-title) form
                                      "no option :robot in a plan: put it after the arguments of ~
                                       the plan, '(NAME ARGUMENT... :robot ROBOT)"))
                     (value-lambda `(list ,plan ,arguments :trials ,trials :horizon ,horizon
                                          :seed ,seed :cost ,cost :measure ,measure :world ,world
                                          :print ,print)
                                   scope))))
  (:in-lisp `(project-plan ,plan :arguments ,arguments :trials ,trials :horizon ,horizon
                                 :seed ,seed :cost ,cost :measure ,measure :world ,world
                                 :print ,print :robot ,robot))
  (:steps
   (begin
    (next answered)
    (destructuring-bind (plan arguments . options) (funcall request environment)
      (pose-question (setf memory (question-of-plan task plan arguments options)) task)))
   (answered
    (cond ((eq value :do-it)
           (next inside)
           (let ((question memory))
             (setf memory (data-of-rollout question task))
             (enter-application (question-plan question) (question-arguments question) frame)))
          (t (values (frame-up frame) value))))
   (inside
    (note-question-end (question-in-data memory) :succeeded value)
    (at-once ended))
   ;; A rollout goes no further.
   (ended
    (park task "the end of the rollout")
    +parked+))
  (:unwind
   (when (in-state-p inside)
     (note-ending-signal (question-in-data memory) signal)
     (when (typep signal 'plan-failure)
       (next ended)
       (values t frame nil)))))

;;; From outside.

(defun interface-to-project (plan robot)
  "Return the interface whose plans are projected with PLAN, for ROBOT or, if ROBOT is NIL, for the
robot that plans drive by default. Signals MISUSE inside a plan's step."
  (let ((interface (if (and (task-p plan) (task-runner plan)
                            (interface-p (runner-client (task-runner plan))))
                       (runner-client (task-runner plan))
                       (driver-interface (driver-for-plan robot plan)))))
    (when (holding-plans-p interface)
      (reject-use "project: a plan is running here. Write PROJECT in the text of the plan itself, ~
                   outside of any lambda."))
    interface))

(defun fork-with-question (question)
  "QUESTION is asked outside of plans. Return a fork of its run, with a copy of QUESTION."
  (let ((interface (wish-interface question)))
    (call-with-plans (lambda () (add-wish question)) interface)
    (unwind-protect (let ((*fork-operator* (question-operator question)))
                      (disable-recording (fork-simulation (interface-simulation interface))))
      (call-with-plans (lambda () (forget-wish question)) interface))))

(addition project-plan)
(defun project-plan (plan &key arguments trials horizon seed cost measure world print robot)
  "Return a projection of PLAN. This is PROJECT for Lisp code outside of plans. Signals
UNKNOWN-NAME, WRONG-ARGUMENT, CANNOT-FORK; and MISUSE inside of a plan's step."
  (multiple-value-bind (plan arguments robot) (split-projected-call plan arguments robot)
    (let* ((interface (if world nil (interface-to-project plan robot)))
           (question (make-question nil interface plan arguments robot
                                    (list :trials trials :horizon horizon :seed seed :cost cost
                                          :measure measure :world world :print print))))
      (when world (check-no-run-objects question))
      (cond (*rolling-out* (projection-without-rollouts question))
            (t (first (project-branches question
                                        (if world nil (fork-with-question question)))))))))

;;;; Doing what goes best

(defun question-of-branches (task forms options)
  "Return TASK's question about the best of FORMS, with OPTIONS; NIL if there is only one form."
  (let ((options (checked-options 'try-best options)))
    (and (rest forms)
         (%make-question :operator 'try-best :task task :interface (asking-interface task)
                         :branches (mapcar #'whole-form-text forms) :options options))))

(define-construct try-best ((&key trials horizon until cost measure seed tell print)
                            &body branches)
  "Run the best of BRANCHES, in a plan, and return its values. Each branch is tried first in TRIALS
forks of the run, by default 20, until the whole plan has ended or HORIZON ticks have passed, by
default 600. The best is the branch with which the plan succeeds most often. Of equally good
branches, it is the branch whose successes take the fewest ticks on average, or else the first.
Trials of the same number have the same random events in all branches.
  UNTIL :branch ends a rollout when the branch has ended.
  COST, a function without arguments, is called in each fork at its end. COST returns a number, the
less the better, or positive infinity for the worst. The number replaces ticks in the choice.
  MEASURE, as in PROJECT, replaces ticks in the choice unless there is a COST: the more the better.
  SEED, an integer, determines the seeds of rollouts. By default they depend on the run's seed and
the tick.
  TELL, a function, is called with the list of projections and the index of the chosen branch.
  PRINT, if true, shows what plans write in rollouts. In a rollout a branch is chosen at random:
there are no rollouts in rollouts. The task goes on in the same tick; rollouts have no other effect
on the run. Fails with CANNOT-FORK if the run cannot be forked."
  (:arguments trials horizon until cost measure seed tell print)
  (:parts (request function
                   (value-lambda `(list :trials ,trials :horizon ,horizon :until ,until :cost ,cost
                                        :measure ,measure :seed ,seed :tell ,tell :print ,print)
                                 scope))
          (forms list `',branches)
          (branches simple-vector
                    (if branches
                        `(vector ,@(loop for branch in branches collect (plan-code branch scope)))
                        (reject-clause (text-title) form "at least one branch"))))
  (:steps
   (begin
    (next chosen)
    (setf memory (question-of-branches task forms (funcall request environment)))
    (if memory (pose-question memory task) (values frame 0)))
   (chosen
    (next inside)
    (enter (svref branches value) environment frame))
   (inside
    (note-question-end memory :succeeded value)
    (values (frame-up frame) value)))
  (:unwind
   (when (and memory (in-state-p inside)) (note-ending-signal memory signal))
   nil))
