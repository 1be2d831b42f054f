;;;; projecting.lisp -- project and try-best.

(in-package :ars-magna.rpl-projecting)

(defun plan-of (plan arguments)
  "Return PLAN, a plan with the list ARGUMENTS or a list of both, as a list of both. Signals
UNKNOWN-NAME and WRONG-ARGUMENT."
  (flet ((reject (name value expected) (reject-argument 'project name value expected)))
    (unless (proper-list-p arguments) (reject :arguments arguments "a list"))
    (when (and (consp plan) arguments)
      (reject :arguments arguments "none, since the plan is a list with arguments"))
    (let ((call (if (consp plan) plan (cons plan arguments))))
      (unless (and (proper-list-p call)
                   (first call)
                   (typep (first call) '(or procedure symbol string)))
        (reject 'plan plan "the name of a plan, a list (name argument...), a plan, or a task"))
      (check-arguments (if (procedure-p (first call)) (first call) (find-procedure (first call)))
                       (rest call))
      call)))

(defun make-question (task interface plan arguments options)
  "Return the question of TASK, NIL outside of plans, what may become of PLAN: a task, a plan with
the list ARGUMENTS, or a list of both, of INTERFACE. Signals UNKNOWN-NAME and WRONG-ARGUMENT."
  (let ((options (checked-options 'project options)))
    (when (and (task-p plan) arguments)
      (reject-argument 'project :arguments arguments "none, since a task has begun with its own"))
    (if (task-p plan)
        (%make-question :operator 'project :task task :interface interface
                        :subject (checked-subject plan interface (getf options :world))
                        :options options)
        (destructuring-bind (plan . arguments) (plan-of plan arguments)
          (%make-question :operator 'project :task task :interface interface
                          :plan plan :arguments arguments :options options)))))

(defun checked-subject (task interface world)
  "Return TASK. Signals WRONG-ARGUMENT unless it is of the plans of INTERFACE, and there is no WORLD
believed in, which does not know it."
  (when world
    (reject-argument 'project 'plan task
                     "a plan that has a name: with :world there are no tasks of this run"))
  (unless (and interface
               (task-runner task)
               (eq interface (runner-client (task-runner task)))
               (member interface (simulation-participants (interface-simulation interface))))
    (reject-argument 'project 'plan task "a task of the plans of the robot that is driven here"))
  task)

;;; In plans.

(defun asking-interface (task)
  (let ((interface (runner-client (task-runner task))))
    (if (interface-p interface)
        interface
        (reject-use "There is no run to project: PROJECT works in plans that run on a robot, see ~
                     RUN-PLAN."))))

(defun pose-question (question task)
  "Let TASK wait for the answer to QUESTION. Return what a step returns."
  (park task question)
  (add-wish question)
  +parked+)

(defun question-of-plan (task plan arguments options)
  (let ((question (make-question task (asking-interface task) (fluent-value plan)
                                 (fluent-value arguments) options)))
    (when (option question :world) (check-known-in-belief question))
    question))

(define-construct project (plan &key arguments trials horizon seed cost world print)
  "Return a projection of PLAN: how it ends in TRIALS rollouts, by default 20. A rollout is a fork
of the run with its own seed, in which PLAN runs until it has ended or HORIZON ticks have
passed, by default 600. See PROJECTION-PROBABILITY and others.
  PLAN is a plan procedure or its name, which gets the list ARGUMENTS; a list of both; or a task,
whose remaining part is projected.
  SEED, an integer, determines the seeds; by default the run's seed and the tick do.
  COST, a function without arguments, is called in each fork at its end and returns a number, or
positive infinity, which is worse than any.
  WORLD, a function, makes other worlds for rollouts than forks, such as the one the robot believes
in. It is called with a function and a seed, and must call that function inside of (with-simulation
(robot :seed seed) ...). Robots, fluents and parameters are those of that world. Objects of the true
run in global variables can be read, but not changed or commanded. PLAN must have a name, and
ARGUMENTS no objects of a run.
  PRINT, if true, shows what plans write in rollouts.
In a plan, this waits until all plans rest, and goes on in the same tick; PLAN begins as if called
there. Elsewhere, as in a continuation, in a test or at the prompt, PLAN begins as by BEGIN-PLAN.
The run itself is not affected: its dice are not rolled, and messages and traces of rollouts are
dropped. In rollouts, PROJECT returns a projection without rollouts. Errors in rollouts are failures
of these; errors in COST or WORLD are reported by one message. Fails with CANNOT-FORK if the run
cannot be forked (ours; McDermott's projection of reactive plans, 1992)."
  (:arguments plan arguments trials horizon seed cost world print)
  (:parts (request function
                   (progn
                     (check-plan-quote plan form scope)
                     (value-lambda `(list ,plan ,arguments :trials ,trials :horizon ,horizon
                                          :seed ,seed :cost ,cost :world ,world :print ,print)
                                   scope))))
  (:in-lisp `(project-plan ,plan :arguments ,arguments :trials ,trials :horizon ,horizon
                                 :seed ,seed :cost ,cost :world ,world :print ,print))
  (:steps
   (begin
    (next answered)
    (destructuring-bind (plan arguments . options) (funcall request environment)
      (pose-question (setf memory (question-of-plan task plan arguments options)) task)))
   (answered
    (cond ((eq value :do-it)
           (next inside)
           (enter-application (question-plan memory) (question-arguments memory) frame))
          (t (values (frame-up frame) value))))
   (inside
    (note-ended memory :succeeded value)
    (at-once ended))
   ;; A rollout goes no further.
   (ended
    (park task "the end of the rollout")
    +parked+))
  (:unwind
   (when (in-state-p inside)
     (note-signal memory signal)
     (when (typep signal 'plan-failure)
       (next ended)
       (values t frame nil)))))

;;; From outside.

(defun interface-for-projection (plan)
  "Return the interface whose plans are to be projected with PLAN. Signals MISUSE at a plan's step."
  (let ((interface (if (and (task-p plan) (task-runner plan)
                            (interface-p (runner-client (task-runner plan))))
                       (runner-client (task-runner plan))
                       (ensure-interface))))
    (when (holding-p interface)
      (reject-use "project: a plan is at work here. Write PROJECT in the text of the plan itself, ~
                   outside of any lambda."))
    interface))

(defun moment-with (question)
  "Return a fork of the run of QUESTION, asked from outside, which contains its twin."
  (let ((interface (wish-interface question)))
    (call-with-plans (lambda () (add-wish question)) interface)
    (unwind-protect (let ((*fork-asker* (question-operator question)))
                      (drop-records (fork-simulation (interface-simulation interface))))
      (call-with-plans (lambda () (forget-wish question)) interface))))

(addition project-plan)
(defun project-plan (plan &key arguments trials horizon seed cost world print)
  "Return a projection of PLAN: PROJECT for Lisp code outside of plans. Signals UNKNOWN-NAME,
WRONG-ARGUMENT, CANNOT-FORK; and MISUSE at a plan's own step."
  (let* ((interface (if world nil (interface-for-projection plan)))
         (question (make-question nil interface plan arguments
                                  (list :trials trials :horizon horizon :seed seed :cost cost
                                        :world world :print print))))
    (when world (check-known-in-belief question))
    (cond (*rolling-out* (projection-without-rollouts question))
          (t (first (project-branches question (if world nil (moment-with question))))))))

;;;; Doing what goes best

(defun question-of-branches (task forms options)
  "Return the question of TASK which of FORMS is the best, by OPTIONS; NIL if there is only one."
  (let ((options (checked-options 'try-best options)))
    (and (rest forms)
         (%make-question :operator 'try-best :task task :interface (asking-interface task)
                         :branches (mapcar #'whole-form-text forms) :options options))))

(define-construct try-best ((&key trials horizon until cost seed tell print) &body branches)
  "Run the best of BRANCHES, in a plan, and return its values. Each branch is tried first in TRIALS
forks of the run, by default 20, until the whole plan has ended or HORIZON ticks have passed, by
default 600. The best is the branch with which the plan succeeds most often; of equals the one that
takes the fewest ticks on average where it succeeds; of equals the first. Trials of the same number
have the same random events in all branches.
  UNTIL :branch ends a rollout when the branch has ended.
  COST, a function without arguments, is called in each fork at its end. It returns a number, of
which less is better, or positive infinity, the worst; it decides instead of ticks.
  SEED, an integer, determines the seeds of rollouts; by default the run's seed and the tick do.
  TELL, a function, is called with the list of projections and the index of the chosen branch.
  PRINT, if true, shows what plans write in rollouts.
In a rollout a branch is chosen at random: there are no rollouts in rollouts. The task goes on in
the same tick; nothing else of its run depends on how it has chosen. Fails with CANNOT-FORK if the
run cannot be forked (ours)."
  (:arguments trials horizon until cost seed tell print)
  (:parts (request function
                   (value-lambda `(list :trials ,trials :horizon ,horizon :until ,until :cost ,cost
                                        :seed ,seed :tell ,tell :print ,print)
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
    (note-ended memory :succeeded value)
    (values (frame-up frame) value)))
  (:unwind
   (when (and memory (in-state-p inside)) (note-signal memory signal))
   nil))
