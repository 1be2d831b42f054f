;;;; processes.lisp -- other programs and the variables of the environment.

(in-package :ars-magna.base)

(defun environment-value (name)
  "Return the value of the environment's variable called NAME, a string, or NIL if it is not set."
  (uiop:getenv name))

(defun real-microseconds ()
  "Return the real time in microseconds since some moment. No result may depend on it."
  ;; What Lisp itself has for that goes on in steps of 4000.
  (multiple-value-bind (seconds microseconds) (sb-ext:get-time-of-day)
    (+ (* 1000000 seconds) microseconds)))

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

(defun run-attached (program arguments)
  "Run PROGRAM, looked for where programs are, with the strings ARGUMENTS: it reads and writes what
this process would. Wait for its end; if this is left, or this process is killed, it is told to end.
Return its exit status, as of a shell, or NIL if no program can be run."
  (let ((process (handler-case (uiop:launch-program
                                (list* "sh" "-c" *tied-start* "sh" program arguments)
                                :input :interactive :output :interactive
                                :error-output :interactive)
                   (error () (return-from run-attached nil))))
        (status nil))
    (unwind-protect (setf status (uiop:wait-process process))
      (unless status
        (uiop:terminate-process process)
        (uiop:wait-process process)))))
