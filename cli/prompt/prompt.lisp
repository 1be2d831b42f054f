;;;; prompt.lisp -- reading lines and running them, at the terminal and in windows.

(in-package :ars-magna.cli)

(export '(run-session prompt run-additional-session interrupt-session end-session enter-line
          running-line-p abandon-session answerable-by-others-p))

(defun waits-for-time-p (session jobs inbox)
  "True if time stands still and a line has requested something. Before the line, JOBS were the jobs
of SESSION, and INBOX the waiting requests of the simulation."
  (and *simulation*
       (if (live-p *simulation*) (paused-p *simulation*) (not (headless-p *simulation*)))
       (null (session-trial session))
       (not (and (eq jobs (session-jobs session)) (eq inbox (waiting-requests))))
       (waiting-requests)
       t))

(defun run-with-time-notice (session text)
  "Run TEXT, a line of SESSION. Tell an interactive user if TEXT waits because time stands still."
  (let ((jobs (session-jobs session)) (inbox (waiting-requests))
        (break-request (first (session-other-breaks session))))
    (if break-request
        (run-debug-line session break-request text)
        (run-typed-line session text))
    (when (and (session-terminal-p session) (waits-for-time-p session jobs inbox))
      (write-fitted (session-console session)
                    "Time stands still. RESUME continues, STEP 10 passes 10 ticks.~%"))))

(defun record-line-start (session text)
  (note-line-start (session-account session) (if (nothing-to-run-p text) nil text)
                   (count-of-lines-read (session-input session)) (session-errors session)))

(defun begin-line-without-comments (session text trouble)
  "Begin the line TEXT of SESSION, and return TEXT without comments between #| and |#. If the line
is too long, TEXT is an outline of the line, and TROUBLE is the condition LINE-TOO-LONG."
  (record-line-start session (if trouble (line-beginning trouble) text))
  (multiple-value-bind (rest trouble) (without-block-comments session text trouble)
    (reject-overlong-line session rest trouble)
    (unless (eq rest text) (record-line-start session rest))
    rest))

(defun read-next-line (session)
  "Return SESSION's next line; NIL at the end; for an overlong line, an outline and LINE-TOO-LONG."
  (handler-case (read-input session (if (session-other-breaks session) "Break> " "Robot> "))
    (line-too-long (condition) (values (line-outline condition) condition))))

(defun robot-departed-p (session)
  "True if the robot that SESSION commands has left the run, and other robots are in it."
  (let ((run (session-commanded-run session)))
    (and run *prompt-robot* *simulation* (not (simulation-over *simulation*))
         (eq *simulation* (latest-successor run))
         (simulation-robots *simulation*)
         (null (robot-of-prompt)))))

(defun note-commanded-run (session)
  "Record the run in which SESSION commands *PROMPT-ROBOT*, if the robot is in the run."
  (when (and *simulation* *prompt-robot* (robot-of-prompt))
    (setf (session-commanded-run session) *simulation*)))

(defun call-after-departure (session function)
  "Warn that the robot of SESSION has left the run. Call FUNCTION, which runs a line that commands
no other robot in its place. Later lines command the first robot of the run."
  (let ((*departed-robot* *prompt-robot*) (next (first (simulation-robots *simulation*))))
    (warning-set (format nil "~A is no longer in this run: the lines command ~A now."
                         *departed-robot* next))
    (show-messages session)
    (unwind-protect (funcall function)
      (when (eq *prompt-robot* *departed-robot*)
        (setf *prompt-robot* (robot-name next))))))

(defun call-for-present-robot (session function)
  "Call FUNCTION, which runs a line of SESSION that commands no robot that has left the run."
  (if (robot-departed-p session)
      (call-after-departure session function)
      (funcall function)))

