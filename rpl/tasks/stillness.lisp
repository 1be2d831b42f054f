;;;; stillness.lisp -- tasks that cannot go on: cyclic waits, deadlocks, and advice.

(in-package :ars-magna.rpl.tasks)

(export '(tasks-awaited stuck-wait-text report-wait-cycle preemptors all-preemptors report-deadlock
          warn-of-outside-waits +no-fluent+ wait-forever warn-of-dubious-condition waiting-parts
          waiting-plans-text text-of-waits advice-on-endless-waits endless-advice fluents-awaited))

;;; A task is stuck if what it waits for can only come from stuck tasks. A task with parts is stuck
;;; if all of them are, not counting policies, which only watch. If it is unknown what could wake a
;;; task, it is not stuck; the report of deadlocks covers it when nothing runs any more.

(defgeneric tasks-awaited (awaited)
  (:documentation "Return the tasks that must go on before AWAITED can happen; NIL if unknown.")
  (:method (awaited)
    (declare (ignore awaited))
    '()))

(defgeneric preemptors (task data)
  (:documentation "Return the tasks that keep TASK from running, because they own a resource that
TASK needs. DATA, the data of one of TASK's frames, refers to the resource.")
  (:method (task data)
    (declare (ignore task data))
    '()))

(defun all-preemptors (task)
  "Return the tasks that own what TASK, or a task around it, needs in order to run."
  (loop for each in (lineage task)
        append (loop for frame in (frame-chain (task-frame each))
                     append (preemptors each (frame-data frame)))))

(defun innermost-parts-at-level (task)
  "Return the innermost parts of TASK at TASK's level. Policies, at other levels, are left out."
  (let ((children (remove (task-level task) (task-children task) :key #'task-level :test #'<)))
    (if children
        (loop for child in children append (innermost-parts-at-level child))
        (list task))))

(defun obstacles (task)
  "Return the tasks that must go on before TASK itself (not its parts) can go on; NIL if unknown."
  (or (and (task-awaiting task) (tasks-awaited (task-awaiting task)))
      (all-preemptors task)))

(defun stuck-tasks (task)
  "Return TASK and the tasks that wait in a cycle with TASK; NIL if one of these can go on."
  (let ((stuck '()) (open (list task)))
    (loop while open
          do (let* ((next (pop open)) (others (obstacles next)))
               (unless others (return-from stuck-tasks '()))
               (pushnew next stuck)
               (dolist (part (mapcan #'innermost-parts-at-level others))
                 (unless (or (member part stuck) (member part open))
                   (push part open)))))
    (reverse stuck)))

(defgeneric stuck-wait-text (awaited)
  (:documentation "Return a text of AWAITED, which a stuck task waits for.")
  (:method (awaited) (awaited-text awaited)))

(defun wait-text (task)
  "Return a text of what TASK waits for, as TASK-AWAITS does, and which tasks are known to own it."
  (and (task-awaits task)
       (if (tasks-awaited (task-awaiting task))
           (stuck-wait-text (task-awaiting task))
           (task-awaits task))))

(defun stuck-task-text (task)
  (let ((awaiting (task-awaiting task)))
    (if (and awaiting (tasks-awaited awaiting))
        (format nil "~A waits for ~A" (task-label task) (stuck-wait-text awaiting))
        (let ((names (mapcar #'task-label (all-preemptors task))))
          (format nil "~A waits until ~{~A~^ and ~} ~:[gives~;give~] back a valve taken from it"
                  (task-label task) names (rest names))))))

(defun warn-of-wait-cycle (tasks)
  "Queue a warning that TASKS wait for each other. A task around TASKS may still end one of TASKS."
  (queue-notable-warning "Deadlock at tick " (runner-tick (task-runner (first tasks))) ": "
                         (format nil "~{~A~^; ~}" (mapcar #'stuck-task-text tasks))
                         ". These tasks can go on only if one of them is ended, for example by a "
                         "deadline."))

(defun report-wait-cycle (task)
  "Queue a warning if TASK, which has begun to wait, is in a cycle of waits."
  (let ((tasks (stuck-tasks task)))
    (when tasks (warn-of-wait-cycle tasks))))

;;; A task with a part that goes on is not stuck. A circle may close when that part ends.

(defun first-innermost-part (task)
  (let ((child (loop for child = (task-newest-child task) then (task-older child)
                     while child
                     when (<= (task-level child) (task-level task)) return child)))
    (if child (first-innermost-part child) task)))

(defun obstacle-p (task others)
  (some (lambda (other)
          (some (lambda (obstacle) (part-of-p task obstacle)) (obstacles other)))
        others))

(defun warn-of-remaining-cycle (task)
  "A part of TASK has ended. Queue a warning if other parts wait in a cycle through TASK."
  (when (and (task-newest-child task) (null (task-signal task)))
    (let* ((part (first-innermost-part task))
           (tasks (and (or (task-awaiting part) (plusp (task-blocked part)))
                       (stuck-tasks part))))
      (when (obstacle-p task tasks) (warn-of-wait-cycle tasks)))))

;;;; Stillness

(define-global +no-fluent+ "a value that is no fluent"
  "The object that a task waits for if its wait was given something other than a fluent.")

(defun waiting-parts (task)
  "Return those of TASK and its parts that wait, but not those that only wait for their own parts."
  (remove-if-not (lambda (part) (and (eq :waiting (task-state part)) (task-awaiting part)))
                 (all-tasks task)))

(defun fluents-awaited (tasks)
  "Return a list of the base fluents that TASKS wait for, without repetition."
  (remove-duplicates (loop for task in tasks
                           for subject = (traced-subject (task-awaiting task))
                           when (fluent-p subject) append (base-fluents subject))
                     :from-end t))

(defun text-of-waits (tasks)
  "Return a text of what TASKS wait for, or NIL if they wait for nothing but their parts."
  (let ((texts (remove-duplicates (remove nil (mapcar #'wait-text tasks))
                                  :test #'string= :from-end t)))
    (and texts (cut (format nil "~{~A~^, ~}" texts) 300))))

;;; What to do.

(defun no-fluent-advice (task)
  (format nil "~A waits for a value that is not a fluent and never changes. Wait for the fluent ~
               itself, as in (wait-for robot-stopped*) or (wait-for (> level 3)); wait-until tests ~
               other forms in each tick."
          (form-text (task-form task))))

(defun status-fluent-p (fluent)
  (starts-with-subseq "(task-status " (fluent-text fluent)))

(defun missing-end-wait-text (name part tasks)
  "Return the text of a form that waits for the end of NAME on PART; NIL if TASKS wait for this."
  (let ((text (wait-for-end-text name part)))
    (and text
         (notany (lambda (fluent) (search (fluent-text fluent) text)) (fluents-awaited tasks))
         text)))

(defun command-advice (tasks)
  (let* ((task (first tasks)) (plan (task-label (task-top task)))
         (client (task-client task)))
    (multiple-value-bind (name part) (and client (last-command client task))
      (cond
        ((null client)
         (format nil "RUN-PLAN-ALONE runs ~A without a robot: no ticks of a run pass, so no ~
                      command can end. Run the plan on a robot: (with-simulation (ROBOT) ~
                      (run-plan '~:*~A)), or live (simulator 'ROBOT) and (run-plan '~:*~A)."
                 plan))
        (name
         (format nil "The last command of ~A was ~(~A~)~:[, which has ended~;; ~:*~A waits for its ~
                      end~]." plan name (missing-end-wait-text name part tasks)))
        (t (format nil "~A has issued no command by a function such as rpl-robot-turn; only such ~
                        functions change the fluents of a robot." plan))))))

;; Whatever has pulsed a fluent that is waited for itself came before the wait.
(defun missed-pulses-text (tasks)
  (let ((fluent (find-if (lambda (subject)
                           (and (fluent-p subject)
                                (equal (list subject) (base-fluents subject))
                                (not (robot-fluent-p subject))
                                (plusp (fluent-pulses subject))))
                         (mapcar (lambda (task) (traced-subject (task-awaiting task))) tasks))))
    (and fluent
         (format nil "~A has been pulsed ~D time~:P so far, before this wait began; only a later ~
                      pulse can end the wait." (fluent-text fluent) (fluent-pulses fluent)))))

(defun missed-end-text (tasks)
  (loop for task in tasks
        for subject = (traced-subject (task-awaiting task))
        for tick = (and (fluent-p subject)
                        (last-pulse-tick (task-client task) task subject))
        when tick
          return (format nil "~A was pulsed at tick ~D, before this wait began; only a later ~
                              pulse can end the wait. To wait for several fluents, write (par ~
                              (wait-for fluent) (wait-for fluent))."
                         (fluent-text subject) tick)))

;;; What does not end.

(defun exit-in-p (form)
  (typecase form
    (cons (or (exit-in-p (car form)) (exit-in-p (cdr form))))
    (symbol (search "RETURN" (symbol-name form)))))

(defun endless-form-p (form)
  (and (consp form)
       (symbolp (first form))
       (or (string= "WHENEVER" (first form))
           (and (string= "LOOP" (first form)) (every #'consp (rest form))))
       (not (exit-in-p form))))

(defun endless-advice (tasks)
  "Return a sentence that says that a form around TASKS does not end by itself, or NIL."
  (let ((form (loop for task in tasks
                    thereis (find-if #'endless-form-p
                                     (plan-backtrace task (task-frame task))))))
    (and form
         (format nil "~A does not end by itself. End it by (return), or start the plan by ~
                      BEGIN-PLAN, which does not wait for the end of a plan." (form-text form)))))

(defun event-advice (fluent tasks awaited)
  (let ((waiting (remove-if-not (lambda (task) (member fluent (fluents-awaited (list task))))
                                tasks)))
    (advice-on-event (task-client (first waiting)) fluent waiting awaited)))

(defun other-fluents (fluents advised)
  "Return those of FLUENTS that only programs and tasks change. ADVISED change at other events."
  (remove-if (lambda (fluent)
               (or (robot-fluent-p fluent) (status-fluent-p fluent) (member fluent advised)))
             fluents))

(defun advice-on-endless-waits (tasks &optional awaited)
  "Return sentences with advice about TASKS, which wait and which nothing will wake. A caller other
than RUN-PLAN waits for the end of the plan AWAITED, unless it is NIL."
  (let* ((valueless (find +no-fluent+ tasks :key #'task-awaiting))
         (fluents (fluents-awaited tasks))
         (robots (remove-if-not #'robot-fluent-p fluents))
         (states (remove-if-not #'status-fluent-p fluents))
         (events (loop for fluent in fluents
                       for texts = (event-advice fluent tasks awaited)
                       when texts collect (cons fluent texts)))
         (others (other-fluents fluents (mapcar #'first events))))
    (format nil "~@[ ~A~]~@[ ~A when a command of the robot ends, and no command is in progress: ~
                 issue a command before the wait. ~]~@[~A~]~{ ~A~}~@[ Only SET-VALUE and PULSE ~
                 change ~{~A~^, ~}, and no task is left that could call them.~]~@[ ~:{~A is ~
                 ~(~S~)~:^, ~}, and stays so, because no task goes on.~]~@[ ~A~]~@[ ~A~]"
            (and valueless (no-fluent-advice valueless))
            (and robots
                 (format nil "~{~A~^, ~} change~:[s~;~]"
                         (mapcar #'fluent-text robots) (rest robots)))
            (and robots (command-advice tasks))
            (remove-duplicates (remove nil (mapcan #'rest events)) :test #'string= :from-end t)
            (remove-duplicates (mapcar #'fluent-text others) :test #'string=)
            (loop for fluent in states collect (list (fluent-text fluent) (fluent-value fluent)))
            (or (missed-pulses-text tasks) (missed-end-text tasks))
            (endless-advice tasks))))

;;; Reports.

(defun warn-of-dubious-wait (task text)
  "Queue a warning, once for each form, that a wait of TASK is probably a mistake. TEXT says why."
  (when (first-warning-p (task-form task) (task-runner task))
    (queue-notable-warning "In the plan " (task-label (task-top task)) ", " text)))

(defun wait-forever (task)
  "Let TASK wait forever for lack of a fluent. Queue a warning, once for each form."
  (park task +no-fluent+)
  (warn-of-dubious-wait task (no-fluent-advice task)))

(defun warn-of-dubious-condition (task value)
  "Warn once for each form if VALUE, which TASK waits for, is probably not meant as a condition."
  (multiple-value-bind (kind remedy)
      (typecase value
        (number (values "number" (format nil "(wait-time ~A) waits for that many ticks" value)))
        (task (values "task" "(join-task task) waits for the end of a task"))
        (function (values "function" "(wait-until (funcall function)) calls it in each tick")))
    (when kind
      (warn-of-dubious-wait task (format nil "~A does not wait: its argument is a ~A, ~A, which ~
                                              counts as true. ~A."
                                         (form-text (task-form task)) kind (form-text value 40)
                                         remedy)))))

(defun runner-tasks-text (runner)
  (cut (with-output-to-string (stream)
         (dolist (task (plan-runner-tasks runner))
           (write-task-tree task 0 stream)))
       4000))

(defun waiting-plans-text (tasks)
  "Return a text that starts with the names of the plans TASKS and says what they wait for."
  (format nil "the plan~P ~{~A~^, ~} wait~:[s~;~] for ~A"
          (length tasks) (mapcar #'task-label tasks) (rest tasks)
          (or (text-of-waits (mapcan #'waiting-parts tasks))
              (text-of-blocks tasks)
              "something that cannot happen")))

(defun text-of-blocks (tasks)
  "Return a text that says that blocked parts of TASKS must be woken; NIL if no part is blocked."
  (let ((blocked (remove-if-not #'plusp (mapcan #'all-tasks tasks) :key #'task-blocked)))
    (and blocked
         (format nil "a call, such as of WAKE-UP, that lets ~{~A~^ and ~} go on"
                 (mapcar #'task-label blocked)))))

(defun warn-of-outside-waits (runner)
  "Queue a warning, with advice. The tasks of RUNNER wait for events that neither they nor the
simulator can cause. Only calls from outside can. A thread waits for the end of one of these tasks."
  (let ((tasks (mapcan #'waiting-parts (plan-runner-tasks runner))))
    (queue-notable-warning "At tick " (runner-tick runner)
                           " all plans wait for events that neither the robot nor time will cause. "
                           "SET-VALUE, PULSE or WAKE-UP may still wake them. Control-C ends this "
                           "wait." (advice-on-endless-waits tasks) t
                           (runner-tasks-text runner))))

(defun report-deadlock (runner)
  "Queue an error message that no task of RUNNER can go on. The message has the plans, their waits,
advice and the tree of tasks."
  (let ((tasks (plan-runner-tasks runner)))
    (queue-message
     (make-message :error
                   (list "Deadlock at tick " (runner-tick runner) ": " (waiting-plans-text tasks)
                         ", which nothing will cause."
                         (advice-on-endless-waits (mapcan #'waiting-parts tasks)) t
                         (runner-tasks-text runner))
                   :notable-p t)
     *message-queue*)))
