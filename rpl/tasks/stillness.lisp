;;;; stillness.lisp -- what is said of plans that nothing wakes: for what they wait, what to do.

(in-package :ars-magna.rpl.tasks)

(define-global +no-fluent+ "a value that is no fluent"
  "What a task waits for that was given no fluent where it was to wait for one.")

(defun waiting-parts (task)
  "Return TASK, or else those of its parts, that wait for something but the end of parts."
  (append (and (eq :waiting (task-state task)) (task-awaiting task) (list task))
          (mapcan #'waiting-parts (task-children task))))

(defun fluents-awaited (tasks)
  "Return the base fluents that TASKS wait for, each once."
  (remove-duplicates (loop for task in tasks
                           for subject = (traced-subject (task-awaiting task))
                           when (fluent-p subject) append (base-fluents subject))
                     :from-end t))

(defun waits-for-no-fluent-p (task)
  (eq +no-fluent+ (task-awaiting task)))

(defun text-of-waits (tasks)
  "Return in words what TASKS wait for, or NIL if that is nothing by itself."
  (let ((texts (remove-duplicates (remove nil (mapcar #'task-awaits tasks))
                                  :test #'string= :from-end t)))
    (and texts (cut (format nil "~{~A~^, ~}" texts) 300))))

;;; What to do.

(defun no-fluent-advice (task)
  (format nil "~A waits for a value that is no fluent and never changes. Give it the fluent ~
               itself, as in (wait-for robot-stopped*) or (wait-for (> level 3)); wait-until tests ~
               other forms in each tick."
          (form-text (task-form task))))

(defun split-fluents (fluents)
  "Return a list of those of FLUENTS that the robot changes, and of the others."
  (values (remove-if-not #'robots-fluent-p fluents)
          (remove-if #'robots-fluent-p fluents)))

(defun advice-on-stillness (tasks)
  "Return in sentences what could be done about it that TASKS wait and nothing will wake them."
  (let ((valueless (find-if #'waits-for-no-fluent-p tasks)))
    (multiple-value-bind (robots others) (split-fluents (fluents-awaited tasks))
      (format nil "~@[ ~A~]~@[ ~A when a command of the robot ends, and no command is under way: ~
                   give one before you wait.~]~@[ Only SET-VALUE and PULSE change ~{~A~^, ~}, and ~
                   no task is left that could call them.~]"
              (and valueless (no-fluent-advice valueless))
              (and robots
                   (format nil "~{~A~^, ~} change~:[s~;~]"
                           (mapcar #'fluent-text robots) (rest robots)))
              (remove-duplicates (mapcar #'fluent-text others) :test #'string=)))))

;;; Reports.

(defun warn-of-no-fluent (task)
  "Queue a warning that TASK, which has come to wait, was given no fluent, once for each form."
  (let ((form (task-form task)) (runner (task-runner task)))
    (unless (member form (runner-warned runner) :test #'eq)
      (push form (runner-warned runner))
      (queue-message (make-message :warning (list "In the plan " (task-label (task-top task)) ", "
                                                  (no-fluent-advice task))
                                   :notable-p t)
                     *message-queue*))))

(defun tree-text (runner)
  "Return all tasks of RUNNER as a text of bounded length."
  (cut (with-output-to-string (stream)
         (dolist (task (plan-runner-tasks runner))
           (write-task-tree task 0 stream)))
       4000))

(defun text-of-plans (tasks)
  "Return in words which plans TASKS are, as the subject of a sentence, and what they wait for."
  (format nil "the plan~P ~{~A~^, ~} wait~:[s~;~] for ~A"
          (length tasks) (mapcar #'task-label tasks) (rest tasks)
          (or (text-of-waits (mapcan #'waiting-parts tasks)) "what cannot come")))

(defun report-stillness (runner)
  "Queue a warning that says that the tasks of RUNNER wait for what only somebody outside of them
and of the simulator can bring about."
  (queue-message (make-message :warning
                               (list "At tick " (runner-tick runner) " all plans wait for what "
                                     "neither the robot nor time will bring about, but somebody "
                                     "may, by SET-VALUE or WAKE-UP:" t
                                     (tree-text runner))
                               :notable-p t)
                 *message-queue*))

(defun report-deadlock (runner)
  "Queue an error message that says that no task of RUNNER can go on: the plans, what they wait for,
what could be done, and all tasks."
  (let ((tasks (plan-runner-tasks runner)))
    (error-set "Deadlock at tick " (runner-tick runner) ": " (text-of-plans tasks)
               ", which nothing will bring about."
               (advice-on-stillness (mapcan #'waiting-parts tasks)) t
               (tree-text runner))))