(defun select-run-and-robot (session)
  "Make SESSION command its robot, in a run that continues, and show messages of that run."
  (unless (in-trial-or-fork-p session)
    (when (session-place session) (funcall (session-place session)))
    (continue-in-next-run session))
  (setf (session-robot-name session) (or *prompt-robot* (name-of-robot-commanded)))
  (note-commanded-run session)
  (follow-simulation session)
  (update-plots session))

(defun run-line-read (session text trouble)
  "Run the line TEXT of SESSION. TROUBLE is a condition LINE-TOO-LONG, or NIL."
  (let ((text (begin-line-without-comments session text trouble)))
    (flet ((run () (run-with-time-notice session text)))
      (if (nothing-to-run-p text) (run) (call-for-present-robot session #'run)))))

(defun run-next-line (session)
  "Read a line of SESSION and run it; at the end of input, end the session."
  (call-before-line-hooks session)
  (select-run-and-robot session)
  (when (session-account session) (report-last-line session))
  (multiple-value-bind (text trouble) (unless (stopped-by-error-p session) (read-next-line session))
    (cond (text
           ;; While it was typed, its run may have ended and another begun.
           (unless (session-other-breaks session) (select-run-and-robot session))
           (run-line-read session text trouble))
          (t (setf (session-over-p session) t
                   (reader-ended-p (session-reader session))
                   (not (session-terminal-p session)))))))

(defun run-nested-line (session)
  "Call RUN-NEXT-LINE within another line, which does not count the nested line's requests."
  (let ((*asker* nil) (*request-origin* nil)) (run-next-line session)))

(defun stopped-by-error-p (session)
  "Wait for the requests of SESSION. Return true if SESSION stops at errors and has had an error."
  (when (reader-stop-p (session-reader session))
    (await-session-commands session)
    (show-messages session)
    (plusp (session-errors session))))

(defun report-last-line (session)
  "Wait until all requests of the last line of SESSION are done, and report the end of the line. If
time stands still, report that the line waits."
  (await-session-commands session)
  (show-messages session)
  (note-line-end (session-account session) (session-errors session)
                 (pending-outcome-function session)))

(defun run-lines (session)
  "Run the files and lines of SESSION until it is over, or continues with another robot."
  (loop while (reader-files (session-reader session))
        do (let ((file (pop (reader-files (session-reader session)))))
             (call-guarded session (lambda () (load-lisp (find-lisp-file file))))
             (setf (session-lisp-p session) t)))
  (loop until (or (session-over-p session) (session-next-robot session))
        do (call-guarded session (lambda () (run-next-line session)))
           (call-guarded session (lambda () (show-messages session))))
  (when (session-account session) (call-guarded session (lambda () (report-last-line session))))
  (unless (or (session-terminal-p session) (session-next-robot session))
    (report-unfinished-work session)))

(defun report-unfinished-work (session)
  "Report an error if requests of SESSION, which has no user, wait because time stands still."
  (when (and (unfinished-work-p session)
             (or (not (live-p *simulation*)) (paused-without-steps-p *simulation*)))
    (report-session-error
     session (format nil "Time stands still, so not all requests have ended. RESUME continues."))
    (when (session-account session) (give-up-waiting-lines (session-account session)))))

(defun call-with-streams (session function)
  (let* ((*standard-output* (session-console session))
         (*standard-input* (session-input session))
         (*before-program-reads* (lambda () (report-program-input (session-account session))))
         (*completer* (lambda (text point) (completions-in session text point)))
         (*user-can-resume-p* (session-terminal-p session))
         (*default-robot-function* #'session-robot)
         (*commanded-robot-hook* #'commanded-robot-or-reject)
         (*query-io* (make-two-way-stream *standard-input* *standard-output*)))
    (funcall function)))

(defun run-session (session)
  "Read and run lines of SESSION until QUIT or the end of input. Return SESSION."
  (flet ((run ()
           (unwind-protect (call-with-syntax 'double-float (lambda () (run-lines session))
                                             (or (reader-package (session-reader session))
                                                 (user-package)))
             (stop-listening session))
           (stop-plotting session)
           (save-film-of-ended-session session)))
    (call-with-debugger session
                        (lambda ()
                          (call-with-streams session (lambda () (call-holding-interrupts #'run))))))
  session)

;; A stream of WITH-OUTPUT-TO-STRING lies on this thread's stack: written to by the simulator's
;; thread after its extent, it would spoil whatever is there then.
(defun release-streams (session output)
  "Stop writing to OUTPUT, which a user may close now that SESSION is over. Other sessions show the
pending messages of SESSION."
  (with-lock (*showing-lock*) (setf (session-abandoned-p session) t))
  (unless (eq output (session-console session)) (discard-output (session-console session))))

(defun prompt (&rest options &key input (output *standard-output*) batch patient echo lines color)
  "Run the command-line interface: prompt for commands to the robot last given to SIMULATOR, until
QUIT or the end of input. INPUT and OUTPUT are streams, by default the standard ones. If PATIENT, or
headless, each command completes before the next line is read. BATCH means PATIENT and no prompt.
With ECHO, lines are shown when read. The lines in the list LINES run first. COLOR is :AUTO (on a
terminal, unless the environment has NO_COLOR), :ALWAYS or :NEVER. Returns nothing (manual A, E)."
  (declare (ignore input batch patient echo lines color))
  (let ((session (apply #'make-session options)))
    (in-any-case
      (run-session session)
      (release-streams session output)))
  (values))

;;;; Several prompts at once

;;; Each has its own thread, robot and current simulation.

(defun run-additional-session (session simulation robot-name)
  "Read and run lines of SESSION in this thread, beside other sessions, until QUIT or the end of
input. The lines command the robot ROBOT-NAME of SIMULATION. Return SESSION."
  (let ((*session* nil)
        (*prompt-robot* robot-name)
        (*simulation* simulation)
        (*world* (simulation-world simulation))
        (*message-queue* (simulation-messages simulation))
        (*forks-to-keep* t))
    (handler-case (call-with-typed-input (lambda () (run-session session)) (session-input session))
      ;; A message that came before the session was ready for it, or after.
      (user-interrupt () nil)))
  session)

;;; What other threads do to a session.

(defun interrupt-own-line ()
  "End the running line of this thread's session, if there is one. Do not end a break in a session
whose user is lost: users of other sessions are asked when the session is over."
  (when (and *session* (not (and *asking-how-to-continue-p* (session-abandoned-p *session*))))
    (handle-interrupt)))

(defun interrupt-session (session)
  "From another thread, act as Control-C in SESSION: clear the typed line or end the running one."
  (cond ((reading-line-p (session-input session)) (send-key (session-input session) :control-c))
        ((session-thread session)
         (interrupt-thread (session-thread session) #'interrupt-own-line)))
  (values))

(defun abandon-session (session)
  "Record that SESSION ends because its user is lost (for example, a window was closed), not by
QUIT. Other sessions then get the questions of SESSION and the messages of its run. Return nothing."
  (setf (session-abandoned-p session) t)
  (stop-listening session)
  (values))

(defun answerable-by-others-p (session)
  "True if users of other sessions can answer a break of SESSION, whose user is lost."
  (and (break-state-own (session-break-state session)) (sessions-able-to-answer session) t))

(defun end-session (session)
  "End SESSION from another thread. Interrupt its line; run no line typed ahead or being typed."
  (setf (session-over-p session) t)
  (interrupt-session session)
  (end-queued-input (typed-octets (session-input session))))

(defun enter-line (session text)
  "Enter TEXT as a line of SESSION; the line being typed stays."
  (send-key (session-input session) (list :entry text)))

(defun running-line-p (session)
  "True if SESSION is running a line and not waiting for input."
  (and (session-thread session)
       (not (session-over-p session))
       (not (reading-line-p (session-input session)))))
