;;;; history.lisp -- asking a trace what became of a task: its entries, failures and commands.

(in-package :ars-magna.rpl.seeing)

;;; All of these take a task, over or not, or the number of one, and its runner if that is not the
;;; one in use; and signal MISUSE where no trace was kept.

(defun trace-to-read (which runner)
  "Return the trace that tells of WHICH, a task or a number, and that number."
  (check-argument trace-of which (typep which '(or null task (integer 1)))
                  "a task, as begin-plan returns, or the number of one")
  (let ((runner (or runner (runner-to-see which))))
    (values (or (call-with-client-still (runner-client runner) (lambda () (plan-trace runner)))
                (reject-use "No trace was kept of these plans. Set *trace-plans* to true before ~
                             they start."))
            (if (task-p which) (task-serial which) which))))

(defun start-of (number trace)
  "Return the entry of TRACE for the start of the task NUMBER. Signals MISUSE."
  (or (find-if (lambda (entry)
                 (and (= number (trace-entry-task entry)) (eq :start (trace-entry-event entry))))
               trace)
      (reject-use "There was no task ~A in this trace." number)))

(defun ancestry (number trace)
  "Return the entries of TRACE for the starts of the task NUMBER and of those that it is part of,
innermost first. Signals MISUSE."
  (loop for each = number then (trace-entry-value start)
        while each
        for start = (start-of each trace)
        collect start))

(defun family (number trace)
  "Return a predicate of numbers: those of the task NUMBER of TRACE and of all its parts."
  (let ((members (make-hash-table)))
    (setf (gethash number members) t)
    (loop for entry across trace
          when (and (eq :start (trace-entry-event entry))
                    (gethash (trace-entry-value entry) members))
            do (setf (gethash (trace-entry-task entry) members) t))
    (lambda (number) (gethash number members))))

(defun call-of-p (form operator)
  (and (consp form) (symbolp (first form)) (same-name-p operator (first form))))

(addition trace-of)
(defun trace-of (which &key event form runner)
  "Return a list of the trace entries of WHICH and of the tasks that it consisted of, in order.
WHICH is a task, also one that is over, or its number, or NIL for all. EVENT, if given, is an event
or a list of some, FORM the name of an operator: then only entries of these events, and at calls of
that. The RUNNER is that of the task, or the one in use. Signals MISUSE if no trace was kept."
  (multiple-value-bind (trace number) (trace-to-read which runner)
    (let ((member-p (if number (family number trace) (constantly t))))
      (loop for entry across trace
            when (and (funcall member-p (trace-entry-task entry))
                      (or (null event) (member (trace-entry-event entry) (ensure-list event)))
                      (or (null form) (call-of-p (trace-entry-form entry) form)))
              collect entry))))

(addition task-history)
(defun task-history (task &key runner)
  "Return a list of the trace entries of TASK, a task or its number, alone, in order. See TRACE-OF."
  (multiple-value-bind (trace number) (trace-to-read task runner)
    (loop for entry across trace
          when (eql number (trace-entry-task entry)) collect entry)))

(addition task-failures)
(defun task-failures (which &key runner)
  "Return a list of the failures that happened in WHICH and its parts, also those that were
handled, in order. See TRACE-OF."
  (mapcar #'trace-entry-subject (trace-of which :event :failure :runner runner)))

(defun answer-to (issue trace)
  (find-if (lambda (entry)
             (and (eq :answer (trace-entry-event entry)) (eq issue (trace-entry-subject entry))))
           trace :from-end t))

(addition task-commands)
(defun task-commands (which &key runner)
  "Return a list of the commands that WHICH and its parts have issued, in order. Each is a property
list: :tick, :command (name and arguments), :task (the number of the one that issued it), :for (the
expressions of the plan that were under way, innermost first, the tasks around it included),
:answered (the tick of the last answer, NIL if there was none) and :error (its code). See
TRACE-OF."
  (let ((trace (trace-to-read which runner)))
    (loop for entry in (trace-of which :event :command :runner runner)
          for issue = (trace-entry-subject entry)
          for answer = (answer-to issue trace)
          collect (list :tick (trace-entry-tick entry)
                        :command (cons (issue-name issue) (issue-arguments issue))
                        :task (trace-entry-task entry)
                        :for (apply #'append (trace-entry-value entry))
                        :answered (and answer (trace-entry-tick answer))
                        :error (and answer (trace-entry-value answer))))))

(addition task-ancestry)
(defun task-ancestry (task &key runner)
  "Return a list of TASK, a task or its number, and those that it is part of, up to the plan
itself: for each a list of its number, its name or NIL, and its expression. See TRACE-OF."
  (multiple-value-bind (trace number) (trace-to-read task runner)
    (loop for start in (ancestry number trace)
          collect (list (trace-entry-task start) (trace-entry-subject start)
                        (trace-entry-form start)))))
