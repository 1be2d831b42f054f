;;;; listening.lisp -- the running sessions: which runs they are in, and which messages they show.

(in-package :ars-magna.cli)

(export '(*whereabouts-hooks* tell-first-messages go-to-run run-after tell-of-run run-of-robot
          words-for-run in-trial-or-fork-p trial-or-fork-text pace-of))

;;; Each session has its thread, robot and current simulation. Messages of a simulation are shown by
;;; all sessions in it, and each of them can answer a break in its thread.

(defvar *sessions* '() "The running sessions, the newest first.")
(defvar *sessions-lock* (make-lock "sessions"))

(defun call-among-sessions (session function)
  (with-lock (*sessions-lock*) (push session *sessions*))
  (unwind-protect (funcall function)
    (with-lock (*sessions-lock*) (removef *sessions* session))))

(defun sessions-at-work ()
  (with-lock (*sessions-lock*) (copy-list *sessions*)))

(defun shows-run-p (session simulation)
  "True if SESSION shows messages of SIMULATION, or of the run that it replaced by a rewind."
  (let ((run (session-simulation session)))
    (and run (eq (latest run) (latest simulation)))))

(defun sessions-showing (simulation)
  (and simulation
       (remove-if-not (lambda (session) (shows-run-p session simulation)) (sessions-at-work))))

(defun session-with-queue (queue)
  "Return a running session that shows the messages of a run, which come in QUEUE, or NIL."
  (find-if (lambda (session)
             (let ((run (session-simulation session)))
               (and run (eq queue (simulation-messages run)))))
           (with-lock (*sessions-lock*) *sessions*)))

(defstruct (verdict (:constructor make-verdict (text &optional session)) (:copier nil))
  "An item of a message: how something that SESSION, or NIL, has started ended, such as a plan.
Prints as TEXT. SESSION shows the message, whatever run it is in."
  (text "" :type string :read-only t)
  (session nil :type (or null session) :read-only t))

(defmethod print-object ((verdict verdict) stream)
  (write-string (verdict-text verdict) stream))

(defun receivers (message session)
  "Return the sessions that show MESSAGE, which SESSION has taken: the one that it is for, and those
in its run; or SESSION if there is none."
  (or (union (let* ((item (first (message-items message)))
                    (meant (and (verdict-p item) (verdict-session item))))
               (and meant (member meant (sessions-at-work)) (list meant)))
             (sessions-showing (or (message-run message) (session-simulation session))))
      (list session)))

(defun deliver-messages (session messages)
  "Show MESSAGES, which SESSION has taken, in those sessions that they are for."
  (let ((receivers (mapcar (lambda (message) (receivers message session)) messages)))
    (dolist (receiver (remove-duplicates (cons session (apply #'append receivers))))
      (tell-messages receiver (loop for message in messages
                                    for those in receivers
                                    when (member receiver those) collect message)))))

;;; Output of users' programs in a simulator's thread, as of continuations, goes to the terminal and
;;; to the windows of that simulation.

(defmethod mirrors-of ((console console))
  (when (and *simulation*
             (rest *sessions*)
             (not (find (current-thread) (sessions-at-work) :key #'session-thread)))
    (remove console (mapcar #'session-console (sessions-showing *simulation*)))))

(defvar *showing-p* nil
  "True while this thread shows messages; what the showing itself reports is left for later.")

(defvar *showing-lock* (make-lock "showing messages"))

(defun show-messages (session)
  "Show all queued messages, in SESSION or in the sessions of their runs, and the prompts again. A
session without a user leaves them to others."
  (unless *showing-p*
    (with-lock (*showing-lock*)
      (unless (session-abandoned-p session)
        (let ((*showing-p* t))
          (deliver-messages session (take-all-messages)))))))

;;; Messages about a world's file, while it is loaded, come before there is a run.

(defvar *first-messages* '()
  "The messages about the definitions of the program, that the prompt has shown before any run.")

(defun tell-first-messages (session)
  "Show in SESSION, of a new window, the earlier messages about definitions."
  (when *first-messages* (tell-messages session *first-messages*)))

;;; Listening to a simulation.

(defun handle-message (session simulation)
  "Show the messages of SIMULATION, of which one is new."
  (cond ((not (simulation-ticking-p simulation)) (show-messages session))
        ;; Its tick ends when a user says how to continue, who may need these messages.
        ((users-code-broken-p simulation) (show-messages session))
        ((or (not (live-p simulation)) (eq (simulation-thread simulation) (current-thread)))
         ;; After all changes of this tick, before programs are told of them.
         (unless (shiftf (session-news-p session) t)
           (notify-later (timeline-of simulation) (lambda () (show-messages session)))))
        (t (setf (session-news-p session) t)
           ;; The tick may have ended just now, without this message.
           (unless (simulation-ticking-p simulation) (show-if-pending session)))))

(defun show-if-pending (session)
  "Show what has not been shown at the end of a tick."
  (when (or (session-news-p session) (overwritten-p (session-console session)))
    (show-messages session)))

(defun observer-for (session)
  "Return an observer that shows the pending messages of SESSION. It removes itself when SESSION has
another, so that no thread waits for the end of the tick, which may never come."
  (let ((observer nil))
    (setf observer (lambda (simulation)
                     (if (eq observer (session-observer session))
                         (show-if-pending session)
                         (remove-observer observer simulation))))))

(defun set-listener (session simulation)
  "Notify SESSION, or no session if that is NIL, when SIMULATION has messages."
  (setf (message-queue-listener (simulation-messages simulation))
        (and session (lambda () (handle-message session simulation)))))

(defun listen-to (session simulation)
  ;; A new window does not know what others have shown often.
  (dolist (other (remove session (sessions-showing simulation)))
    (let ((counts (make-hash-table :test 'equal)))
      (with-lock ((session-lock other)) (merge-counts counts (session-error-counts other)))
      (with-lock ((session-lock session)) (merge-counts (session-error-counts session) counts))))
  (setf (session-simulation session) simulation)
  (set-listener session simulation)
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
        (set-listener next (if next (session-simulation next) simulation))))))

(defun follow-simulation (session)
  (unless (or (session-abandoned-p session)
              (and (eq *simulation* (session-simulation session))
                   (eq (and *simulation* (live-p *simulation*))
                       (and (session-observer session) t))))
    (stop-listening session)
    (when *simulation* (listen-to session *simulation*))))

;;; A window follows its user into other runs.

(define-event *whereabouts-hooks*
  "Functions, or their names, of a session, the run that it was in when it last read a line, and its
present run, perhaps the same; NIL for none. They are called in its thread before it reads a line,
while a headless run stands still.")

(defun tell-whereabouts (session)
  "Call *WHEREABOUTS-HOOKS* with the run that SESSION is in."
  (let ((old (shiftf (session-whereabouts session) *simulation*)))
    (tell-listeners *whereabouts-hooks* session old *simulation*)))

;;;; In which run each session is

(defun words-for-run (simulation)
  "Return in words what SIMULATION is: a fork, a trial, or the run in a map."
  (let* ((session (session-entered simulation)) (trial (and session (session-trial session))))
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

(defun session-entered (simulation)
  "Return the session that has come into SIMULATION by TRIAL or FORK and is there, or NIL."
  (find-if (lambda (session)
             (and (eq simulation (session-whereabouts session)) (in-trial-or-fork-p session)))
           (sessions-at-work)))

(defun trial-or-fork-text (simulation)
  "Return in words how a prompt has come into SIMULATION, if by TRIAL or FORK, or NIL."
  (let ((session (session-entered simulation)))
    (and session (if (session-trial session) "a trial" "a fork"))))

(defun pace-of (simulation)
  "Return how time passes in SIMULATION, if a prompt is there by TRIAL or FORK: :RUNNING, :PAUSED,
:ENDED or :FORKED, and at what rate, or NIL. Else return NIL."
  (let ((session (session-entered simulation)))
    (cond ((null session) nil)
          ((session-trial session) (pace-of-trial (session-trial session)))
          (t :forked))))

;;; One prompt may end the run that others are in: by WORLD, or by starting a robot again in Lisp.
;;; One rule says where these continue, in a terminal or a window: with their robot, if it is in a
;;; live run now; otherwise in the run that WORLD has led to, with its robot. Prompts that wait for
;;; a line say so at once, and show messages from there; each switches before it runs the next line.

(defvar *replacements* (make-hash-table :test 'eq :weakness :key :synchronized t)
  "For each run that WORLD has replaced, a list of the run that replaced it and the robot's name
there.")

(defun run-of-robot (name)
  "Return the live run that the robot called NAME is in now, or NIL."
  (let* ((robot (and name (find-robot name nil)))
         (simulation (and robot (robot-simulation robot))))
    (and simulation (live-p simulation) (not (simulation-over simulation)) simulation)))

(defun run-after (simulation robot-name)
  "Return the live run in which a prompt for ROBOT-NAME continues after SIMULATION, which is over,
and the name of the robot that it commands there; NIL if there is none."
  (let ((own (run-of-robot robot-name))
        (next (gethash simulation *replacements*)))
    (cond (own (values own robot-name))
          ((null next) nil)
          ((simulation-over (first next)) (apply #'run-after next))
          (t (values-list next)))))

;;; Others are told.

(defun show-line-in-session (session text)
  "Show TEXT, a line, in SESSION, and the prompt again. Any thread may ask."
  (with-lock ((session-lock session))
    (let ((console (session-console session)))
      (write-fitted console "~A" text)
      (restore-prompt console))))

(defun tell-others (session simulation text)
  "Show TEXT, a line about what SESSION has done to SIMULATION, in the other sessions there."
  (dolist (other (remove session (sessions-showing simulation)))
    (show-line-in-session other text)))

(defun tell-of-run (session simulation robot-name)
  "Move SESSION to the robot ROBOT-NAME of SIMULATION, as another session does so: report that, and
show messages from there. Do nothing if it is there. Any thread may ask."
  (unless (eq simulation (session-simulation session))
    (show-line-in-session session (format nil "From here on: ~A in ~A.~%" robot-name
                                          (words-for-run simulation)))
    (stop-listening session)
    (listen-to session simulation)))

;;; Going there.

(defun go-to-run (simulation)
  "Make SIMULATION the current one in this thread."
  (setf *simulation* simulation
        *world* (simulation-world simulation)))

(defun continue-in-next-run (session)
  "If the run of SESSION, in whose thread this is, is over, continue in another if there is one."
  (when (and *simulation* (simulation-over *simulation*))
    (multiple-value-bind (simulation name) (run-after *simulation* *prompt-robot*)
      (when simulation
        (tell-of-run session simulation name)
        (go-to-run simulation)
        (setf *prompt-robot* name)
        (call-by-name (current-robot-names))))))
