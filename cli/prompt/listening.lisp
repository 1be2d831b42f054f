;;;; listening.lisp -- the running sessions: which runs they are in, and which messages they show.

(in-package :ars-magna.cli)

(export '(*before-line-hooks* show-definition-messages make-run-current run-to-continue-in
                              announce-run
          live-run-of-robot run-description in-trial-or-fork-p trial-or-fork-text
          trial-or-fork-pace))

;;; Each session has its thread, robot and current simulation. Messages of a simulation are shown by
;;; all sessions in it, and each of them can answer a break in its thread.

(defvar *sessions* '() "The running sessions, the newest first.")
(defvar *sessions-lock* (make-lock "sessions"))

(defun call-as-running-session (session function)
  (with-lock (*sessions-lock*) (push session *sessions*))
  (unwind-protect (funcall function)
    (with-lock (*sessions-lock*) (removef *sessions* session))))

(defun running-sessions ()
  (with-lock (*sessions-lock*) (copy-list *sessions*)))

(defun shows-run-p (session simulation)
  "True if SESSION shows messages of SIMULATION, or of a run linked to SIMULATION by rewinds."
  (let ((run (session-simulation session)))
    (and run (eq (latest-successor run) (latest-successor simulation)))))

(defun sessions-showing (simulation)
  (and simulation
       (remove-if-not (lambda (session) (shows-run-p session simulation)) (running-sessions))))

(defun session-with-queue (queue)
  "Return a running session that shows messages of the run with the message queue QUEUE, or NIL."
  (find-if (lambda (session)
             (let ((run (session-simulation session)))
               (and run (eq queue (simulation-messages run)))))
           (with-lock (*sessions-lock*) *sessions*)))

(defstruct (verdict (:constructor make-verdict (text &optional session)) (:copier nil))
  "A message item that says how a plan has ended. SESSION is the session that started the plan, or
NIL. The item prints as TEXT. SESSION shows the message even if SESSION is in another run."
  (text "" :type string :read-only t)
  (session nil :type (or null session) :read-only t))

(defmethod print-object ((verdict verdict) stream)
  (write-string (verdict-text verdict) stream))

(defun message-receivers (message session)
  "SESSION has taken MESSAGE from a queue. Return the sessions that show MESSAGE: the session named
in MESSAGE and the sessions in the run of MESSAGE; if there are none, SESSION."
  (or (union (let* ((item (first (message-items message)))
                    (meant (and (verdict-p item) (verdict-session item))))
               (and meant (member meant (running-sessions)) (list meant)))
             (sessions-showing (or (message-run message) (session-simulation session))))
      (list session)))

(defun deliver-messages (session messages)
  "SESSION has taken MESSAGES from a queue. Show each in the sessions from MESSAGE-RECEIVERS."
  (let ((receivers (mapcar (lambda (message) (message-receivers message session)) messages)))
    (dolist (receiver (remove-duplicates (cons session (apply #'append receivers))))
      (print-messages receiver (loop for message in messages
                                     for those in receivers
                                     when (member receiver those) collect message)))))

;;; Output of users' programs in a simulator's thread, as of continuations, goes to the terminal and
;;; to the windows of that simulation.

(defmethod mirrors-of ((console console))
  (when (and *simulation*
             (rest *sessions*)
             (not (find (current-thread) (running-sessions) :key #'session-thread)))
    (remove console (mapcar #'session-console (sessions-showing *simulation*)))))

(defvar *showing-messages-p* nil
  "True while this thread shows messages. Messages that come up meanwhile are shown later.")

(defvar *showing-lock* (make-lock "showing messages"))

(defun show-messages (session)
  "Show all queued messages, in SESSION or in the sessions of their runs. Then show the prompts
again. Do nothing if SESSION has lost its user."
  (unless *showing-messages-p*
    (with-lock (*showing-lock*)
      (unless (session-abandoned-p session)
        (let ((*showing-messages-p* t))
          (deliver-messages session (take-all-messages)))))))

;;; Messages about a world's file, while it is loaded, come before there is a run.

(defvar *definition-messages* '()
  "The messages about the program's definitions that the prompt showed before the first run.")

(defun show-definition-messages (session)
  "Make SESSION, the session of a new window, show the earlier messages about definitions."
  (when *definition-messages* (print-messages session *definition-messages*)))

;;; Listening to a simulation.

(defun show-new-message (session simulation)
  "Show a new message of SIMULATION in SESSION, now or at the end of the tick."
  (cond ((not (simulation-inside-tick-p simulation)) (show-messages session))
        ;; Its tick ends when a user says how to continue, who may need these messages.
        ((users-code-in-debugger-p simulation) (show-messages session))
        ((or (not (live-p simulation)) (eq (simulation-thread simulation) (current-thread)))
         ;; After all changes of this tick, before programs are told of them.
         (unless (shiftf (session-news-p session) t)
           (notify-later (timeline-of simulation) (lambda () (show-messages session)))))
        (t (setf (session-news-p session) t)
           ;; The tick may have ended just now, without this message.
           (unless (simulation-inside-tick-p simulation) (show-if-pending session)))))

(defun show-if-pending (session)
  "At the end of a tick, show the messages that SESSION has not shown yet."
  (when (or (session-news-p session) (prompt-overwritten-p (session-console session)))
    (show-messages session)))

(defun observer-for (session)
  "Return an observer that shows the pending messages of SESSION. The observer removes itself when
SESSION has a newer observer. So no thread waits for the end of a tick, which may never come."
  (let ((observer nil))
    (setf observer (lambda (simulation)
                     (if (eq observer (session-observer session))
                         (show-if-pending session)
                         (remove-observer observer simulation))))))

(defun set-queue-listener (session simulation)
  "Notify SESSION when SIMULATION has messages; if SESSION is NIL, notify no session."
  (setf (message-queue-listener (simulation-messages simulation))
        (and session (lambda () (show-new-message session simulation)))))

(defun listen-to (session simulation)
  ;; A new window does not know what others have shown often.
  (dolist (other (remove session (sessions-showing simulation)))
    (let ((counts (make-hash-table :test 'equal)))
      (with-lock ((session-lock other)) (merge-counts counts (session-error-counts other)))
      (with-lock ((session-lock session)) (merge-counts (session-error-counts session) counts))))
  (setf (session-simulation session) simulation)
  (set-queue-listener session simulation)
  (keep-history simulation)
  (when (live-p simulation)
    (let ((observer (observer-for session)))
      (setf (session-observer session) observer)
      (asking (simulation) (add-observer observer simulation)))))

(defun stop-listening (session)
  (let ((simulation (shiftf (session-simulation session) nil)))
    (setf (session-observer session) nil)
    (when simulation
      (let ((next (or (first (sessions-showing simulation))
                      (session-with-queue (simulation-messages simulation)))))
        (set-queue-listener next (if next (session-simulation next) simulation))))))

(defun follow-simulation (session)
  (unless (or (session-abandoned-p session)
              (and (eq *simulation* (session-simulation session))
                   (eq (and *simulation* (live-p *simulation*))
                       (and (session-observer session) t))))
    (stop-listening session)
    (when *simulation* (listen-to session *simulation*))))

;;; A window follows its user into other runs.

(define-event *before-line-hooks*
  "Functions, or names of functions, that the thread of a session calls before it reads a line. The
arguments are the session, its run when it last read a line, and its present run, perhaps the same.
A run may be NIL. A headless run stands still during the calls.")

(defun call-before-line-hooks (session)
  (let ((old (shiftf (session-whereabouts session) *simulation*)))
    (call-listeners *before-line-hooks* session old *simulation*)))

;;;; In which run each session is

(defun run-description (simulation)
  "Return text that describes SIMULATION as a fork, a trial, or the run in a map."
  (let* ((session (session-in-fork-or-trial simulation))
         (trial (and session (session-trial session))))
    (cond ((timeline-fork-p (timeline-of simulation))
           (format nil "a fork of ~A at tick ~D" (simulation-name simulation)
                   (simulation-tick simulation)))
          (trial (trial-prompt-line (open-trial-experiment trial) (open-trial-condition trial)
                                    (open-trial-number trial)))
          ((and *replayed-trial-line* (headless-p simulation)) *replayed-trial-line*)
          (t (simulation-name simulation)))))

(defun in-trial-or-fork-p (session)
  "True if SESSION is in a trial or a fork."
  (or (session-trial session) (plusp (session-forks session))))

(defun session-in-fork-or-trial (simulation)
  "Return the session that has entered SIMULATION by TRIAL or FORK and is still there, or NIL."
  (find-if (lambda (session)
             (and (eq simulation (session-whereabouts session)) (in-trial-or-fork-p session)))
           (running-sessions)))

(defun trial-or-fork-text (simulation)
  "Return \"a trial\" or \"a fork\" if a prompt has entered SIMULATION by TRIAL or FORK; else NIL."
  (let ((session (session-in-fork-or-trial simulation)))
    (and session (if (session-trial session) "a trial" "a fork"))))

(defun trial-or-fork-pace (simulation)
  "Return how time passes in SIMULATION, which a prompt has entered by TRIAL or FORK: :RUNNING,
:PAUSED, :ENDED or :FORKED. The second value is the rate or NIL. Return NIL for other simulations."
  (let ((session (session-in-fork-or-trial simulation)))
    (cond ((null session) nil)
          ((session-trial session) (trial-pace (session-trial session)))
          (t :forked))))

;;; One prompt may end the run that others are in: by WORLD, or by starting a robot again in Lisp.
;;; One rule says where these continue, in a terminal or a window: with their robot, if it is in a
;;; live run now; otherwise in the run that WORLD has led to, with its robot. Prompts that wait for
;;; a line say so at once, and show messages from there; each switches before it runs the next line.

(defvar *replaced-runs* (make-hash-table :test 'eq :weakness :key :synchronized t)
  "A table of the runs that the line WORLD replaced. Values: lists (new-run robot-name).")

(defun live-run-of-robot (name)
  "Return the live run that the robot named NAME is in now, or NIL."
  (let* ((robot (and name (find-robot name nil)))
         (simulation (and robot (robot-simulation robot))))
    (and simulation (live-p simulation) (not (simulation-over simulation)) simulation)))

(defun run-to-continue-in (simulation robot-name)
  "Return the live run where a prompt for ROBOT-NAME continues after the end of SIMULATION, and the
name of the robot to command there. Return NIL if there is no such run."
  (let ((own (live-run-of-robot robot-name))
        (next (gethash simulation *replaced-runs*)))
    (cond (own (values own robot-name))
          ((null next) nil)
          ((simulation-over (first next)) (apply #'run-to-continue-in next))
          (t (values-list next)))))

;;; Others are told.

(defun show-line-in-session (session text)
  "Show TEXT, a line, in SESSION, and the prompt again. Any thread may call this function."
  (with-lock ((session-lock session))
    (let ((console (session-console session)))
      (write-fitted console "~A" text)
      (restore-prompt console))))

(defun tell-other-sessions (session simulation text)
  (dolist (other (remove session (sessions-showing simulation)))
    (show-line-in-session other text)))

(defun announce-run (session simulation robot-name)
  "Tell the user of SESSION that the prompt continues with the robot ROBOT-NAME of SIMULATION, and
show messages of SIMULATION. Do nothing if SESSION shows them already. Callable in any thread."
  (unless (eq simulation (session-simulation session))
    (show-line-in-session session (format nil "From here on: ~A in ~A.~%"
                                          (label-in-run robot-name simulation)
                                          (run-description simulation)))
    (stop-listening session)
    (listen-to session simulation)))

;;; Going there.

(defun make-run-current (simulation)
  "Make SIMULATION the current simulation in this thread."
  (setf *simulation* simulation
        *world* (simulation-world simulation)))

(defun continue-in-next-run (session)
  "If SESSION's run is over, continue in a run that follows. Call this in SESSION's thread only."
  (when (and *simulation* (simulation-over *simulation*))
    (multiple-value-bind (simulation name) (run-to-continue-in *simulation* *prompt-robot*)
      (when simulation
        (announce-run session simulation name)
        (make-run-current simulation)
        (setf *prompt-robot* name)
        (import-robot-names (current-robot-names))))))
