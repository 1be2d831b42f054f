;;;; main.lisp -- what the saved core of ./cli/ars-magna does.

(in-package :ars-magna.cli)

(defparameter *shell-commands*
  '(("experiment" experiment-command)
    ("merge" merge-command)
    ("compare" compare-command)
    ("testbed" testbed-command))
  "Lists (name function) of commands. The function takes the command's arguments, a list of strings,
and returns the exit status. The file usage-NAME.txt describes the command.")

(defun find-shell-command (name)
  (or (find name *shell-commands* :key #'first :test #'string=)
      (reject-usage "There is no command ~A, nor a file of that name.~@[ Did you mean ~A?~] Known: ~
                     ~{~A~^, ~}."
                    name
                    (nearest-name name (mapcar #'first *shell-commands*))
                    (mapcar #'first *shell-commands*))))

(defun run-shell-command (name arguments)
  "Run the command NAME with ARGUMENTS. Return the exit status."
  (let ((command (find-shell-command name)) (*error-output* (text-output-stream 2)))
    (unwind-protect (funcall (second command) arguments)
      ;; Lisp's own output, such as warnings, stays in the stream until then.
      (ignore-errors (finish-output *error-output*)))))

(defun command-usage (name)
  (or (shell-text (format nil "usage-~A.txt" name)) (shell-text "usage.txt")))

;;; The prompt.

(export '(main))

;;; Interactively, the world is live. A batch without a rate is headless: a fresh world, whose ticks
;;; pass only as its lines need them, so that the same lines and seed give the same run.

(defparameter *default-world* "WATSON" "The default world of a prompt.")

(defun robot-name-from-options (options)
  (let* ((robot (option-value :robot options))
         (world (option-value :world options (and (null robot) *default-world*)))
         (robots (and world (robot-names-in-world world))))
    (cond ((null robot) (first robots))
          ((null world) (resolve-robot-name robot))
          ((find-robot-name robot robots))
          (t (reject-line "There is no robot ~A in ~A, but ~{~A~^, ~}." robot world robots)))))

(defun load-files-before-prompt (names)
  "Load the files NAMES before the prompt starts. Signals USAGE-ERROR if one cannot be loaded."
  (dolist (name names)
    (handler-case (load-lisp (find-lisp-file name))
      (ars-magna-error (condition) (reject-usage "~A" (condition-text condition))))))

(defun reject-unknown-names (condition)
  "Signal USAGE-ERROR for CONDITION, a BAD-LINE about a name of a world or robot in the options."
  (reject-usage "~A --list lists the worlds and their robots." (bad-line-text condition)))

(defun find-robot-name-from-options (session options)
  "Return the name of the robot that OPTIONS ask for. If that robot is not defined, load the files
of --load now, because they may define it. Signals USAGE-ERROR if the robot is still not defined."
  (handler-case (robot-name-from-options options)
    (bad-line (condition)
      (let ((files (shiftf (reader-files (session-reader session)) '())))
        (cond (files (load-files-before-prompt files)
                     (find-robot-name-from-options session options))
              (t (reject-unknown-names condition)))))))

(defun run-headless (session robot-name seed)
  "Run the lines of SESSION, a batch, in a fresh world. If a line WORLD has chosen another robot to
continue with, return its name, else NIL."
  (setf (session-next-robot session) nil
        *prompt-robot* robot-name)
  (import-robot-names (robot-names-in-same-world robot-name))
  (call-with-simulation (lambda ()
                          (mark-as-prompt-run *simulation*)
                          (run-session session))
                        (robot-names-in-same-world robot-name)
                        :seed seed :journal t :keep *forks-to-keep*)
  (session-next-robot session))

(defun run-batch (session robot-name seed)
  (loop for name = robot-name then next
        for next = (run-headless session name seed)
        while next))

(defun write-greeting (session)
  (let ((simulation (current-simulation)) (console (session-console session)))
    (write-string (fit-to-window (format nil "ARS MAGNA: ~A in ~A, seed ~D, ~A.~%~
                                              HELP lists the commands, QUIT leaves.~%"
                                         (session-robot) (simulation-name simulation)
                                         (simulation-seed simulation)
                                         (rate-text (simulation-rate simulation)))
                                 console)
                  console)))

(defun run-live (session robot-name options)
  (apply #'simulator robot-name :rate (option-value :rate options *default-rate*)
                                :display (or (option-value :window options)
                                             (display-wanted-p session))
         (when (option-value :seed options) (list :seed (option-value :seed options))))
  (when (session-terminal-p session) (write-greeting session))
  (run-session session)
  ;; Without a terminal, the user has only the window.
  (when (and (option-value :window options)
             (reader-ended-p (session-reader session))
             *window-close-waiter*)
    (funcall *window-close-waiter*)))

(defun lines-for-plan-options (options)
  (loop for text in (option-values :plan options) collect (format nil "plan ~A" text)))

(defun make-session-from-options (options)
  "Return a session that carries out OPTIONS and then reads lines of a script or the standard input.
Without a terminal, the session echoes its lines and waits for each command, so that the output is a
transcript as in manual E. A batch with plans to run reads no lines from a terminal."
  (let* ((script (option-value :script options))
         (objects (and (option-value :json options) (make-object-console)))
         (batch (or script objects (option-value :batch options)))
         (input (if script (open-script script) (make-standard-input *standard-output* batch)))
         (piped (not (typed-by-hand-p input)))
         (lines (lines-for-plan-options options)))
    (make-session :input (if (and batch lines (not piped)) (make-concatenated-stream) input)
                  :output (or objects *standard-output*) :batch batch
                  :account (when batch (make-account script objects))
                  :stop (option-value :stop options)
                  :files (option-values :load options) :lines lines
                  :patient (or batch piped) :echo (and piped (not batch))
                  :color (option-value :color options :auto))))

(defun run-in-first-world (session robot-name options)
  ;; Messages about the world's definitions; a headless run has a separate queue of messages.
  (print-messages session (setf *definition-messages* (take-all-messages)))
  (let ((*forks-to-keep* t))
    (if (and (session-batch-p session) (null (option-value :rate options)))
        (run-batch session robot-name (option-value :seed options 0))
        (run-live session robot-name options))))

(defun write-lisp-output-as-objects (session)
  "Write all output of Lisp, including that of users' threads, as JSON objects of SESSION."
  (let* ((console (session-console session))
         (both (make-two-way-stream (session-input session) console)))
    (setf *standard-output* console
          *trace-output* console
          *debug-io* both
          *terminal-io* both)))

(defun check-live-for-window (options)
  "Signal USAGE-ERROR if OPTIONS ask for a window of a run that is not live."
  (when (and (or (option-value :batch options) (option-value :script options)
                 (option-value :json options))
             (null (option-value :rate options)))
    (reject-usage "--window shows a live run. A batch or script is live only with --rate.")))

(defun check-window-option (options)
  "Signal USAGE-ERROR if OPTIONS ask for a window where none can be shown."
  (when (option-value :window options)
    (check-live-for-window options)
    (handler-case (ensure-window-system)
      (bad-line (condition) (reject-usage "~A" (bad-line-text condition))))))

(defun run-session-with-options (session options)
  (let ((robot-name (find-robot-name-from-options session options)))
    (when (option-value :json options) (write-lisp-output-as-objects session))
    (report-object (session-account session) "begin"
                   :program (format nil "ARS MAGNA ~A" *version*)
                   :robot (string-downcase
                           (name-label robot-name (robot-names-in-same-world robot-name)))
                   :world (string-downcase (map-name (map-of-robot robot-name)))
                   :seed (option-value :seed options 0)
                   :rate (option-value :rate options))
    (call-with-typed-input (lambda () (run-in-first-world session robot-name options))
                           (session-input session))))

(defun run-prompt (options)
  (check-window-option options)
  (let ((session (make-session-from-options options)))
    (call-with-watchers session options (lambda () (run-session-with-options session options)))
    ;; The process ends with all windows.
    (mapc #'save-last-film (running-sessions))
    (report-session-end session
                        (if (and (session-batch-p session) (plusp (session-errors session))) 1 0))))

(defun run-with-options (options)
  (cond ((option-value :list options)
         (load-files-before-prompt (option-values :load options))
         (print-loading-messages)
         (when (option-value :world options) (robot-names-in-world (option-value :world options)))
         (write-worlds)
         0)
        (t (run-prompt options))))

(defun script-p (argument)
  "True if ARGUMENT, this process's first argument or NIL, is a script: a file, but no command."
  (and argument
       (not (find argument *shell-commands* :key #'first :test #'string=))
       (or (string= argument "-")
           (and (not (option-p argument)) (script-path argument)))))

(defun script-last-p (arguments)
  "True if ARGUMENTS begin with an option and end with a script that is not the value of an option."
  (and (option-p (or (first arguments) ""))
       (script-p (first (last arguments)))
       (ignore-errors (parse-options (butlast arguments)) t)))

(defun script-and-others (arguments)
  "Return two values: the script that ARGUMENTS name, or NIL, and the other arguments."
  (cond ((script-p (first arguments)) (values (first arguments) (rest arguments)))
        ((script-last-p arguments) (values (first (last arguments)) (butlast arguments)))
        (t (values nil arguments))))

(defun options-with-script (script arguments)
  "Return the options in ARGUMENTS, and an option for SCRIPT unless it is NIL."
  (let ((text (and script (script-path script) (foreign-file-text (script-path script)))))
    (when text (reject-usage "~A" text)))
  (append (and script (list (list :script script))) (parse-options arguments)))

(defun run-script (script arguments)
  "Run SCRIPT with the options in ARGUMENTS. Return the status to exit with."
  (let ((options (options-with-script script arguments)))
    (prog1 (run-with-options options)
      (when (and (script-path script)
                 (null (option-value :world options))
                 (file-only-defines-p (script-path script)))
        (say-on-error-output
         (format nil "~A only defines things. The file was run as a script of lines; to use its ~
                      robot: ars-magna --world ~:*~A." script))))))

(defun run-with-arguments (arguments)
  "Run this program with ARGUMENTS, a list of strings. Return the status to exit with."
  (cond ((intersection arguments '("--help" "-h") :test #'string=)
         (write-string (command-usage (first arguments)))
         0)
        ((equal arguments '("--version"))
         (format t "ARS MAGNA ~A~%" *version*)
         0)
        (t (multiple-value-bind (script others) (script-and-others arguments)
             (cond (script (run-script script others))
                   ((and others (not (option-p (first others))))
                    (run-shell-command (first others) (rest others)))
                   (t (run-with-options (parse-options others))))))))

;;; The shell script has the arguments checked before it compiles McCLIM, which takes minutes.

(defun check-names-in-options (options)
  "Signal USAGE-ERROR if OPTIONS name an unknown world or robot. If files of OPTIONS may define the
names, check nothing, because loading a file can have any effect."
  (let ((world (option-value :world options)))
    (unless (or (option-value :load options) (and world (existing-lisp-file world)))
      (handler-case (robot-name-from-options options)
        (bad-line (condition) (reject-unknown-names condition))))))

(defun check-arguments (arguments)
  "Signal USAGE-ERROR if ARGUMENTS, which ask for a window, are wrong, as far as is known without
McCLIM. Otherwise return 0, the status to exit with."
  (multiple-value-bind (script others) (script-and-others arguments)
    (if (and others (null script) (not (option-p (first others))))
        (find-shell-command (first others))
        (let ((options (options-with-script script others)))
          (unless (option-value :list options)
            (check-live-for-window options)
            (check-names-in-options options)))))
  0)

;;; The process.

(defun ending-message (condition)
  "Return the message of CONDITION on one line, with names as users write them."
  (let ((*package* (user-package)))
    (short-error-text (ending-condition-text condition))))

(defun report-process-end (condition status)
  (ignore-errors (say-on-error-output (ending-message condition)))
  status)

(defun call-for-status (function)
  "Call FUNCTION, which returns an exit status, and return that status. After an error or interrupt,
print a message and return the status for that case."
  (catch 'leave
    (handler-case
        (call-until-interrupted
         (lambda () (let ((*leave-without-output-p* t)) (call-releasing-interrupts function)))
         (lambda ()
           (say-on-error-output "stopped.")
           130))
      (usage-error (condition) (report-process-end condition 2))
      ((or error storage-condition) (condition)
        (recover-memory condition)
        (report-process-end condition 1)))))

(defun finish-console (console status)
  "Write the pending output of CONSOLE. Return STATUS, or a status of at least 1 if writing failed."
  (finish-output console)
  (let ((trouble (console-trouble console)))
    (cond ((null trouble) status)
          ;; An output that is closed early is no error.
          ((search "Broken pipe" (printable-report trouble)) (max 1 status))
          (t (report-process-end trouble (max 1 status))))))

(defun call-fitting-tables (function console)
  "Call FUNCTION. If CONSOLE is on a terminal, tables that FUNCTION prints fit the window."
  (if (terminal-stream-p (console-stream console))
      (call-with-page-width function (1- (window-size)))
      (funcall function)))

(defun do-as-arguments-say ()
  "Run this program with its arguments, or only check those after --probe. Return the exit status."
  (let ((arguments (process-arguments)))
    (if (equal "--probe" (first arguments))
        (check-arguments (rest arguments))
        (run-with-arguments arguments))))

(defun run-process ()
  (let ((console (make-standard-console)))
    (setf *standard-output* console
          *trace-output* console)
    (finish-console console
                    (call-for-status
                     (lambda ()
                       (call-fitting-tables #'do-as-arguments-say console))))))

(defun main ()
  "Run ./cli/ars-magna: do what the arguments of this process say, then end the process. The
argument --probe alone only tests whether the core starts; before others, it only checks these."
  (when (equal (process-arguments) '("--probe")) (end-process 0))
  ;; The core may have been saved where the environment names another.
  (uiop:setup-temporary-directory)
  (end-on-termination)
  (accept-interrupts)
  (call-on-continuing #'resume-terminal)
  (refuse-exits (format nil "EXIT would end the whole program here. Signal an error instead, or ~
                             return; at the prompt, QUIT leaves."))
  ;; An interrupt that still waits at the end is ignored.
  (let ((*toplevel-function* #'main))
    (call-holding-interrupts (lambda () (end-process (run-process))))))
