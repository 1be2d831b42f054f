;;;; report.lisp -- tasks, failures and the places of tasks, as text.

(in-package :ars-magna.rpl.tasks)

(export '(*plan-end-hooks* report-end report-failure missed-text *plan-start-hooks*
          task-state-text write-task-line write-task-tree))

(defun task-state-text (task)
  "Return in words how TASK is: its state, and whether it evaporates, cleans up or is blocked."
  (let ((blocker (and (not (task-ending-p task))
                      (find-if #'plusp (lineage task) :key #'task-blocked))))
    (format nil "~(~A~)~:[~;, evaporating~]~:[~;, cleaning up~]~@[, blocked~A~]" (task-state task)
            (and (task-ending-p task) (not (task-over-p task)))
            (task-cleaning task)
            (cond ((null blocker) nil)
                  ((eq blocker task) "")
                  (t (format nil " with ~D" (task-serial blocker)))))))

(defun write-task-line (task depth stream)
  "Write on a line to STREAM which task TASK is, how it is, and what it waits for and since when."
  (format stream "~V@T~D ~A: ~:[~;~:*~(~A~) ~]~A~@[ waits for ~A~]~@[ since tick ~D~]~%"
          (* 2 depth) (task-serial task) (task-state-text task)
          (and (task-name task) (task-label task)) (form-text (task-form task)) (task-awaits task)
          (and (task-awaits task) (task-since task))))

(defun write-task-tree (task depth stream &optional write-more)
  "Write TASK and its parts to STREAM, on a line each. WRITE-MORE, if given, is called with each of
them, a column and STREAM."
  (write-task-line task depth stream)
  (when write-more (funcall write-more task (+ 4 (* 2 depth)) stream))
  (dolist (child (task-children task))
    (write-task-tree child (1+ depth) stream write-more)))

;;; Failures.

(defun brief-failure-text (failure)
  (cut (failure-text failure) 500))

(defun write-some (control items stream)
  "Write the first 30 of ITEMS by CONTROL, one at a time, and how many more there are."
  (let ((more (nthcdr 30 items)))
    (dolist (item (ldiff items more)) (format stream control item))
    (when more (format stream "    ... and ~D more~%" (length more)))))

(defun passed-on-text (failure)
  (and (failure-passed-on-by failure)
       (format nil "the handler for ~A ended without (return ...) or (retry), so the failure went ~
                    on"
               (form-text (failure-passed-on-by failure)))))

(defun clause-types (form)
  (and (operator-called-p form "HANDLE-FAILURE" "WITH-FAILURE-HANDLING")
       (loop for (type) in (remove-if-not #'consp (ensure-list (second form)))
             append (remove-if-not #'symbolp (ensure-list type)))))

(defun slip-for-p (type class)
  "True if TYPE, a symbol that does not stand for CLASS, may be meant for it: they differ in more
than in digits, perhaps by an ending as in STUCK and STUCKED, or one is a keyword."
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
               (or (resembles-p type class) (ending-p own other) (ending-p other own)))))))

(defun missed-clause (failure)
  "Return the type of a clause around FAILURE that was meant for its class, and that class; or NIL."
  (let* ((own (failure-class failure))
         (class (if (and own (symbolp own)) own (type-of failure))))
    (loop for form in (failure-plan-backtrace failure)
          for type = (find-if (lambda (type) (slip-for-p type class)) (clause-types form))
          when type return (values type class))))

(defun clause-for-errors (failure)
  "Return the type of a clause around FAILURE that is for Lisp errors, if FAILURE is none; or NIL."
  (unless (typep failure 'lisp-failure)
    (loop for form in (failure-plan-backtrace failure)
          thereis (find-if (lambda (type)
                             (and type (find-class type nil) (subtypep type 'error)))
                           (clause-types form)))))

(defun missed-text (failure)
  "Return in words that a clause around FAILURE is for a similar class, or for Lisp errors; or NIL."
  (multiple-value-bind (type class) (missed-clause failure)
    (let ((error-type (clause-for-errors failure)))
      (cond (type (format nil "a clause is for ~(~S~), but the class is ~(~S~)" type class))
            (error-type
             (format nil "a clause is for ~(~S~), which is for errors of Lisp, and no FAIL; write ~
                          ~(~S~) or T" error-type (or (failure-class failure) t)))))))

(defun write-failure-report (failure stream)
  (format stream "~A~%  at tick ~D in ~A~%  task: ~A~%"
          (brief-failure-text failure) (failure-tick failure) (form-text (failure-form failure))
          (cut (format nil "~{~A~^ > ~}" (failure-task-path failure)) 500))
  (format stream "  plan:~%")
  (write-some "    ~A~%" (mapcar #'form-text (failure-plan-backtrace failure)) stream)
  (when (failure-cause failure)
    (format stream "  while handling: ~A~%" (brief-failure-text (failure-cause failure))))
  (format stream "~@[  ~A~%~]~@[  ~A~%~]" (passed-on-text failure) (missed-text failure))
  (write-some "  and in a cleanup: ~A~%"
              (mapcar #'brief-failure-text (failure-suppressed failure)) stream)
  (when (and (typep failure 'lisp-failure) (string/= "" (lisp-failure-backtrace failure)))
    (format stream "  Lisp:~%~A" (cut (lisp-failure-backtrace failure) 4000))))

(defun failure-story (failure)
  "Return FAILURE on a line: what it is, when and where it happened, and its cause."
  (format nil "~A~@[ at tick ~D~]~@[ in ~{~A~^ < ~}~]~@[, after ~A~]~
               ~@[; ~A~]~@[; ~A~]"
          (one-line (brief-failure-text failure))
          (failure-tick failure)
          (mapcar (lambda (form) (form-text form 40)) (failure-plan-backtrace failure))
          (and (failure-cause failure) (one-line (brief-failure-text (failure-cause failure))))
          (passed-on-text failure)
          (missed-text failure)))

;; What a REPL shows of the value of a plan that failed.
(defmethod print-object ((failure plan-failure) stream)
  (if *print-escape*
      ;; The story prints the failure, too, which is no circle.
      (let ((*print-circle* nil))
        (print-unreadable-object (failure stream)
          (write-string (cut (failure-story failure) 600) stream)))
      (call-next-method)))

(defun report-failure (failure &optional awaited-p)
  "Queue an error message about FAILURE, of a plan: where it happened, in which task, the
expressions in progress, and the Lisp backtrace of an error. AWAITED-P: the caller learns of the
failure, too."
  (let ((text (with-output-to-string (stream) (write-failure-report failure stream))))
    (if awaited-p
        (queue-message (make-message :error (list text) :told-p (not (typep failure 'lisp-failure)))
                       *message-queue*)
        (trouble-set failure
                     (format nil "The plan ~A failed: ~A" (first (failure-task-path failure))
                             (brief-failure-text failure))
                     text))))

(define-event *plan-start-hooks*
  "Functions, or their names, called with each top-level task before it runs.")

(define-event *plan-end-hooks*
  "Functions, or their names, called with each top-level task that has ended; the report of its
failure is left to the first that returns true. In any thread that lets plans react.")

(defun report-end (task &optional awaited-p)
  "Report the failure of TASK, a top-level task, if it has just failed. AWAITED-P: a caller waits."
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

(defun part-place (task)
  (let ((name (task-name task)))
    (cond ((null name) (task-index task))
          ((find name (remove task (task-children (task-parent task))) :key #'task-name)
           (list :tag name (task-index task)))
          (t (list :tag name)))))

(addition task-place)
(defun task-place (task)
  "Return where TASK is in its plan, a list that can be printed, read, and given to FIND-TASK: the
name or number of the plan, and for each step inwards (:tag name), or the number of the branch,
from 0. Where tasks have the same name, their number comes after it. A task that has not started is
nowhere: NIL (CRAM's paths go from the inside out, and have the operators' names)."
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
    ((or symbol string) (and step (task-name task) (same-name-p step (task-name task))))))

(addition find-task)
(defun find-task (place &optional (within *runner*))
  "Return the task under way at PLACE, as TASK-PLACE returns, or whose number PLACE is; NIL if there
is none. WITHIN is a plan runner, or a task, whose parts PLACE then starts with."
  (check-argument find-task within (or (task-p within) (plan-runner-p within))
                  "a plan runner, such as (rpl-runner), or a task")
  (if (integerp place)
      (find place (mapcan #'all-tasks (parts-of within)) :key #'task-serial)
      (loop with tasks = (parts-of within)
            for (step . more) on place
            for task = (find-if (lambda (task) (at-place-p task step)) tasks)
            while (and task more) do (setf tasks (task-children task))
            finally (return task))))

(defun parts-of (within)
  (if (task-p within) (task-children within) (plan-runner-tasks within)))

(addition task-source)
(defun task-source (task)
  "Return the source of all that TASK runs, as data: the form of a branch; of a top-level task the
text of its plan, as PROCEDURE-SOURCE does, or, if it has no name or has been defined anew since, of
that plan's body."
  (check-argument task-source task (task-p task) "a task, as begin-plan returns")
  (let ((procedure (and (null (task-parent task))
                        (find (task-node task) (all-procedures) :key #'procedure-body))))
    (if procedure
        (procedure-source procedure)
        (node-form (task-node task)))))
