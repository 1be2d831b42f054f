;;;; robots-lines.lisp -- ALL: one command line for each robot of the run.

(in-package :ars-magna.cli)

(defun write-under-robot (robot function)
  "Call FUNCTION. If it prints something, print this below the name of ROBOT, or of the robot named
ROBOT."
  (let ((output (make-string-output-stream))
        (label (if (robot-p robot) (robot-label robot) (label-in-run robot *simulation*))))
    (unwind-protect (let ((*standard-output* output)) (funcall function))
      (let ((text (get-output-stream-string output)))
        (when (string/= "" text)
          (format t "~&~A~%~A~&" label text))))))

(defun check-line-for-robots (text)
  "Signal BAD-LINE if the line TEXT is about the run or the prompt, not about a robot."
  (unless (lisp-p (expand-alias text))
    (let ((line (find-line-command (split-first-word (expand-alias text)))))
      (when (or (eq :running (line-family line))
                (member (line-name line) '("ALL:" "WORLD" "ROBOT" "PLOT" "QUIT")
                        :test #'string=))
        (reject-line "~A is not about one robot. Type it without ~A." (line-name line)
                     +all-robots+)))))

(defun error-of-line (session text)
  "Run TEXT, a line of SESSION. Return the text of an error in it, or NIL."
  (handler-case (handler-bind ((error (lambda (condition) (debug-if-wanted session condition))))
                  (run-typed-line session text)
                  nil)
    ((or error storage-condition) (condition)
      (recover-memory condition)
      (text-with-advice condition))))

(defun report-errors-of-robots (session errors count)
  "Report ERRORS, lists (label text), of COUNT robots. Each text is reported once, with the labels
of its robots unless it is the text of all robots."
  (loop for text in (remove-duplicates (mapcar #'second errors) :test #'string= :from-end t)
        for labels = (loop for (label other) in errors when (string= text other) collect label)
        do (report-session-error session (format nil "~@[~(~{~A~^, ~}~): ~]~A"
                                                 (and (< (length labels) count) labels) text))))

(defun run-line-for-robots (session text names)
  "Run the line TEXT for each of the robots NAMES of the current run. An error in one does not stop
the others."
  (let ((errors '()))
    (dolist (name names)
      ;; The line may have ended the run, or the session.
      (unless (or (session-over-p session) (not (member name (current-robot-names))))
        (let ((*prompt-robot* name))
          (note-robot-commanded)
          (write-under-robot name
                             (lambda ()
                               (let ((trouble (error-of-line session text)))
                                 (when trouble
                                   (push (list (label-in-run name *simulation*) trouble)
                                         errors))))))))
    (report-errors-of-robots session (reverse errors) (length names))))

(define-line "ALL:" (session (cmd :line "a command, with its arguments"))
    (:general
     "All robots get the command before any of them begins, in the order of their full names. The
next line waits for all of them, where lines wait for commands. REPEAT 3 ALL: TURN 1 repeats the
command for all robots; ALL: REPEAT 3 TURN 1 is for one robot after the other.")
    "Give the command CMD to each robot of the run. What it prints is below the name of each robot.
An error of one robot does not stop the others."
  (let ((world (world-of-prompt)))
    (check-line-for-robots cmd)
    (run-line-for-robots session cmd (mapcar #'robot-name (robots-in-order world)))))
