;;;; trace.lisp -- what happened to which task, and when.

(in-package :ars-magna.rpl.tasks)

;;; A trace names tasks by number and holds no clock time, so that it is the same on every replay.

(defstruct (trace-entry (:constructor make-trace-entry (tick event task form detail))
                        (:copier nil))
  "At TICK, EVENT (:start, :wait, :wake, :succeed, :fail, :evaporate, :block or :unblock) happened
to the task number TASK at the expression FORM. DETAIL is what it waits for, or why it failed."
  (tick 0 :type real :read-only t)
  (event :start :type keyword :read-only t)
  (task 0 :type fixnum :read-only t)
  (form nil :read-only t)
  (detail nil :read-only t))

(addition trace-entry-tick trace-entry-event trace-entry-task trace-entry-form trace-entry-detail)
(loop for (reader text) in
      '((trace-entry-tick "Return the tick of a trace entry.")
        (trace-entry-event "Return what happened: :start, :wait, :wake, :succeed, :fail,
:evaporate, :block or :unblock.")
        (trace-entry-task "Return the serial number of the task that it happened to.")
        (trace-entry-form "Return the plan's expression that the task was at.")
        (trace-entry-detail "Return what the task waits for, or why it failed, as text, or NIL."))
      do (setf (documentation reader 'function) text))

(defun make-trace ()
  (make-array 64 :adjustable t :fill-pointer 0))

(defun write-trace-entry (entry stream)
  (format stream "~6@A ~(~9A~) ~5D ~A~@[  ; ~A~]~%"
          (trace-entry-tick entry) (trace-entry-event entry) (trace-entry-task entry)
          (form-text (trace-entry-form entry)) (trace-entry-detail entry)))

(addition write-trace)
(defun write-trace (trace destination)
  "Write TRACE, a vector of trace entries, to DESTINATION, a stream or the path of a file that is
written anew: a line with tick, event, task number and expression for each."
  (etypecase destination
    (stream (loop for entry across trace do (write-trace-entry entry destination)))
    ((or string pathname)
     (with-open-file (stream destination :direction :output :if-exists :supersede
                                              :external-format :utf-8)
       (write-trace trace stream)))))
