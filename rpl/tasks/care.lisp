;;;; care.lisp -- failures, errors and interrupts: what happens to the task and its runner.

(in-package :ars-magna.rpl.tasks)

(export '(*failure-hooks* failure-of plan-backtrace operator-called-p leave-plan))

(defun operator-called-p (form &rest names)
  "True if FORM, a form of plan text, has an operator with the name of one of NAMES."
  (and (typep form '(cons symbol)) (member (first form) names :test #'string=)))

(defun plan-backtrace (task frame)
  "Return the expressions in progress in TASK at FRAME and in the tasks around it, innermost first."
  (nconc (forms-under-way frame)
         (loop for whole in (rest (lineage task)) nconc (forms-under-way (task-frame whole)))))

(defun handled-failure (task frame)
  "Return the failure that TASK at FRAME, or a task around TASK, is handling or cleaning up after."
  (loop for each in (frames-around task frame)
        when (typep (frame-data each) 'plan-failure) return (frame-data each)))

(define-event *failure-hooks*
  "Functions to call when a failure happens, with the failure, its task and its frame.")

(defun failure-of (condition task frame)
  "Return the failure for CONDITION, an error of TASK at FRAME, with all data of a failure. Count
the failure as steps that would take as long, so that a plan that only fails uses its slice up."
  (let ((failure (if (typep condition 'plan-failure)
                     condition
                     (make-condition 'lisp-failure :condition condition
                                                   :backtrace (lisp-backtrace)))))
    (unless (failure-task-path failure)
      (count-slow-step (if (typep failure 'lisp-failure) 5000 200) (task-agent task) task)
      (setf (failure-task-path failure) (task-path task)
            (failure-tick failure) (runner-tick (task-runner task))
            (failure-plan-backtrace failure) (plan-backtrace task frame)
            (failure-form failure) (first (failure-plan-backtrace failure))
            (failure-cause failure) (or (failure-cause failure) (handled-failure task frame)))
      (note-event task :failure failure)
      (note-plan-trouble (task-client task) task failure)
      (call-listeners *failure-hooks* failure task frame))
    failure))

(defun lisp-backtrace ()
  "Return a text of the Lisp calls in progress, in a plan whose code has just signalled an error."
  (let* ((calls (calls-in-progress))
         (signalled (member-if (lambda (name) (and (symbolp name) (string= "%SIGNAL" name)))
                               calls :key #'first)))
    (with-output-to-string (stream)
      (loop for call in (if signalled (rest signalled) calls)
            for number from 0
            until (member (first call) '(run-steps step-leaf call-to-outcome))
            do (format stream "    ~D: ~A~%" number (form-text call 100))))))

(defmethod value-to-pass-text ((task task))
  "BEGIN-PLAN returns the task of a plan that goes on; RUN-PLAN returns the values of a plan.")

;;; An interrupt from outside, such as Control-C or a time limit, may leave a reaction at any point,
;;; even between two changes that belong together. Only what tasks contain is reliable then: their
;;; parents, states and frames. Everything else, such as queues, timers and watchers, is rebuilt.

(defun repair-part-links (task)
  "Return TASK and its parts that are not over, and repair the links between them."
  (let ((children (loop for child = (task-newest-child task) then (task-older child)
                        repeat 1000000
                        while child
                        when (and (eq task (task-parent child)) (not (task-over-p child)))
                          collect child)))
    (setf (task-newest-child task) (first children))
    (loop for (child older) on children
          for newer = nil then previous
          for previous = child
          do (setf (task-older child) older
                   (task-newer child) newer))
    (cons task (mapcan #'repair-part-links children))))

(defun empty-queues (agent)
  (loop for ring across (agent-rings agent)
        do (fill (ring-items ring) nil)
           (setf (ring-start ring) 0
                 (ring-count ring) 0))
  (setf (agent-mask agent) 0
        (agent-held agent) '()
        (agent-spent agent) '()
        (agent-blocks agent) 0))

(defun repair-queues (runner tasks)
  "Rebuild the ready queues of RUNNER from TASKS, all its tasks. Only ready tasks are queued."
  (mapc #'empty-queues (runner-agents runner))
  (setf (runner-notices runner) '())
  (dolist (task tasks) (incf (agent-blocks (task-agent task)) (task-blocked task)))
  (dolist (task tasks)
    (when (or (eq :running (task-state task)) (pending-notice-p (task-awaiting task)))
      (setf (task-awaiting task) nil
            (task-state task) :ready))
    (when (eq :ready (task-state task)) (make-ready task))))

(defun repair-timers (runner tasks)
  "Rebuild RUNNER's timers from its old timers and the timers of TASKS. Drop timers of ended tasks."
  (let* ((heap (timers-heap (runner-timers runner)))
         (timers (remove-duplicates (append (coerce heap 'list)
                                            (mapcar #'task-timer tasks)
                                            (mapcar #'task-awaiting tasks))
                                    :test #'eq)))
    (setf (fill-pointer heap) 0)
    (dolist (timer timers)
      (when (timer-p timer)
        (setf (timer-place timer) nil)
        (unless (and (task-p (timer-client timer)) (task-over-p (timer-client timer)))
          (vector-push-extend timer heap)
          (sift-up timer (1- (fill-pointer heap)) heap))))))

(defun own-watchers (task)
  (remove-if-not #'watcher-p
                 (cons (task-awaiting task)
                       (mapcar #'frame-data (frame-chain (task-frame task))))))

(defun repair-watchers (runner tasks)
  "Register the waits of TASKS of RUNNER with their fluents again. Wake tasks that missed events."
  (repair-fluents runner (mapcan #'own-watchers tasks)
                  (lambda (watcher)
                    (let ((client (watcher-client watcher)))
                      (and (task-p client) (task-over-p client)))))
  (dolist (task tasks)
    (let ((watcher (task-awaiting task)))
      (when (and (watcher-p watcher) (eq :waiting (task-state task)))
        (handler-case (fluent-value (watcher-fluent watcher))
          (error (trouble) (funcall (watcher-wake watcher) watcher nil trouble))
          (:no-error (value) (when value (funcall (watcher-wake watcher) watcher value nil))))))))

(defun finish-ending (task)
  "If TASK was to evaporate or otherwise end after its parts, and no part is left, end TASK."
  (when (and (eq :waiting (task-state task)) (null (task-newest-child task)))
    (cond ((eq :evaporate (task-signal task)) (evaporate-now task))
          ((task-signal task) (make-ready task)))))

(defun repair-runner (runner)
  (setf (runner-roots runner) (remove-if #'task-over-p (runner-roots runner)))
  (let ((tasks (mapcan #'repair-part-links (plan-runner-tasks runner))))
    (repair-queues runner tasks)
    (repair-timers runner tasks)
    (repair-watchers runner tasks)
    (mapc #'finish-ending tasks)
    (dolist (task tasks)
      (when (and (task-ending-p task) (not (task-over-p task))
                 (null (task-signal task)) (null (task-cleaning task)))
        (stop-waiting task)
        (evaporate-with-parts task)))))

;;; An error in a leaf becomes a failure of its task. While *BREAK-ON-USER-ERROR* is true and an
;;; interactive debugger is available, the debugger comes first. Its restarts run the leaf again,
;;; return a value for it, let the task fail, or end the plan. An ABORT ends the plan in which it
;;; happens. A non-local exit from a leaf, as by THROW, ends its plan too.

;;; What happens to the task.

(defun failure-of-current-task (runner condition)
  (let ((task (runner-current runner)))
    (failure-of condition task (task-frame task))))

(defun fail-current-task (runner trouble)
  "Let the running task of RUNNER fail with TROUBLE, a failure or a lack of memory."
  (let ((task (runner-current runner)))
    (when (typep trouble 'storage-condition) (recover-memory trouble))
    (let ((failure (failure-of-current-task runner trouble)))
      (cond ((task-newest-child task)   ; The step was starting parts.
             (setf (task-state task) :waiting)
             (end-with-signal task failure))
            (t (setf (task-signal task) failure)
               (make-ready-first task))))))

(defun end-plan-of-task (task)
  "Evaporate the whole plan of TASK, which is ready, and abandon a cleanup in progress."
  (let ((cleaner (find-if #'task-cleaning (lineage task))))
    (evaporate (task-top task))
    (when (and cleaner (not (task-over-p cleaner))) (give-up-cleanup cleaner))))

(defun end-current-plan (runner)
  "Evaporate the plan of the running task of RUNNER, and abandon a cleanup in progress."
  (let ((task (runner-current runner)))
    (setf (task-signal task) nil)
    (make-ready-first task)
    (end-plan-of-task task)))

(defun report-abort (runner)
  (let ((task (runner-current runner)))
    (about-plan (task)
      (error-set (task-label (task-top task)) " was aborted at " (form-text (task-form task))))))

(defun report-break-in-step (condition runner)
  (let ((task (runner-current runner)))
    (about-plan (task)
      (report-break condition (list (task-label task))))))

(defun repair-after-exit (runner)
  "Repair RUNNER after a non-local exit from a step. The plan that took the step ends."
  (let ((task (running-task runner)))
    (when task
      (setf (task-state task) :ready
            (task-signal task) nil))
    (repair-runner runner)
    (when (and task (not (task-over-p task))) (end-plan-of-task task))))

;;; Calling.

(document-restarts
 'fail-task "Let the plan's task whose code went wrong fail: other branches of the plan go on as
after any failure."
 'leave-plan "End the plan without a message.")

(defun leave-plan ()
  "End the plan whose Lisp code calls this function, and report nothing. Elsewhere just return."
  (let ((restart (find-restart 'leave-plan)))
    (when restart (invoke-restart restart))))

(defun call-with-plan-restarts (agent function fail end leave)
  "Call FUNCTION with AGENT and the restarts FAIL-TASK, LEAVE-PLAN and ABORT, which call FAIL,
LEAVE and END. Any other non-local exit from a step also ends its plan; no retry is possible."
  (declare (type function function fail end leave))
  (labels ((in-step-p (&optional condition)
             (declare (ignore condition))
             (running-task (agent-runner agent)))
           (current () (runner-current (agent-runner agent)))
           (offer-failing (stream)
             (format stream "Let the task ~A fail." (task-label (current))))
           (plan () (task-label (task-top (current))))
           (offer-ending (stream) (format stream "End the plan ~A, with a message." (plan)))
           (offer-leaving (stream)
             (format stream "End the plan ~A, without a message." (plan))))
    (declare (dynamic-extent #'in-step-p #'offer-failing #'offer-ending #'offer-leaving))
    (restart-bind ((fail-task fail :report-function #'offer-failing
                                   :test-function #'in-step-p)
                   (leave-plan leave :report-function #'offer-leaving
                                     :test-function #'in-step-p)
                   (abort end :report-function #'offer-ending
                              :test-function #'in-step-p))
      (let ((*leaving-ends-work-p* #'in-step-p))
        (funcall function agent)))))

;;; The outcome of a step is a keyword:
;;;   :DONE    nothing happened;
;;;   :FAIL    an error or failure, or the restart FAIL-TASK;
;;;   :END     the restart ABORT, or a debugger without a user;
;;;   :LEAVE   the restart LEAVE-PLAN.
;;; There is none if the step is left by another non-local exit, such as THROW.

(defun call-to-outcome (agent function)
  "Call FUNCTION with AGENT. Return three values: the outcome of the step, the value of FUNCTION or
the trouble it met, and whether the step may have stopped inside the simulator's own code."
  (let ((runner (agent-runner agent)) (trouble nil) (anywhere-p nil))
    (block call
      (labels ((meet (outcome) (return-from call (values outcome trouble anywhere-p)))
               (end () (meet :end))
               (leave () (meet :leave))
               (fail ()
                 ;; A failure keeps the backtrace of where it is made. Without room for one, that
                 ;; waits until there is: see FAIL-CURRENT-TASK.
                 (unless (typep trouble '(or plan-failure storage-condition))
                   (setf trouble (failure-of-current-task runner (or trouble (make-failure '())))))
                 (meet :fail))
               (note (condition)
                 (when (signal-to-callers-first condition) (setf anywhere-p t))
                 ;; Without a task, a post is applied; its trouble is the caller's.
                 (when (running-task runner)
                   (setf trouble condition)
                   (when (and *break-on-user-error* (typep condition 'error))
                     (invoke-debugger condition))
                   (fail)))
               (answer (condition somebody-p)
                 (cond (somebody-p (setf (runner-looked-at runner) t)
                                   (note-debugger-waiting))
                       ((not (running-task runner)))
                       ((typep condition 'serious-condition)
                        (setf trouble condition)
                        (fail))
                       (t (report-break-in-step condition runner)
                          (continue-in-user-code condition)
                          (end)))))
        ;; Each step of each task comes by here, so nothing is allocated.
        (declare (dynamic-extent #'end #'leave #'fail #'note #'answer))
        (values :done
                (handler-bind (((or error plan-failure storage-condition) #'note))
                  (answering-debugger (#'answer)
                    (call-with-plan-restarts agent function #'fail #'end #'leave)))
                anywhere-p)))))

(defun call-handling-trouble (agent function)
  "Return FUNCTION's value for AGENT. If a step met trouble, end or fail its task and return NIL."
  (let ((runner (agent-runner agent)) (outcome nil) (result nil) (anywhere-p nil))
    (unwind-protect
         (setf (values outcome result anywhere-p) (call-to-outcome agent function))
      (cond ((null outcome) (repair-after-exit runner))
            ((or anywhere-p (eq outcome :end)) (repair-runner runner))))
    (ecase outcome
      (:done result)
      (:fail (fail-current-task runner result) nil)
      (:end (report-abort runner) (end-current-plan runner) nil)
      (:leave (end-current-plan runner) nil))))
