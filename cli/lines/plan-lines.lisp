;;;; plan-lines.lisp -- lines that start, show and stop plans, their tasks and their traces.

(in-package :ars-magna.cli)

(export '(find-plan-named))

;;; Which plan is meant.

(defun find-plan-named (name)
  "Return the plan procedure named NAME, a string: the user's own, or else the newest in any
package. Return NIL if there is no such plan."
  (handler-case (find-procedure (or (find-symbol (string-upcase name)) name))
    (unknown-name () nil)))

(defun plan-names ()
  (remove-duplicates (mapcar #'procedure-name (all-procedures)) :test #'same-name-p))

(defun resolve-plan (name)
  "Return the plan named NAME, or the only one whose name begins with NAME. Signals BAD-LINE."
  (let ((candidates (items-with-prefix (string-upcase name) (plan-names) #'string)))
    (cond ((find-plan-named name))
          ((null candidates) (reject-unknown-name "plan" name (plan-names) "PLAN lists all plans."))
          ((rest candidates) (reject-ambiguous name candidates))
          (t (find-plan-named (string (first candidates)))))))

(define-argument-choices :plan (plan-names))

;;; What plans take.

(defun plan-documentation (plan)
  (or (documentation (procedure-name plan) 'function) "Not documented."))

;; A plan that another plan of its author calls is a part, and not listed.
(defun helper-plans ()
  "Return the plans that are called by other plans of the same package."
  (loop for plan in (all-procedures)
        append (loop for part in (called-procedures plan)
                     unless (or (eq part plan)
                                (not (eq (symbol-package (procedure-name part))
                                         (symbol-package (procedure-name plan)))))
                       collect part)))

(defun write-plan-menu ()
  (let ((parts (helper-plans)))
    (dolist (name (plan-names))
      (let ((plan (find-plan-named (string name))))
        (unless (member plan parts)
          (write-filled (first-full-sentence (plan-documentation plan)) 27
                        (format nil "  ~A" name))))))
  (format t "HELP name shows the arguments of a plan. These plans call other plans,~%~
             which you can start, too.~%"))

(defun write-plan-help (plan)
  (format t "PLAN ~A~%" (plan-usage plan))
  (write-filled (plan-documentation plan) 2))

;;; Starting them.

(defun start-plan-job (job plan arguments)
  (with-lock (*plan-jobs-lock*) (push job *plan-jobs*))
  (handler-bind ((error (lambda (condition)
                          (close-job job)
                          (when (typep condition 'program-error)
                            (reject-line "~A was given ~:[no arguments~;~:*~{~S~^ ~}~]. Usage: ~
                                          PLAN ~A."
                                         (procedure-name plan) arguments (plan-usage plan))))))
    (setf (plan-job-task job) (apply #'begin-plan plan arguments))))

(defun start-plan-in-session (session plan arguments)
  (let ((job (make-plan-job (procedure-name plan) session (current-simulation))))
    (check-run-not-over)
    (setf (session-failure session) nil)
    (pushnew (procedure-name plan) (session-plans session))
    (let ((task (let ((*commanded-robot-hook* #'session-robot))
                  (start-plan-job job plan arguments))))
      (push job (session-jobs session))
      (note-plan-of-line (session-account session) task)
      (when (live-p (plan-job-simulation job)) (start-watching-plan job))
      (unless (waits-for-commands-p session)
        (format t "Plan ~D is under way: ~(~A~).~%" (task-serial task) (procedure-name plan))))))

(defun read-typed-data (text line)
  (loop with position = (skip-blanks text 0)
        until (= position (length text))
        collect (multiple-value-bind (datum end) (read-datum text position line)
                  (setf position (skip-blanks text end))
                  datum)))

(define-line "PLAN" (session (name :plan "the name of a plan" :optional)
                             (args :rest "what the plan takes, not evaluated: no quote is needed"
                                   :optional))
    (:planning)
    "List all plans, or run the plan NAME with ARGS on the robot. In a live run the prompt returns
at once, otherwise when the plan has ended."
  (if name
      (start-plan-in-session session (resolve-plan name)
                             (read-typed-data (or args "") (find-line-command "PLAN")))
      (write-plan-menu)))

;;; Those under way.

(defun text-in-plan-package (name function)
  "Call FUNCTION, which returns text with forms of the plan named NAME. Return the text with few
package prefixes, as an author of the plan would write the forms."
  (let* ((plan (find-plan-named (string name)))
         (*package* (if plan (symbol-package (procedure-name plan)) (user-package)))
         (*print-pretty* nil)
         (text (funcall function)))
    (dolist (prefix '("ars-user::" "ars-worlds::" "ars-worlds:") text)
      (setf text (remove-word prefix text)))))

(defun remove-word (word text)
  "Return TEXT with all occurrences of WORD removed, ignoring case."
  (with-output-to-string (out)
    (loop for start = 0 then (+ end (length word))
          for end = (search word text :start2 start :test #'char-equal)
          do (write-string text out :start start :end end)
          while end)))

(define-line "PLANS" (session) (:planning)
    "Show the running plans as trees of tasks, with what they do and wait for. If the last plan that
ended has failed, tell where and why it failed."
  (let ((plans (plans)))
    (if plans
        (write-string (text-in-plan-package (task-name (first plans))
                                            (lambda ()
                                              (with-output-to-string (out) (print-plans out)))))
        (format t "No plan is under way. PLAN lists all plans.~%")))
  (when (session-failure session)
    (destructuring-bind (failure name) (session-failure session)
      (let ((*message-queue* (make-message-queue)))
        (format t "The last plan failed: ~A~&"
                (text-in-plan-package name (lambda ()
                                             (report-failure failure)
                                             (message-text (first (take-messages))))))))))

(define-line "STOP-PLAN" (session (n count "the number of a running plan" :optional))
    (:planning)
    "End the plan N, or all running plans. Their commands to the robot are interrupted."
  (cond ((null (plans)) (reject-line "No plan is under way."))
        (n (end-plan (or (find n (plans) :key #'task-serial)
                         (reject-line "No plan ~D is under way. PLANS lists the plans." n))))
        (t (end-plan :all))))

;;; PLAN-TREE, WHY and PLAN-TIMELINE: what plans do, and why.

(defun task-tree-text (which)
  "Return the full stacks and variables of WHICH, a task or a plan runner with plans, as text."
  (let ((plan (loop for task = (if (task-p which) which (first (plans))) then (task-parent task)
                    unless (task-parent task) return task)))
    (text-in-plan-package (task-name plan)
                          (lambda ()
                            (with-output-to-string (out)
                              (if (task-p which) (print-tasks which out t) (print-plans out t)))))))

(define-line "PLAN-TREE" (session (n count "the number of a task" :optional)) (:planning)
    "Show all details of the running plans, or of the task N and its parts: each task's stack and
variables, what it waits for and since when; and which task owns which valve."
  (let ((text (call-with-plans-in-use
               (lambda (runner)
                 (let ((which (cond ((null (plans)) nil)
                                    (n (task-numbered n runner))
                                    (t runner))))
                   (and which (task-tree-text which)))))))
    (cond (text (write-string (escape-controls text)))
          ((null (plans)) (reject-line "No plan is under way."))
          (t (reject-line "No task ~D is under way. PLANS lists the tasks." n)))))

(defun task-why-text (n)
  (text-in-plan-package
   (let ((plan (first (plans)))) (and plan (task-name plan)))
   (lambda ()
     (with-output-to-string (out)
       (call-with-plans-in-use (lambda (runner) (why n :runner runner :stream out)))))))

(define-line "WHY" (session (n count "the number of a task" :optional)) (:planning)
    "Explain why the last failed command failed: what was requested and when, what its error code
means and what to try. With N, explain how the task N, running or ended, got where it is: which
fluent woke the task, what set this fluent, and how the task was started. WHY N needs a trace:
TRACE-PLANS ON, or in Lisp (setf *trace-plans* t), before the plan starts."
  (if n
      (write-string (escape-controls (task-why-text n)))
      (let ((robot (session-robot)))
        (with-time-stopped (dolist (sentence (failure-sentences robot))
                             (write-filled sentence 0))))))

(define-line "PLAN-TIMELINE" (session (file :file "a name that ends in .svg or .png"))
    (:planning)
    "Save a timeline of the plans so far in FILE, replacing it. Each task is a bar over ticks, with
what it waited for and the commands that it issued. A trace is needed: TRACE-PLANS ON, or in Lisp
(setf *trace-plans* t), before the plan starts."
  (format t "~A~%" (native-name (save-plan-timeline (path-of-name file)))))

;;; END-TASK, STEP-TASK and TRACE-PLANS: changing running plans.

(define-argument-choices :task-number
  (call-with-plans-in-use
   (lambda (runner) (and runner (mapcar #'task-serial (all-tasks runner))))))

(defun resolve-task (text)
  "Return the running task with the number TEXT. Signals BAD-LINE."
  (unless (plans) (reject-line "No plan is under way."))
  (let ((number (ignore-errors (parse-integer text))))
    (call-with-plans-in-use
     (lambda (runner)
       (or (and number (task-numbered number runner))
           (reject-line "No task ~A is under way. PLANS lists the tasks." text))))))

(defun task-number-and-label (task) (format nil "~D, ~A" (task-serial task) (task-label task)))

(define-line "END-TASK" (session (n :task-number "the number of a running task")) (:planning)
    "End the task N of a plan and its subtasks. The task evaporates, as if its parent no longer
needed it. A stepped task ends without another stop. Commands that the task gave to the robot are
interrupted. STOP-PLAN ends whole plans."
  (let ((task (resolve-task n)))
    (step-task task nil)
    (end-plan task)
    (format t "Task ~A ends.~%" (task-number-and-label task))))

(define-line "STEP-TASK" (session (n :task-number "the number of a running task")
                                  (off :off "OFF ends stepping" :optional))
    (:planning)
    "Single-step the task N and its subtasks: stop before each expression and ask for STEP, NEXT,
OUT or CONTINUE. OFF ends stepping. Without a terminal or window, each stop is only a message."
  (let ((task (resolve-task n)) (on-p (null off)))
    (unless (or on-p (string-equal off "off"))
      (reject-line "After a task number, give OFF or nothing, not ~A." off))
    (step-task task on-p)
    (format t "Task ~A ~:[continues without stopping~;stops when it continues~].~%"
            (task-number-and-label task) on-p)))

(define-line "TRACE-PLANS" (session (switch :switch "ON or OFF" :optional)) (:planning)
    "Trace plans from now on, running plans too. WHY N, PLAN-TIMELINE and the window's timeline need
the trace. OFF stops tracing and discards the trace. Without ON or OFF, tell if plans are traced."
  (when switch
    (let ((on-p (parse-switch "TRACE-PLANS" switch)))
      ;; A plan may hold the lock of all plans: then none is asked, and nothing changes.
      (call-with-plans-in-use
       (lambda (runner)
         (when runner (if on-p (start-trace runner) (stop-trace runner)))))
      (setf *trace-plans* on-p)))
  (format t "~:[No trace of plans is kept~;A trace of plans is kept~].~%" *trace-plans*))
