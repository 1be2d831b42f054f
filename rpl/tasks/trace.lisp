;;;; trace.lisp -- what tasks wait for, and the trace of events.

(in-package :ars-magna.rpl.tasks)

(export '(awaited-text traced-subject asker-text answer-p trace-so-far))

(defgeneric awaited-text (awaited)
  (:documentation "Return a text of AWAITED, an object that a task waits for.")
  (:method (awaited) (safe-text awaited :escape nil))
  (:method ((fluent fluent)) (fluent-text fluent))
  (:method ((watcher watcher)) (fluent-text (watcher-fluent watcher)))
  (:method ((timer timer))
    (format nil "tick ~D" (timer-due timer))))

(defgeneric traced-subject (awaited)
  (:documentation "Return the object that a trace stores for AWAITED, an object that a task waits
for. The stored object does not refer to tasks.")
  (:method (awaited) awaited)
  (:method ((watcher watcher)) (watcher-fluent watcher))
  (:method ((timer timer)) (timer-due timer)))

(addition task-awaits)
(defun task-awaits (task)
  "Return a text of what TASK waits for, such as a fluent or network, a tick or a valve. Return NIL
if TASK does not wait, or waits for its own parts."
  (and (eq (task-state task) :waiting)
       (task-awaiting task)
       (awaited-text (task-awaiting task))))

;;; A trace names tasks by number and holds no clock time, so that it is the same on every replay.
;;; An entry stores objects; its text is made when it is read.

(define-record (trace-entry (:constructor make-trace-entry
                                (tick event task form subject value asker)))
  "An entry of a trace. At TICK, EVENT happened to the task with the number TASK, at the expression
FORM. If TASK is 0, EVENT happened to no task. ASKER, the cause of the event, is the number of a
task, an ANSWER, or another value of *ASKER*. The event decides what SUBJECT and VALUE are:
  :start: the name, and the number of the parent; of a plan, the name of its robot or NIL
  :wait and :wake: the object that the task waits for
  :succeed: NIL and the value
  :failure (a failure happens) and :fail (a failure ends the task): the failure
  :set and :pulse: the fluent and its value
  :command: an ISSUE and, for the task and each task around it, the expressions in progress
  :answer: the ISSUE and the error code
  :evaporate, :clean, :cleaned, :block and :unblock: nothing"
  (tick 0 real "the tick of a trace entry" :addition)
  (event :start keyword "the event: :start, :wait, :wake, :succeed, :fail, :evaporate, :failure
(handled or not), :clean (a cleanup begins), :cleaned (the last cleanup has ended), :block or
:unblock; :set or :pulse (of a fluent), :command or :answer" :addition)
  (task 0 fixnum "the number of the task of the event; 0 if no task is involved" :addition)
  (form nil t "the expression of the plan that the task was running" :addition)
  (subject nil t "the object that the event is about; its type depends on the event" :export)
  (value nil t "a value that depends on the event: the value of a task that succeeded; the new value
of a fluent; the error code of an answer; for a command, the expressions in progress, a list for the
task and each task around it; at the start of a task, the number of its parent; at the start of a
plan, the name of its robot if the run has several robots" :addition)
  (asker nil t "the cause of the event: a task's number, or another value of *ASKER*" :export))
(declaim-final trace-entry)

(define-record (issue (:constructor make-issue (name arguments task robot)))
  "A command that a task has issued."
  (name nil symbol "the plan function by which a command was issued" :export)
  (arguments '() list "the list of the arguments of the plan function" :export)
  (task 0 fixnum "the number of the task that issued the command" :export)
  (robot nil symbol "the name of the robot that the command was issued to" :export)
  (end-tick nil (or null real) "the tick in which the command ended without an error, or NIL"
            :writable :export))

(define-record (answer (:constructor make-answer (issue error)))
  "The end of a command."
  (issue nil issue "the record of the command that an answer is for" :export)
  (error nil t "the error code of an answer, or NIL" :export))

(defun issue-text (issue)
  (form-text (cons (issue-name issue) (issue-arguments issue))))

(defmethod print-object ((issue issue) stream)
  (print-unreadable-object (issue stream)
    (format stream "~A of task ~D" (issue-text issue) (issue-task issue))))

(defmethod print-object ((answer answer) stream)
  (print-unreadable-object (answer stream)
    (format stream "answer to ~A~@[: ~(~A~)~]" (issue-text (answer-issue answer))
            (answer-error answer))))

(defmethod asker-note ((answer answer))
  (list "the answer to " (issue-text (answer-issue answer))))

(defun asker-text (asker)
  "Return a text of ASKER, the asker of a trace entry."
  (if (integerp asker)
      (format nil "task ~D" asker)
      (cut (one-line (asker-note-text (if asker (asker-note asker) "a program or the REPL"))) 100)))

(defun subject-text (subject)
  (cond ((null subject) nil)
        ((realp subject) (format nil "tick ~D" subject))
        (t (awaited-text subject))))

(addition trace-entry-detail)
(defun trace-entry-detail (entry)
  "Return the details of ENTRY as text, or NIL: what the task waits for, why it failed, which value
a fluent got and from whom, which command was issued, or how a command was answered."
  (let ((subject (trace-entry-subject entry))
        (value (trace-entry-value entry)))
    (case (trace-entry-event entry)
      ((:wait :wake) (subject-text subject))
      ((:failure :fail) (failure-text subject))
      ((:set :pulse) (format nil "~A = ~A, by ~A" (awaited-text subject) (form-text value 40)
                             (asker-text (trace-entry-asker entry))))
      (:command (issue-text subject))
      (:answer (format nil "~A: ~(~A~)" (issue-text subject) (or value "done"))))))

(defmethod print-object ((entry trace-entry) stream)
  (print-unreadable-object (entry stream)
    (format stream "tick ~D, task ~D: ~(~A~)~@[ ~A~]" (trace-entry-tick entry)
            (trace-entry-task entry) (trace-entry-event entry) (trace-entry-detail entry))))

;;; While plans run, an entry is seven elements of a vector, which costs less than an object would.
;;; All vectors but the first are so long that the collector leaves them where they are.

(defun make-chunk (count)
  (make-array count :initial-element 0))

(defstruct (chronicle (:constructor make-trace ()) (:copier nil))
  "A trace in its internal form. CHUNK is filled up to FILL. FULL is a list of the earlier chunks,
each (chunk fill), newest first."
  (chunk (make-chunk 512) :type simple-vector)
  (fill 0 :type (unsigned-byte 32))
  (full '() :type list))
(declaim-final chronicle)
(define-shared-types trace-entry issue)

;; What has been noted is not copied: it is never altered.
(defmethod copy-plan-value ((trace chronicle) fork)
  (let ((copy (record-copy trace (make-trace) fork)))
    (setf (chronicle-full copy) (cons (list (chronicle-chunk trace) (chronicle-fill trace))
                                      (chronicle-full trace)))
    copy))

(defun begin-chunk (trace)
  (push (list (chronicle-chunk trace) (chronicle-fill trace)) (chronicle-full trace))
  (setf (chronicle-chunk trace) (make-chunk 65536)
        (chronicle-fill trace) 0))

(defun add-trace-entry (trace tick event task form subject value)
  "Record in the chronicle TRACE that EVENT happened to task number TASK. The asker is *ASKER*."
  (declare #.*hot* (type chronicle trace))
  (when (> (+ 7 (chronicle-fill trace)) (length (chronicle-chunk trace))) (begin-chunk trace))
  (let ((chunk (chronicle-chunk trace)) (fill (chronicle-fill trace)) (asker *asker*))
    (setf (svref chunk fill) tick
          (svref chunk (+ fill 1)) event
          (svref chunk (+ fill 2)) task
          (svref chunk (+ fill 3)) form
          (svref chunk (+ fill 4)) subject
          (svref chunk (+ fill 5)) value
          (svref chunk (+ fill 6)) (if (task-p asker) (task-serial asker) asker)
          (chronicle-fill trace) (+ fill 7))))

(defun chunk-entries (chunk fill)
  (loop for place from 0 below fill by 7
        collect (apply #'make-trace-entry (coerce (subseq chunk place (+ place 7)) 'list))))

(defun trace-so-far (trace)
  "Return a function of no arguments that returns a vector of the current entries of TRACE, a
chronicle. The second value is the number of these entries. Any thread may call the function at any
time, because recorded entries never change."
  (let ((chunk (chronicle-chunk trace)) (fill (chronicle-fill trace)) (full (chronicle-full trace)))
    (values (lambda ()
              (coerce (append (loop for (chunk fill) in (reverse full)
                                    append (chunk-entries chunk fill))
                              (chunk-entries chunk fill))
                      'simple-vector))
            (floor (reduce #'+ full :key #'second :initial-value fill) 7))))

(defun write-trace-entry (entry stream)
  (format stream "~6@A ~(~9A~) ~5D ~A~@[  ; ~A~]~%"
          (trace-entry-tick entry) (trace-entry-event entry) (trace-entry-task entry)
          (form-text (trace-entry-form entry)) (trace-entry-detail entry)))

(addition write-trace)
(defun write-trace (trace destination)
  "Write TRACE, a vector of trace entries, to DESTINATION, a stream or the path of a file. An
existing file is replaced. Each line has the tick, event, task number and expression of an entry."
  (etypecase destination
    (stream (printing-plainly ()
              (loop for entry across trace do (write-trace-entry entry destination))))
    ((or string pathname)
     (overwrite-file (lambda (out) (write-trace trace out)) destination "the trace"))))
