;;;; working.lisp -- plans that work on the agenda.

(in-package :ars-rap)

;;; The task of a goal.

(defun note-failure (number goal deadline failure)
  "Mark GOAL, the goal NUMBER, as failed by FAILURE. Report an error of Lisp as that of a plan."
  (set-goal-state number :failed (if (overdue-p deadline)
                                     (late-text deadline)
                                     (failure-text failure)))
  (when (typep failure 'lisp-failure)
    (report-failure failure nil (format nil "The goal ~A" (data-text goal)))))

(defun overdue-p (deadline) (and deadline (< deadline (now))))

(defun late-text (deadline) (format nil "Not achieved by tick ~A." deadline))

(defun ticks-left (deadline)
  "Return in how many ticks the first tick after DEADLINE comes."
  (- (1+ (floor deadline)) (now)))

(defun note-interruption (number)
  "Mark the goal NUMBER as failed if it is still active: its work was ended from outside."
  (changing-agenda
    (when (eq :active (goal-state number))
      (set-goal-state number :failed "Its plan was ended."))))

(def-interp-proc pursue-goal (number goal deadline achieved)
  "Work for GOAL, the active goal NUMBER. If the work is ended from outside, it has failed. If it is
achieved, count it in ACHIEVED, a list of a number."
  (evap-protect
      (handle-failure ((t (failure) (note-failure number goal deadline failure) (return nil)))
        (if deadline
            (with-deadline ((ticks-left deadline)) (apply-plan (first goal) (rest goal)))
            (apply-plan (first goal) (rest goal)))
        (when (set-goal-state number :achieved) (incf (first achieved))))
    (note-interruption number)))

(defun goal-label (number goal) (format nil "goal ~D ~A" number (data-text goal)))

(defun goal-task-p (task)
  (let ((row (agenda-row (task-index task))))
    (and row (equal (task-name task) (goal-label (first row) (second row))))))

(defun suspended-p (task) (eq :suspended (status-word task (task-state task))))

(defun start-goal (row achieved)
  "Start a task for the goal of ROW, as a part of the task around the calling task. Its level is
above that of the calling task, which goes on when the goal waits: then the goal has requested its
first resources. ACHIEVED is as for PURSUE-GOAL."
  (destructuring-bind (number goal priority deadline &rest others) row
    (declare (ignore others))
    (multiple-value-bind (body environment) (enter-plan 'pursue-goal number goal deadline achieved)
      (let ((whole (task-parent (current-task))) (task (make-task (goal-label number goal) body)))
        (set-goal-state number :active)
        (spawn whole body environment number (1+ (task-level whole)) task)
        (give-priority task priority)))))

(defun give-priority (task priority)
  (let ((*calling-task* task)) (setf goal-priority* priority)))

;;; The task that looks after the others.

(defun goals-for (robot only state)
  "Return the rows in STATE of the goals for ROBOT; or, if ONLY is a number, of that goal."
  (remove-if-not (lambda (row)
                   (and (eq state (fifth row))
                        (if only (= only (first row)) (member (seventh row) (list nil robot)))))
                 main-agenda*))

(defun before-p (row other)
  "True if the goal of ROW comes before that of OTHER, an older one."
  (destructuring-bind (priority deadline) (subseq row 2 4)
    (destructuring-bind (other-priority other-deadline) (subseq other 2 4)
      (cond ((/= priority other-priority) (> priority other-priority))
            ((and deadline other-deadline) (< deadline other-deadline))
            (t (and deadline (not other-deadline)))))))

(defun fail-overdue-goals (rows)
  (loop for (number nil nil deadline) in rows
        when (overdue-p deadline) do (set-goal-state number :failed (late-text deadline))))

(defun tend-goals (taken)
  "Evaporate the tasks of goals among TAKEN that are no longer on the agenda, and give the others
their priorities. TAKEN is a list of conses (number . priority)."
  (loop with rows = main-agenda*
        for task in (task-children (task-parent (current-task)))
        for goal = (assoc (task-index task) taken)
        for row = (and goal (assoc (first goal) rows))
        do (cond ((null goal))
                 ((null row) (evaporate task))
                 ((/= (cdr goal) (third row))
                  (setf (cdr goal) (third row))
                  (give-priority task (third row))))))

(defun goal-to-start (robot only taken at-once)
  "Return the row of the waiting goal to start next, or NIL if AT-ONCE goals are worked on."
  (and (or (null at-once)
           (< (count :active taken :key (lambda (goal) (goal-state (first goal)))) at-once))
       (first (stable-sort (goals-for robot only :waiting) #'before-p))))

(defun next-deadline (rows)
  "Return in how many ticks the first deadline of the goals of ROWS is over, or NIL."
  (let ((deadlines (remove nil (mapcar #'fourth rows))))
    (and deadlines (ticks-left (reduce #'min deadlines)))))

(def-interp-proc look-after-goals (robot only at-once changed achieved)
  "Work on goals until none is left."
  (let ((taken '()) (row nil))
    (loop
      (set-value changed nil)
      (fail-overdue-goals (goals-for robot only :waiting))
      (tend-goals taken)
      (loop
        (setf row (goal-to-start robot only taken at-once))
        (unless row (return nil))
        (push (cons (first row) (third row)) taken)
        (start-goal row achieved))
      (unless (or (goals-for robot only :waiting) (goals-for robot only :active))
        (return nil))
      (wait-for changed :timeout (next-deadline (goals-for robot only :waiting))))))

(defun free-abandoned-goals (robot)
  "Let the active goals for ROBOT that no task works for wait again, as after a run was saved
without its plans."
  (let ((tasks (remove-if-not #'goal-task-p (all-tasks (task-runner (current-task))))))
    (loop for (number) in (goals-for robot nil :active)
          unless (find number tasks :key #'task-index) do (set-goal-state number :waiting))))

(defun join-workers (robot only)
  "Note that the calling task works on the agenda for ROBOT, or on the goal ONLY. Return its fluent.
Signals MISUSE if another task works on the agenda for ROBOT."
  (let ((agents (runner-agents (task-runner (current-task)))) (fluent (create-fluent "new goals")))
    (when (and (null only)
               (loop for agent in agents
                     thereis (find-if (lambda (worker) (and (eq robot (first worker))
                                                            (null (second worker))))
                                      (goal-workers agent))))
      (reject-use "A plan of ~A already works on the agenda. It works on goals that are installed ~
                   meanwhile, too: call INSTALL-GOAL only."
                  robot))
    (unless only (free-abandoned-goals robot))
    (push (list robot only fluent) (agent-note (task-agent (current-task)) 'goal-workers))
    fluent))

(defun leave-workers (fluent)
  (let ((agent (task-agent (current-task))))
    (setf (agent-note agent 'goal-workers)
          (remove fluent (goal-workers agent) :key #'third))))

(def-interp-proc work-on-goals (robot only at-once)
  "Work on the goals for ROBOT, or only on the goal ONLY. Return how many were achieved."
  (let ((changed (join-workers robot only)) (achieved (list 0)))
    (evap-protect
        (loop
          (par (:tag more-goals (look-after-goals robot only at-once changed achieved)))
          ;; Others may have come while the last tasks cleaned up.
          (unless (goals-for robot only :waiting)
            (return (first achieved))))
      (leave-workers changed))))

(def-interp-proc work-on-agenda (&key at-once)
  "Work on the goals of the agenda of the current run until none is waiting or active, also on goals
that are installed meanwhile: on those for the robot of this plan, and those for no robot in
particular. Begin with the goals with the highest priority and, among equals, the earliest deadline.
Each is a task, such as goal 3 (bring cup table). With AT-ONCE, a number, work on at most so many
goals at the same time; others wait, even if they are more urgent. Return the number of goals
achieved. Signals MISUSE if a plan already works on the agenda for the robot."
  (unless (typep at-once '(or null (integer 1)))
    (reject-argument 'work-on-agenda 'at-once at-once "a positive integer, or NIL for no limit"))
  (work-on-goals (rpl-robot) nil at-once))

(defun process-goal-agenda ()
  "Work on the goals of the agenda of the current run, by the plan WORK-ON-AGENDA, until none is
left. Return the number of goals achieved. In a plan, call WORK-ON-AGENDA. (From RAP.)"
  (run-plan 'work-on-agenda))

(def-interp-proc work-on-goal (number)
  "Work on the goal NUMBER only."
  (work-on-goals (rpl-robot) number 1))

(defun execute-goal (goal &optional (priority 0) deadline)
  "Work on GOAL only, as INSTALL-GOAL and PROCESS-GOAL-AGENDA do. Return true if it is achieved.
Signals WRONG-ARGUMENT. (From RAP.)"
  (let ((number (install-goal goal priority deadline)))
    (eql 1 (run-plan 'work-on-goal number))))
