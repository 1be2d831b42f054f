;;;; prompt.lisp -- reading lines and doing what they say, one after the other.

(in-package :ars-magna.cli)

(defun do-next (session text)
  "Do what TEXT, a line, says, or let it answer the newest break, if a program waits for that."
  (let ((breakage (first (session-breaks session))))
    (if breakage
        (debug-line session breakage text)
        (run-text session text))))

(defun next-line (session)
  "Read a line of SESSION and do what it says; at the end of input, let the session be over."
  (follow-simulation session)
  (tell-whereabouts session)
  (when (session-account session) (account-for-last session))
  (let ((text (unless (stopped-p session)
                (read-input session (if (session-breaks session) "Break> " "Robot> ")))))
    (cond (text
           (note-line-begun (session-account session) (if (comment-p text) nil text)
                            (session-errors session))
           (do-next session text))
          (t (setf (session-over-p session) t)))))

(defun stopped-p (session)
  "True if SESSION stops at an error, and there was one when all was done that it has asked for."
  (when (session-stop-p session)
    (catch-up session)
    (show-messages session)
    (plusp (session-errors session))))

(defun account-for-last (session)
  "Wait until all is done that the last line of SESSION has asked for, and report that it is."
  (catch-up session)
  (show-messages session)
  (note-line-ended (session-account session) (session-errors session)))

(defun load-first (session)
  "Load the files that SESSION begins with."
  (loop while (session-files session)
        do (let ((file (pop (session-files session))))
             (call-guarded session (lambda () (load-lisp (file-called file))))
             (setf (session-lisp-p session) t))))

(defun run-lines (session)
  "Do what the files and lines of SESSION say until it is over, or goes on with another robot."
  (load-first session)
  (loop until (or (session-over-p session) (session-next-robot session))
        do (call-guarded session (lambda () (next-line session)))
           (call-guarded session (lambda () (show-messages session)))))

(defun call-with-streams (session function)
  "Call FUNCTION, which writes to SESSION and asks its user."
  (let* ((*standard-output* (session-console session))
         (*standard-input* (session-input session))
         (*robot-meant* #'session-robot)
         (*robot-to-drive* #'robot-commanded)
         (*query-io* (make-two-way-stream *standard-input* *standard-output*)))
    (funcall function)))

(defun run-session (session)
  "Read lines and do what they say until QUIT or the end of input. Return SESSION."
  (flet ((run ()
           (unwind-protect (call-with-syntax 'double-float (lambda () (run-lines session)))
             (stop-listening session))))
    (call-with-debugger session
                        (lambda ()
                          (call-with-streams session (lambda () (call-holding-interrupts #'run))))))
  session)

(defun prompt (&rest options &key input output batch patient echo lines color)
  "Run the command-line interface: prompt for commands to the robot last given to SIMULATOR, until
QUIT or the end of input. INPUT and OUTPUT are streams, by default the standard ones. If PATIENT,
or headless, each command completes before the next is read; BATCH is that without a prompt; with
ECHO, lines are shown as they are read; the list LINES is done first. COLOR is :AUTO (on a terminal,
unless the environment has NO_COLOR), :ALWAYS or :NEVER. Returns nothing (manual A, E)."
  (declare (ignore input output batch patient echo lines color))
  (run-session (apply #'make-session options))
  (values))
