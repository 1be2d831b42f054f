;;;; main.lisp -- what the saved core of ./cli/ars-magna does.

(in-package :ars-magna.cli)

;;; Interactively, the world is live. A batch without a rate is headless: a fresh world, whose ticks
;;; pass only as its lines need them, so that the same lines and seed give the same run.

(defparameter *default-world* "WATSON" "The world of a prompt that is not told another.")

(defun first-robot (options)
  "Return the name of the robot that OPTIONS ask for."
  (let* ((robot (option-value :robot options))
         (world (option-value :world options (and (null robot) *default-world*)))
         (robots (and world (world-robots-called world))))
    (cond ((null robot) (first robots))
          ((null world) (robot-called robot))
          ((find robot robots :test #'same-name-p))
          (t (reject-line "There is no robot ~A in ~A, but ~{~A~^, ~}." robot world robots)))))

(defun load-files (session files)
  (dolist (file files)
    (call-guarded session (lambda () (load-lisp (or (existing-file file)
                                                    (reject-line "There is no file ~A." file)))))
    (setf (session-lisp-p session) t)))

(defun run-headless (session robot-name seed files)
  "Run the lines of SESSION, a batch, in a fresh world, after loading FILES. Return the robot to go
on with, or NIL."
  (setf (session-next-robot session) nil
        *prompt-robot* robot-name)
  (call-by-name (robots-beside robot-name))
  (call-with-simulation (lambda ()
                          (load-files session files)
                          (run-session session))
                        (robots-beside robot-name)
                        :seed seed :journal t)
  (session-next-robot session))

(defun run-batch (session robot-name options)
  "Run the lines of SESSION, beginning with ROBOT-NAME."
  (loop for files = (option-values :load options) then '()
        for name = robot-name then next
        for next = (run-headless session name (option-value :seed options 0) files)
        while next))

(defun greet (session)
  (let ((simulation (current-simulation)))
    (format (session-console session)
            "ARS MAGNA: ~A in ~A, seed ~D, ~A.~%HELP lists the commands, QUIT leaves.~%"
            (session-robot) (simulation-name simulation) (simulation-seed simulation)
            (rate-text (simulation-rate simulation)))))

(defun run-live (session robot-name options)
  "Run the lines of SESSION in the live world of ROBOT-NAME."
  (apply #'simulator robot-name :rate (option-value :rate options *default-rate*)
                                :display (terminal-p session)
         (when (option-value :seed options) (list :seed (option-value :seed options))))
  (when (terminal-p session) (greet session))
  (load-files session (option-values :load options))
  (run-session session))

(defun plan-lines (options)
  "Return the lines for the plans that OPTIONS ask for."
  (loop for text in (option-values :plan options) collect (format nil "plan ~A" text)))

(defun standard-session (batch lines)
  "Return a session that does LINES and then those of the standard input. If nobody sits there, it
shows what it reads and waits for each command, for a transcript like those of manual E. A batch
that has LINES does not wait for others to be typed."
  (let* ((input (standard-stream 0 :input))
         (piped (not (interactive-stream-p input))))
    (make-session :input (if (and batch lines (not piped)) (make-concatenated-stream) input)
                  :output *standard-output* :batch batch :lines lines
                  :patient (or batch piped) :echo (and piped (not batch)))))

(defun run-prompt (options)
  "Do what OPTIONS say. Return the status to exit with."
  (let ((robot-name (first-robot options))
        (session (standard-session (option-value :batch options) (plan-lines options))))
    (if (and (session-batch-p session) (null (option-value :rate options)))
        (run-batch session robot-name options)
        (run-live session robot-name options))
    (if (and (session-batch-p session) (plusp (session-errors session))) 1 0)))

(defun run-arguments (arguments)
  "Do what ARGUMENTS, a list of strings, say. Return the status to exit with."
  (let ((options (parse-options arguments)))
    (cond ((option-value :list options)
           (when (option-value :world options) (world-robots-called (option-value :world options)))
           (write-worlds)
           0)
          (t (run-prompt options)))))

;;; The process.

(defun give-reason (condition status)
  "Say on the error output what CONDITION says; return STATUS."
  (format *error-output* "ars-magna: ~A~%" (condition-text condition))
  status)

(defun call-for-status (function)
  "Call FUNCTION, which returns a status to exit with; return a status whatever happens."
  (catch 'leave
    (handler-case (funcall function)
      (usage-error (condition) (give-reason condition 2))
      (user-interrupt () 130)
      (error (condition) (give-reason condition 1)))))

(defun main ()
  "Run ./cli/ars-magna: do what the arguments of this process say, and end it. The argument --probe
only asks whether the core starts."
  (when (equal (process-arguments) '("--probe")) (end-process 0))
  (setf *standard-output* (make-console (standard-stream 1 :output)))
  (let ((status (call-for-status (lambda () (run-arguments (process-arguments))))))
    (ignore-errors (finish-output *standard-output*))
    (ignore-errors (finish-output *error-output*))
    (end-process status)))
