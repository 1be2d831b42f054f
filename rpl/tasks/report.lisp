;;;; report.lisp -- tasks, failures and the places of tasks, as text.

(in-package :ars-magna.rpl.tasks)

(export '(*plan-end-hooks* report-end report-failure misspelt-handler-text *plan-start-hooks*
          task-state-text write-task-line write-task-tree))

(defun task-state-text (task)
  "Return a text: the state of TASK, and whether TASK evaporates, cleans up or is blocked."
  (let ((blocker (and (not (task-ending-p task))
                      (find-if #'plusp (lineage task) :key #'task-blocked))))
    (format nil "~(~A~)~:[~;, evaporating~]~:[~;, cleaning up~]~@[, blocked~A~]" (task-state task)
            (and (task-ending-p task) (not (task-over-p task)))
            (task-cleaning task)
            (cond ((null blocker) nil)
                  ((eq blocker task) "")
                  (t (format nil " with ~D" (task-serial blocker)))))))

(defun write-task-line (task depth stream)
  "Write a line about TASK to STREAM: its number, its state, what TASK waits for, and since when."
  (format stream "~V@T~D ~A: ~:[~;~:*~(~A~) ~]~A~@[ waits for ~A~]~@[ since tick ~D~]~%"
          (* 2 depth) (task-serial task) (task-state-text task)
          (and (task-name task) (task-label task)) (form-text (task-form task)) (task-awaits task)
          (and (task-awaits task) (task-since task))))

(defun write-task-tree (task depth stream &optional write-more)
  "Write TASK and its parts to STREAM, each on a line. If WRITE-MORE is given, call it for each task
with the task, a column and STREAM."
  (write-task-line task depth stream)
  (when write-more (funcall write-more task (+ 4 (* 2 depth)) stream))
  (dolist (child (task-children task))
    (write-task-tree child (1+ depth) stream write-more)))

;;; Failures.

(defun brief-failure-text (failure)
  (cut (failure-text failure) 500))

(defun write-first-items (control items stream)
  "Write the first 30 of ITEMS to STREAM, each by the format string CONTROL, and how many are left."
  (let ((more (nthcdr 30 items)))
    (dolist (item (ldiff items more)) (format stream control item))
    (when more (format stream "    ... and ~D more~%" (length more)))))

(defun handler-ended-text (failure)
  (and (failure-passed-on-by failure)
       (format nil "the handler for ~A ended without (return ...) or (retry), so the failure ~
                    propagated"
               (form-text (failure-passed-on-by failure)))))

(defun clause-types (form)
  (and (operator-called-p form "HANDLE-FAILURE" "WITH-FAILURE-HANDLING")
       (loop for (type) in (remove-if-not #'consp (ensure-list (second form)))
             append (remove-if-not #'symbolp (ensure-list type)))))

(defun probable-misspelling-p (type class)
  "True if the symbol TYPE may be a misspelt CLASS. The names differ in the ending, as STUCK and
STUCKED, or in a few letters and not only in digits; or they are equal and only one is a keyword."
  (flet ((letters (name) (remove-if #'digit-char-p (symbol-name name)))
         (ending-p (short long)
           (and (<= 4 (length short))
                (<= (length long) (+ 3 (length short)))
                (starts-with-subseq short long :test #'char-equal))))
    (let ((own (letters type)) (other (letters class)))
      (if (string-equal type class)
          ;; A keyword does not mean a condition type.
          (not (eq (keywordp type) (keywordp class)))
          (and (string-not-equal own other)
               (or (misspelling-p type class) (ending-p own other) (ending-p other own)))))))

(defun misspelt-handler-type (failure)
  "Return the type of a handler clause around FAILURE that was probably meant for the class of
FAILURE, and this class; or NIL."
  (let* ((own (failure-class failure))
         (class (if (and own (symbolp own)) own (type-of failure))))
    (loop for form in (failure-plan-backtrace failure)
          for type = (find-if (lambda (type) (probable-misspelling-p type class))
                              (clause-types form))
          when type return (values type class))))

(defun handler-type-for-errors (failure)
  "If FAILURE is not from a Lisp error, return the type of a handler clause around FAILURE that
matches Lisp errors; otherwise NIL."
  (unless (typep failure 'lisp-failure)
    (loop for form in (failure-plan-backtrace failure)
          thereis (find-if (lambda (type)
                             (and type (find-class type nil) (subtypep type 'error)))
                           (clause-types form)))))

(defun misspelt-handler-text (failure)
  "Return a text about a clause around FAILURE for a similar class or for Lisp errors; or NIL."
  (multiple-value-bind (type class) (misspelt-handler-type failure)
    (let ((error-type (handler-type-for-errors failure)))
      (cond (type (format nil "a clause is for ~(~S~), but the class of the failure ~
                               is ~(~S~)" type class))
            (error-type
             (format nil "a clause is for ~(~S~), which matches Lisp errors but not failures from ~
                          FAIL; write ~(~S~) or T" error-type (or (failure-class failure) t)))))))

(defun write-failure-report (failure stream)
  (format stream "~A~%  at tick ~D in ~A~%  task: ~A~%"
          (brief-failure-text failure) (failure-tick failure) (form-text (failure-form failure))
          (cut (format nil "~{~A~^ > ~}" (failure-task-path failure)) 500))
  (format stream "  plan:~%")
  (write-first-items "    ~A~%" (mapcar #'form-text (failure-plan-backtrace failure)) stream)
  (when (failure-cause failure)
    (format stream "  while handling: ~A~%" (brief-failure-text (failure-cause failure))))
  (format stream "~@[  ~A~%~]~@[  ~A~%~]"
          (handler-ended-text failure) (misspelt-handler-text failure))
  (write-first-items "  and in a cleanup: ~A~%"
                     (mapcar #'brief-failure-text (failure-suppressed failure)) stream)
  (when (and (typep failure 'lisp-failure) (string/= "" (lisp-failure-backtrace failure)))
    (format stream "  Lisp:~%~A" (cut (lisp-failure-backtrace failure) 4000))))

(defun one-line-failure-text (failure)
  "Return a description of FAILURE in one line: the failure, its tick, its place and its cause."
  (format nil "~A~@[ at tick ~D~]~@[ in ~{~A~^ < ~}~]~@[, after ~A~]~
               ~@[; ~A~]~@[; ~A~]"
          (one-line (brief-failure-text failure))
          (failure-tick failure)
          (mapcar (lambda (form) (form-text form 40)) (failure-plan-backtrace failure))
          (and (failure-cause failure) (one-line (brief-failure-text (failure-cause failure))))
          (handler-ended-text failure)
          (misspelt-handler-text failure)))

;; What a REPL shows of the value of a plan that failed.
(defmethod print-object ((failure plan-failure) stream)
  (if *print-escape*
      ;; The story prints the failure, too, which is no circle.
      (let ((*print-circle* nil))
        (print-unreadable-object (failure stream)
          (write-string (cut (one-line-failure-text failure) 600) stream)))
      (call-next-method)))

(defun report-failure (failure &optional awaited-p subject)
  "Queue an error message about FAILURE, the failure of a plan. The message has the place and task
of the failure, the expressions in progress, and the Lisp backtrace of an error. In a run of several
robots, a USER-CODE-ERROR names *REPORTED-ROBOT*. If AWAITED-P is true, the caller also learns of
the failure. SUBJECT is a text for what has failed, such as \"The goal (go 3)\", if not the plan."
  (let ((text (with-output-to-string (stream) (write-failure-report failure stream))))
    (if awaited-p
        (queue-message (make-message :error (list text) :told-p (not (typep failure 'lisp-failure)))
                       *message-queue*)
        (queue-user-error failure
                          (format nil "~@[~A~]~:*~:[The plan ~A~;~*~]~@[ of ~A~] failed: ~A" subject
                                  (first (failure-task-path failure))
                                  (robot-text (funcall *get-reporting-run*) *reported-robot*)
                                  (brief-failure-text failure))
                          text))))

(define-event *plan-start-hooks*
  "Functions, or their names, to call with each top-level task before it runs.")

(define-event *plan-end-hooks*
  "Functions, or their names, to call with each top-level task that has ended. The first function
that returns true is responsible for reporting a failure of the task. The functions are called in
any thread that lets plans react.")

(defun report-end (task &optional awaited-p)
  "TASK, a top-level task, has ended. If it has failed, report that. AWAITED-P: see REPORT-FAILURE."
  (unless (some (lambda (hook) (funcall hook task)) *plan-end-hooks*)
    (when (eq (task-state task) :failed)
      (report-failure (task-result task) awaited-p))))

;;; A place is a list. First comes the plan: its name, its number, or (name number) if several plans
;;; of that name are under way. Then, for each step inwards, which part: (:tag name), or the number
;;; of the branch, from 0. It stays true when the task is over.

(defun top-place (task)
  (cond ((null (task-name task)) (task-serial task))
        ((find (task-name task) (remove task (runner-roots (task-runner task))) :key #'task-name)
         (list (task-name task) (task-serial task)))
        (t (task-name task))))

(defun readable-name (task)
  "Return the name of TASK, or its text if the name is no symbol; NIL if TASK has none."
  (let ((name (task-name task)))
    (if (symbolp name) name (task-label task))))

(defun part-place (task)
  (let ((name (readable-name task)))
    (cond ((null name) (task-index task))
          ((find name (remove task (task-children (task-parent task))) :key #'task-name)
           (list :tag name (task-index task)))
          (t (list :tag name)))))

(addition task-place)
(defun task-place (task)
  "Return the place of TASK in its plan, a list that can be printed, read, and given to FIND-TASK.
The first element is the name or number of the plan. An element for each step inwards follows: (:tag
name), or the number of the branch, from 0. Among tasks of the same name, the number of the task
comes after the name. A task that has not started has no place: the value is NIL. (CRAM's paths go
from the inside to the outside, and have the names of operators.)"
  (check-argument task-place task (task-p task) "a task, as begin-plan returns")
  (unless (eq (task-state task) :created)
    (destructuring-bind (top . parts) (reverse (lineage task))
      (cons (top-place top) (mapcar #'part-place parts)))))

(defun at-place-p (task step)
  (typecase step
    (integer (= step (if (task-parent task) (task-index task) (task-serial task))))
    ((cons (eql :tag) (cons t list))
     (and (at-place-p task (second step))
          (or (null (cddr step)) (eql (third step) (task-index task)))))
    ((cons symbol (cons integer null))
     (and (at-place-p task (first step)) (= (second step) (task-serial task))))
    ((or symbol string) (and step (task-name task) (same-name-p step (readable-name task))))))

(addition find-task)
(defun find-task (place &optional (within *runner*))
  "Return the running or waiting task at PLACE, a value of TASK-PLACE or the number of a task; NIL
if there is no such task. WITHIN is a plan runner, or a task; PLACE then starts at its parts."
  (check-argument find-task within (or (task-p within) (plan-runner-p within))
                  "a plan runner, such as (rpl-runner), or a task")
  (if (integerp place)
      (find place (mapcan #'all-tasks (direct-subtasks within)) :key #'task-serial)
      (loop with tasks = (direct-subtasks within)
            for (step . more) on place
            for task = (find-if (lambda (task) (at-place-p task step)) tasks)
            while (and task more) do (setf tasks (task-children task))
            finally (return task))))

(defun direct-subtasks (within)
  (if (task-p within) (task-children within) (plan-runner-tasks within)))

(addition task-source)
(defun task-source (task)
  "Return the source of all code that TASK runs, as data. The source of a branch is its form. The
source of a top-level task is the text of its plan, as PROCEDURE-SOURCE returns it. If the plan has
no name or has been redefined meanwhile, return only the plan's body."
  (check-argument task-source task (task-p task) "a task, as begin-plan returns")
  (let ((procedure (and (null (task-parent task))
                        (find (task-node task) (all-procedures) :key #'procedure-body))))
    (if procedure
        (procedure-source procedure)
        (node-form (task-node task)))))
