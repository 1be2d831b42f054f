;;;; scripts.lisp -- ./cli/ars-magna SCRIPT: a batch of lines, and how long it may take.

(in-package :ars-magna.cli)

;;; A script is a batch: each line ends before the next is read; lines and seed determine the run.

(defun script-path (name)
  (let ((path (native-path name)))
    (and (pathname-name path) (existing-path path))))

(defun open-script (name)
  "Return a stream of the lines of the script NAME; - is the standard input."
  (if (string= name "-")
      (make-standard-input *standard-output* t)
      (make-instance 'typed-text
                     :octets (open (or (script-path name)
                                       (reject-usage "There is no script ~A." name))
                                   :external-format :latin-1))))

(defun make-object-console ()
  (make-console (make-instance 'object-stream :stream (console-stream *standard-output*))))

(defun report-session-end (session status)
  "Report SESSION's end with STATUS as a JSON object. Return STATUS, at least 1 if output failed."
  (let ((status (if (console-trouble (session-console session)) (max 1 status) status)))
    (report-object (session-account session) "end" :status status
                                                   :errors (session-errors session))
    status))

;;;; The time limit

;;; A thread watches the session now and then, as another watches a live run (src/time/pacing.lisp).

(defparameter *slow-call-seconds* 3
  "The time in seconds after which a batch reports a call of users' code that has not returned.")

(defconstant +time-limit-status+ 124
  "The status to exit with at a time limit, as that of timeout(1).")

(defparameter *grace-seconds* 3
  "The time in seconds that a session has to end normally after its time limit.")

(defun running-code-text (session calls)
  "Return a text that names the users' code running in SESSION (from CALLS) or else in its live run,
and the number of calls begun so far. While a file is loaded, return only a text that names the
form; NIL if there is nothing to name."
  (let ((simulation (session-simulation session)))
    (cond ((user-calls-origin calls)
           (values (running-code-owner-text calls) (user-calls-count calls)))
          ((user-calls-place calls) (running-code-owner-text calls))
          ((and simulation (live-p simulation)) (users-code-in-progress simulation)))))

(defun watch-for-blocking-code (session calls ended)
  "Report users' code that blocks SESSION, as recorded in CALLS, until ENDED is signalled. Code
blocks if the same call is seen four times, a third of *SLOW-CALL-SECONDS* apart."
  (loop with seen = nil and looks = 0
        until (wait-on-semaphore ended (/ *slow-call-seconds* 3))
        do (multiple-value-bind (whose count) (running-code-text session calls)
             (unless (eql count seen) (setf seen count looks 0))
             (when (and whose count (= 4 (incf looks)))
               (report-with-line-number
                session
                (format nil "~A has not returned for ~D s. Control-C ends ~
                             the batch, and so does the option --time-limit SECONDS."
                        whose *slow-call-seconds*))))))

(defun report-stop (session whose reason)
  (report-with-line-number session (format nil "stopped~@[ in ~A~]: ~A." whose reason)))

(defun end-at-time-limit (session calls thread seconds ended)
  "End SESSION, which THREAD runs, after SECONDS, unless the semaphore ENDED is signalled before. If
the session cannot be ended, end this process."
  (unless (wait-on-semaphore ended seconds)
    (let ((whose (running-code-text session calls)) (said nil))
      (flet ((report-once ()
               (unless (shiftf said t)
                 (report-stop session whose (format nil "the time limit of ~A s is over"
                                                    (plain-number-text seconds))))))
        (interrupt-thread thread (lambda ()
                                   (allowing-interrupts
                                     (report-once)
                                     (throw 'leave +time-limit-status+))))
        (unless (wait-on-semaphore ended *grace-seconds*)
          (report-once)
          (end-process +time-limit-status+))))))

(defun report-running-code-on-interrupt (session calls)
  "Make Control-C report the users' code in SESSION, from CALLS, before it ends this process."
  (setf *before-ending-at-once*
        (lambda ()
          (report-stop session (running-code-text session calls) "Control-C was pressed again"))))

(defun call-with-watchers (session options function)
  "Call FUNCTION, which runs SESSION. Without a terminal, report code that does not return. The time
limit of OPTIONS, if any, ends FUNCTION."
  (let* ((calls (make-user-calls)) (*user-calls* calls)
         (ended (make-semaphore "session ended"))
         (thread (current-thread)) (seconds (option-value :time-limit options)))
    (unless (session-terminal-p session)
      (report-running-code-on-interrupt session calls)
      (start-thread (lambda () (watch-for-blocking-code session calls ended))
                    "watcher of the batch"))
    (when seconds
      (start-thread (lambda () (end-at-time-limit session calls thread seconds ended))
                    "time limit"))
    (unwind-protect (funcall function)
      (signal-semaphore ended)
      (signal-semaphore ended))))
