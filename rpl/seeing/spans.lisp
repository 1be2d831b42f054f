;;;; spans.lisp -- a trace as bars: from when to when each task lived, waited, had commands.

(in-package :ars-magna.rpl.seeing)

(export '(bar bar-call-p bar-commands bar-depth bar-end bar-failure bar-form bar-label
          bar-name bar-outcome bar-parts bar-serial bar-spans bar-start bars span
          span-error span-end span-kind span-start span-text))

(defstruct (span (:constructor make-span (kind start text &optional end)) (:copier nil))
  "From tick START to END of a task: KIND is :waiting (for what TEXT says), :parts (waiting for
them), :blocked, :cleaning, :failure (TEXT says which; it takes no time) or :command (TEXT was under
way; ERROR is what it was answered with, CALLS the calls of procedures that it was issued in,
outermost first)."
  (kind :waiting :type keyword :read-only t)
  (start 0 :type real :read-only t)
  (text nil :read-only t)
  (end nil :type (or null real))
  (error nil)
  (calls '() :type list))

(defstruct (bar (:constructor make-bar (serial parent name form start depth)) (:copier nil))
  "The life of the task SERIAL, at DEPTH, part of the bar PARENT. OUTCOME is :succeeded, :failed,
:evaporated, or NIL if it goes on; then END is the tick of the trace's end. If CALL-P, it is a call
of a procedure within the task, as far as commands were issued in it."
  (serial 0 :type fixnum :read-only t)
  (parent nil :type (or null bar) :read-only t)
  (name nil :read-only t)
  (form nil :read-only t)
  (start 0 :type real :read-only t)
  (depth 0 :type fixnum :read-only t)
  (end nil :type (or null real))
  (outcome nil :type symbol)
  (failure nil)
  (spans '() :type list)
  (commands '() :type list)
  (parts '() :type list)
  (call-p nil :type boolean))

(document-functions
  span-kind "Return what a span is of: :waiting, :parts, :blocked, :cleaning, :failure or
:command."
  span-start "Return the tick at which a span begins."
  span-end "Return the tick at which a span ends."
  span-text "Return what was waited for, or the command that was under way, as text."
  span-error "Return the error code that ended a command, or NIL."
  bar-serial "Return the number of the task."
  bar-name "Return the name of the task, or NIL."
  bar-form "Return the expression that the task ran."
  bar-depth "Return of how many tasks the task is part."
  bar-start "Return the tick at which the task started."
  bar-end "Return the tick at which the task ended, or the trace."
  bar-outcome "Return how the task ended, as TASK-STATE says it; NIL if it goes on."
  bar-failure "Return the failure of a task that failed, or NIL."
  bar-spans "Return the spans of the task, oldest first."
  bar-commands "Return the spans of the commands that the task issued, oldest first."
  bar-call-p "True if the bar is of a call of a procedure, within a task."
  bar-parts "Return the bars of the tasks that the task consisted of, oldest first.")

(defun bar-label (bar &optional (text #'form-text))
  "Return what says which task BAR is of, or which call within a task: a short text, unless the
function TEXT makes another of an expression."
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

;; What decides a construct ends the wait for its parts without a wake-up.
(defun begin-wait (bar entry)
  (close-spans bar '(:waiting :parts) (trace-entry-tick entry))
  (open-span bar (if (trace-entry-subject entry) :waiting :parts) entry))

(defun end-bar (bar outcome tick)
  (close-spans bar '(:waiting :parts :blocked :cleaning) tick)
  (setf (bar-outcome bar) outcome
        (bar-end bar) tick))

(defun note-in-bar (bar entry)
  "Let BAR know of ENTRY, of its task, but for its start and commands."
  (let ((tick (trace-entry-tick entry)))
    (case (trace-entry-event entry)
      (:wait (begin-wait bar entry))
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
                       (if parent (1+ (bar-depth parent)) 0))))
    (when parent (push bar (bar-parts parent)))
    bar))

(defun calls-in (stack)
  "Return the calls of plan procedures among the expressions of STACK, innermost first, outermost
first."
  (reverse (remove-if-not (lambda (form)
                            (and (consp form)
                                 (symbolp (first form))
                                 (procedure-name-p (first form))))
                          stack)))

(defun begin-command (bar entry commands)
  (let* ((issue (trace-entry-subject entry))
         (span (make-span :command (trace-entry-tick entry)
                          (whole-form-text (cons (issue-name issue) (issue-arguments issue))))))
    (setf (span-calls span) (calls-in (first (trace-entry-value entry)))
          (gethash (trace-entry-subject entry) commands) span)
    (push span (bar-commands bar))))

(defun end-command (entry commands)
  (let ((span (gethash (trace-entry-subject entry) commands)))
    (when span
      (setf (span-end span) (trace-entry-tick entry)
            (span-error span) (trace-entry-value entry)))))

;;; Calls within a task.

(defun call-at (span depth) (nth depth (span-calls span)))

(defun runs-of (spans depth)
  "Return SPANS, of commands, as a list of lists: those that follow each other in one call at
DEPTH."
  (loop while spans
        collect (let ((call (call-at (first spans) depth)))
                  (loop while (and spans (eq call (call-at (first spans) depth)))
                        collect (pop spans)))))

(defun call-bar (bar spans depth until)
  "Return the bar, part of BAR, of the call at DEPTH in which the commands SPANS were issued; it
ends before UNTIL."
  (let ((call (make-bar (bar-serial bar) bar nil (call-at (first spans) depth)
                        (span-start (first spans)) (1+ (bar-depth bar)))))
    (setf (bar-call-p call) t
          (bar-end call) (min until (reduce #'max spans :key #'span-end))
          (bar-commands call) (remove-if (lambda (span) (call-at span (1+ depth))) spans)
          (bar-parts call) (call-bars call spans (1+ depth)))
    call))

(defun call-bars (bar spans &optional (depth 0))
  "Return bars, parts of BAR, for the calls at DEPTH in which the commands SPANS were issued."
  (loop for (run . more) on (runs-of spans depth)
        when (call-at (first run) depth)
          collect (call-bar bar run depth
                            (if more
                                (span-start (first (first more)))
                                (reduce #'max run :key #'span-end)))))

(defun finish-bar (bar now)
  "Put what is in BAR, and its parts, in order; what has not ended goes on until NOW."
  (unless (bar-end bar) (end-bar bar nil now))
  (setf (bar-spans bar) (nreverse (bar-spans bar))
        (bar-commands bar) (nreverse (bar-commands bar))
        (bar-parts bar) (nreverse (bar-parts bar)))
  (dolist (span (bar-commands bar))
    (unless (span-end span) (setf (span-end span) now)))
  (dolist (part (bar-parts bar)) (finish-bar part now))
  (setf (bar-parts bar) (append (call-bars bar (bar-commands bar)) (bar-parts bar))))

(defun bars (trace &optional now)
  "Return the bars of the plans, top-level tasks, that TRACE tells of, in order of their start;
those of other tasks are parts of these. What has not ended goes on until the tick NOW, by default
the last of TRACE."
  (let ((bars (make-hash-table)) (commands (make-hash-table :test 'eq)) (roots '()) (last 0))
    (loop for entry across trace
          for bar = (gethash (trace-entry-task entry) bars)
          do (setf last (trace-entry-tick entry))
             (case (trace-entry-event entry)
               (:start (setf bar (begin-bar entry (gethash (trace-entry-value entry) bars))
                             (gethash (trace-entry-task entry) bars) bar)
                (unless (bar-parent bar) (push bar roots)))
               (:command (when bar (begin-command bar entry commands)))
               (:answer (end-command entry commands))
               (t (when bar (note-in-bar bar entry)))))
    (dolist (bar roots) (finish-bar bar (max last (or now last))))
    (nreverse roots)))
