;;;; processes.lisp -- other programs and the variables of the environment.

(in-package :ars-magna.host)

(export '(environment-value real-microseconds date-and-time run-command run-attached run-filter))

(defun environment-value (name)
  "Return the value of the environment's variable called NAME, a string, or NIL if it is not set."
  (uiop:getenv name))

(defun real-microseconds ()
  "Return the real time in microseconds since some moment. No result may depend on it."
  ;; What Lisp itself has for that goes on in steps of 4000.
  (multiple-value-bind (seconds microseconds) (sb-ext:get-time-of-day)
    (+ (* 1000000 seconds) microseconds)))

(defun date-and-time ()
  "Return the date and the time in UTC, as text. No result may depend on it."
  (multiple-value-bind (second minute hour day month year)
      (decode-universal-time (get-universal-time) 0)
    (format nil "~D-~2,'0D-~2,'0D ~2,'0D:~2,'0D:~2,'0D UTC" year month day hour minute second)))

(defun run-command (program arguments &key input output)
  "Run PROGRAM, looked for where programs are, with the strings ARGUMENTS, and wait for its end.
INPUT is a stream for it to read, :INTERACTIVE to read what this Lisp would, or NIL. Return its exit
status, or NIL if it cannot be run, and as a string what it wrote if OUTPUT is :STRING."
  (handler-case
      (multiple-value-bind (text errors status)
          (uiop:run-program (cons program arguments)
                            :input input :output output :ignore-error-status t
                            :external-format :utf-8)
        (declare (ignore errors))
        (values status text))
    (error () nil)))

(defparameter *tied-start*
  "setpriv --pdeathsig TERM true 2>/dev/null && exec setpriv --pdeathsig TERM \"$@\"; exec \"$@\""
  "What a shell does to run a program that the system tells to end when this process ends, however
it does: where the system can.")

(defun run-tied (program arguments &rest streams)
  "Run PROGRAM, looked for where programs are, with the strings ARGUMENTS and STREAMS, keywords of
UIOP:LAUNCH-PROGRAM. Wait for its end; if this is left, or this process is killed, it is told to
end. Return its exit status, as of a shell, or NIL if no program can be run, and as a string what it
said of errors if STREAMS have that as :STREAM."
  (let ((process (handler-case (apply #'uiop:launch-program
                                      (list* "sh" "-c" *tied-start* "sh" program arguments)
                                      streams)
                   (error () (return-from run-tied nil))))
        (errors (eq :stream (getf streams :error-output)))
        (status nil))
    (unwind-protect
         (let ((text (and errors
                          (uiop:slurp-stream-string (uiop:process-info-error-output process)))))
           (setf status (uiop:wait-process process))
           (values status text))
      (unless status
        (uiop:terminate-process process)
        (uiop:wait-process process))
      (when errors (uiop:close-streams process)))))

(defun run-attached (program arguments)
  "Do as RUN-TIED does with PROGRAM and ARGUMENTS: it reads and writes what this process would.
Return its exit status or NIL."
  (run-tied program arguments
            :input :interactive :output :interactive :error-output :interactive))

(defconstant +not-found+ 127 "The exit status of a shell that finds no program of a name.")

(defun run-filter (program arguments input output)
  "Do as RUN-TIED does with PROGRAM and ARGUMENTS: it reads the string INPUT and writes into the
stream OUTPUT to a file. Return its exit status, or NIL if there is no such program, and as a string
what it said of errors."
  (with-input-from-string (in input)
    (multiple-value-bind (status errors)
        (run-tied program arguments :input in :output output :error-output :stream
                                    :external-format :utf-8)
      (values (if (eql status +not-found+) nil status) errors))))
