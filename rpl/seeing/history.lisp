;;;; history.lisp -- reading a trace: failures and commands of a task, bars over time.

(in-package :ars-magna.rpl.seeing)

(export '(bar bar-label bars span))

;;; All of these take a task, over or not, or the number of one, and its runner if that is not the
;;; one in use; and signal MISUSE where no trace was kept.

(defun trace-to-read (which runner)
  "Return the trace of the task WHICH, and its number. WHICH is a task or number, or NIL for all."
  (check-argument trace-of which (typep which '(or null task (integer 1)))
                  "a task, as begin-plan returns, or the number of one")
  (let ((runner (or runner (runner-to-show which))))
    (values (or (call-with-client-still (runner-client runner) (lambda () (plan-trace runner)))
                (reject-use "No trace was kept of these plans. Set *trace-plans* to true before ~
                             they start."))
            (if (task-p which) (task-serial which) which))))

(defun start-entry (number trace)
  "Return the entry of TRACE for the start of the task NUMBER. Signals MISUSE."
  (or (find-if (lambda (entry)
                 (and (= number (trace-entry-task entry)) (eq :start (trace-entry-event entry))))
               trace)
      (reject-use "This trace has no task ~A. (trace-of nil) returns all its entries." number)))

(defun ancestor-entries (number trace)
  "Return the entries of TRACE for the starts of task NUMBER and tasks around it, innermost first."
  (loop for each = number then (trace-entry-value start)
        while (integerp each)
        for start = (start-entry each trace)
        collect start))

(defun descendant-test (number trace)
  "Return a predicate on numbers of tasks: true for the task NUMBER of TRACE and all its parts."
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
  "Return a list of the trace entries of WHICH and its parts, in order. WHICH is a task, which may
be over, or its number; NIL for all. If EVENT is an event or a list of events, return only entries
of these. If FORM names an operator, return only entries at calls of it. RUNNER is a plan runner, by
default the task's, or else the one in use. Signals MISUSE if no trace was kept."
  (multiple-value-bind (trace number) (trace-to-read which runner)
    (let ((member-p (if number (descendant-test number trace) (constantly t))))
      (loop for entry across trace
            when (and (funcall member-p (trace-entry-task entry))
                      (or (null event) (member (trace-entry-event entry) (ensure-list event)))
                      (or (null form) (call-of-p (trace-entry-form entry) form)))
              collect entry))))

(addition task-history)
(defun task-history (task &key runner)
  "Return a list of the trace entries of TASK itself, a task or its number, in order. See TRACE-OF."
  (multiple-value-bind (trace number) (trace-to-read task runner)
    (loop for entry across trace
          when (eql number (trace-entry-task entry)) collect entry)))

(addition task-failures)
(defun task-failures (which &key runner)
  "Return the failures in WHICH and its parts, in order, handled failures included. See TRACE-OF."
  (mapcar #'trace-entry-subject (trace-of which :event :failure :runner runner)))

(defun answer-entry (issue trace)
  (find-if (lambda (entry)
             (and (eq :answer (trace-entry-event entry)) (eq issue (trace-entry-subject entry))))
           trace :from-end t))

(addition task-commands)
(defun task-commands (which &key runner)
  "Return a list of the commands that WHICH and its parts have issued, in order. See TRACE-OF. Each
is a property list:
  :tick      when it was issued
  :command   its name and arguments
  :task      the number of the task that issued it
  :for       the plan's expressions in progress, innermost first, those of tasks around it included
  :answered  the tick of the last answer; NIL if there was none
  :error     its error code"
  (let ((trace (trace-to-read which runner)))
    (loop for entry in (trace-of which :event :command :runner runner)
          for issue = (trace-entry-subject entry)
          for answer = (answer-entry issue trace)
          collect (list :tick (trace-entry-tick entry)
                        :command (cons (issue-name issue) (issue-arguments issue))
                        :task (trace-entry-task entry)
                        :for (apply #'append (trace-entry-value entry))
                        :answered (and answer (trace-entry-tick answer))
                        :error (and answer (trace-entry-value answer))))))

(addition task-ancestry)
(defun task-ancestry (task &key runner)
  "Return a list for TASK, a task or its number, and the tasks around it, up to the plan itself.
Each element is a list of number, name or NIL, and expression. See TRACE-OF."
  (multiple-value-bind (trace number) (trace-to-read task runner)
    (loop for start in (ancestor-entries number trace)
          collect (list (trace-entry-task start) (trace-entry-subject start)
                        (trace-entry-form start)))))

;;;; Bars over time

(define-record (span (:constructor make-span (kind start text &optional end)))
  "A period (ticks START to END) in which a task waits, is blocked, cleans up or runs a command."
  (kind :waiting keyword "what a span is of: :waiting, :parts (waiting for them), :blocked,
:cleaning, :failure (it takes no time) or :command" :export)
  (start 0 real "the tick at which a span begins" :export)
  (text nil t "what was waited for, which failure it was, or the command that was under way, as
text" :export)
  (end nil (or null real) "the tick at which a span ends" :writable :export)
  (error nil t "the error code that ended a command, or NIL" :writable :export)
  (calls '() list
         "the calls of procedures that the command was issued in, outermost first" :writable))

(define-record (bar (:constructor make-bar (serial parent name form start depth
                                            &optional owner)))
  "The period in which a task, or a call of a procedure within a task, was under way. A call has a
bar only if the call issued commands."
  (serial 0 fixnum "the number of the task" :export)
  (parent nil (or null bar) "the bar that contains the bar, or NIL")
  (name nil t "the name of the task, or NIL" :export)
  (form nil t "the expression that the task ran" :export)
  (owner nil (or null string) "the name of the plan's robot, if the run has several robots; NIL for
parts of plans" :export)
  (start 0 real "the tick at which the task started" :export)
  (depth 0 fixnum "of how many tasks the task is part" :export)
  (end nil (or null real) "the tick at which the task ended, or the trace" :writable :export)
  (outcome nil symbol
           "how the task ended, as TASK-STATE says it; NIL if it goes on" :writable :export)
  (failure nil t "the failure of a task that failed, or NIL" :writable :export)
  (spans '() list "the spans of the task, oldest first" :writable :export)
  (commands '() list
            "the spans of the commands that the task issued, oldest first" :writable :export)
  (parts '() list
         "the bars of the tasks that were parts of the task, oldest first" :writable :export)
  (call-p nil boolean "the bar is of a call of a procedure, within a task" :writable :export))

(defun bar-label (bar &optional (text #'form-text))
  "Return a label for the task or call of BAR. TEXT is a function that returns text for an
expression, by default a short text."
  (cond ((bar-call-p bar) (funcall text (bar-form bar)))
        ((bar-name bar) (format nil "~D ~(~A~)" (bar-serial bar) (bar-name bar)))
        (t (format nil "~D ~A" (bar-serial bar) (funcall text (bar-form bar))))))

;;; From entries to bars.

(defun close-spans (bar kinds tick)
  (dolist (span (bar-spans bar))
    (when (and (null (span-end span)) (member (span-kind span) kinds))
      (setf (span-end span) tick))))

(defun open-span (bar kind entry)
  (push (make-span kind (trace-entry-tick entry) (trace-entry-detail entry)) (bar-spans bar)))

(defun end-bar (bar outcome tick)
  (close-spans bar '(:waiting :parts :blocked :cleaning) tick)
  (setf (bar-outcome bar) outcome
        (bar-end bar) tick))

(defun add-entry-to-bar (bar entry)
  "Add ENTRY, an entry of the task of BAR, to BAR. Starts and commands are handled elsewhere."
  (let ((tick (trace-entry-tick entry)))
    (case (trace-entry-event entry)
      ;; What decides a construct ends the wait for its parts without a wake-up.
      (:wait (close-spans bar '(:waiting :parts) tick)
       (open-span bar (if (trace-entry-subject entry) :waiting :parts) entry))
      (:wake (close-spans bar '(:waiting :parts) tick))
      (:failure (push (make-span :failure tick (trace-entry-detail entry) tick) (bar-spans bar)))
      (:block (open-span bar :blocked entry))
      (:unblock (close-spans bar '(:blocked) tick))
      (:clean (close-spans bar '(:waiting :parts) tick)
       (open-span bar :cleaning entry))
      (:cleaned (close-spans bar '(:cleaning) tick))
      (:succeed (end-bar bar :succeeded tick))
      (:fail (setf (bar-failure bar) (trace-entry-subject entry))
       (end-bar bar :failed tick))
      (:evaporate (end-bar bar :evaporated tick)))))

(defun begin-bar (entry parent)
  (let ((bar (make-bar (trace-entry-task entry) parent (trace-entry-subject entry)
                       (trace-entry-form entry) (trace-entry-tick entry)
                       (if parent (1+ (bar-depth parent)) 0)
                       (if parent nil (trace-entry-value entry)))))
    (when parent (push bar (bar-parts parent)))
    bar))

(defun plan-calls-in (stack)
  "Return the calls of plan procedures in STACK, outermost first. STACK itself is innermost first."
  (reverse (remove-if-not (lambda (form)
                            (and (consp form)
                                 (symbolp (first form))
                                 (procedure-name-p (first form))))
                          stack)))

(defun begin-command-span (bar entry commands)
  (let* ((issue (trace-entry-subject entry))
         (span (make-span :command (trace-entry-tick entry)
                          (whole-form-text (cons (issue-name issue) (issue-arguments issue))))))
    (setf (span-calls span) (plan-calls-in (first (trace-entry-value entry)))
          (gethash (trace-entry-subject entry) commands) span)
    (push span (bar-commands bar))))

(defun end-command-span (entry commands)
  (let ((span (gethash (trace-entry-subject entry) commands)))
    (when span
      (setf (span-end span) (trace-entry-tick entry)
            (span-error span) (trace-entry-value entry)))))

;;; Calls within a task.

(defun call-at-depth (span depth) (nth depth (span-calls span)))

(defun split-by-call (spans depth)
  "Split SPANS, spans of commands, into lists of successive spans in the same call at DEPTH."
  (loop while spans
        collect (let ((call (call-at-depth (first spans) depth)))
                  (loop while (and spans (eq call (call-at-depth (first spans) depth)))
                        collect (pop spans)))))

(defun call-bar (bar spans depth until)
  "Return a part of BAR for the call at DEPTH that issued SPANS: a bar that ends by the tick UNTIL."
  (let ((call (make-bar (bar-serial bar) bar nil (call-at-depth (first spans) depth)
                        (span-start (first spans)) (1+ (bar-depth bar)))))
    (setf (bar-call-p call) t
          (bar-end call) (min until (reduce #'max spans :key #'span-end))
          (bar-commands call) (remove-if (lambda (span) (call-at-depth span (1+ depth))) spans)
          (bar-parts call) (call-bars call spans (1+ depth)))
    call))

(defun call-bars (bar spans &optional (depth 0))
  "Return parts of BAR: a bar for each call at DEPTH in which commands of SPANS were issued."
  (loop for (run . more) on (split-by-call spans depth)
        when (call-at-depth (first run) depth)
          collect (call-bar bar run depth
                            (if more
                                (span-start (first (first more)))
                                (reduce #'max run :key #'span-end)))))

(defun finish-bar (bar now)
  "Order spans, commands and parts in BAR and its parts, and set missing ends to NOW."
  (unless (bar-end bar) (end-bar bar nil now))
  (setf (bar-spans bar) (nreverse (bar-spans bar))
        (bar-commands bar) (nreverse (bar-commands bar))
        (bar-parts bar) (nreverse (bar-parts bar)))
  (dolist (span (bar-commands bar))
    (unless (span-end span) (setf (span-end span) now)))
  (dolist (part (bar-parts bar)) (finish-bar part now))
  (setf (bar-parts bar) (append (call-bars bar (bar-commands bar)) (bar-parts bar))))

(defun bars (trace &optional now)
  "Return the bars of the plans, top-level tasks, in TRACE, in order of start. The bars of other
tasks are parts of these bars. Bars without an end get the end NOW, by default TRACE's last tick."
  (let ((bars (make-hash-table)) (commands (make-hash-table :test 'eq)) (roots '()) (last 0))
    (loop for entry across trace
          for bar = (gethash (trace-entry-task entry) bars)
          do (setf last (trace-entry-tick entry))
             (case (trace-entry-event entry)
               (:start (setf bar (begin-bar entry (gethash (trace-entry-value entry) bars))
                             (gethash (trace-entry-task entry) bars) bar)
                (unless (bar-parent bar) (push bar roots)))
               (:command (when bar (begin-command-span bar entry commands)))
               (:answer (end-command-span entry commands))
               (t (when bar (add-entry-to-bar bar entry)))))
    (dolist (bar roots) (finish-bar bar (max last (or now last))))
    (nreverse roots)))
