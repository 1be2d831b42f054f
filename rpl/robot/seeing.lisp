;;;; seeing.lisp -- looking at the plans that drive a robot.

(in-package :ars-magna.rpl-robot)

(export '(call-with-plans-in-use))

(defmethod owner-text ((driver driver))
  (and (rest (simulation-robots (driver-simulation driver)))
       (string-downcase (robot-label (driver-robot driver)))))

(defun drivers-with-tasks (interface)
  "Return the drivers of INTERFACE that have plans, in the order of their robots' names."
  (sort (remove-if-not #'tasks-of-driver (copy-list (interface-drivers interface))) #'string<
        :key (lambda (driver) (robot-full-name (driver-robot driver)))))

(defun print-tasks-by-robot (interface stream all)
  "Print the plans of INTERFACE to STREAM, below the names of their robots. ALL is as for
PRINT-PLANS."
  (dolist (driver (drivers-with-tasks interface))
    (format stream "~A:~%" (owner-text driver))
    (dolist (task (tasks-of-driver driver)) (print-tasks task stream all))))

(defmethod runner-in-use ((interface interface))
  (interface-runner interface))

(defun usable-runner ()
  (let ((interface (usable-interface)))
    (and interface (interface-runner interface))))

;; Where none is in use, one may react.
(defmethod default-home ((interface interface)) (usable-runner))
(defmethod default-home ((interface null)) (usable-runner))

(defun trace-if-wanted (task)
  (when *trace-plans* (start-trace (task-runner task))))

(add-listener *plan-start-hooks* trace-if-wanted)

;; The state that was restored may be older than the wish for a trace.
(defun trace-rewound-run (old new)
  (declare (ignore old))
  (when *trace-plans*
    (dolist (interface (remove-if-not #'interface-p (simulation-participants new)))
      (with-plans (interface) (start-trace (interface-runner interface))))))

(add-listener *rewind-hooks* trace-rewound-run)

(defun call-with-plans-in-use (function)
  "Call FUNCTION with the runner of the plans in use, or with NIL. No plan goes on meanwhile."
  (cond (*default-interface*
         (note-plans-shown *default-interface*)
         (with-plans (*default-interface*)
           (funcall function (interface-runner *default-interface*))))
        (t (funcall function nil))))

(defmethod call-with-client-still ((interface interface) function)
  (note-plans-shown interface)
  (with-plans (interface) (funcall function)))

(addition print-plans)
(defun print-plans (&optional (stream *standard-output*) all)
  "Print the running plans to STREAM, each as a tree of tasks: what each does and waits for. If the
run has several robots, the plans of each robot are below its name. If ALL is true, also print
stacks, variables and valves: see PRINT-TASKS."
  (if (usable-interface-p *default-interface*)
      (call-with-plans-in-use
       (lambda (runner)
         (let ((interface *default-interface*))
           (if (and (rest (simulation-robots (interface-simulation interface)))
                    (tasks-of-interface interface))
               (print-tasks-by-robot interface stream all)
               (print-tasks runner stream all)))))
      (format stream "No plans.~%")))

(addition step-plan)
(defun step-plan (plan &rest arguments)
  "Run PLAN as RUN-PLAN does, but stop before each expression: see STEP-TASK."
  (let ((*step-plans* t))
    (apply #'run-plan plan arguments)))

;;; Why commands failed.

(defmethod reasons ((robot robot) runner)
  (declare (ignore runner))
  (asking (robot) (failure-sentences robot)))

;; With a runner, a task is meant and no robot.
(defmethod reasons ((name symbol) runner)
  (if (or runner (null name))
      (call-next-method)
      (reasons (find-robot name) nil)))

(defmethod reasons ((name string) runner)
  (if runner
      (call-next-method)
      (reasons (find-robot name) nil)))

(defmethod reasons ((part part) runner)
  (declare (ignore runner))
  (asking (part) (failure-sentences part)))

(defun robot-that-failed-last (simulation)
  "Return the robot of SIMULATION whose command failed last, or else the default robot."
  (flet ((tick-of-failure (robot) (or (getf (last-failure robot) :tick) -1)))
    (loop with last = (resolve-robot nil 'why)
          for robot in (simulation-robots simulation)
          when (> (tick-of-failure robot) (tick-of-failure last)) do (setf last robot)
          finally (return last))))

(defmethod reasons ((subject null) runner)
  (if runner
      (call-next-method)
      (reasons (robot-that-failed-last (current-simulation)) nil)))
