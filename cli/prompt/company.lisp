;;;; company.lisp -- which prompts are at work, and which of them listen to a simulation.

(in-package :ars-magna.cli)

;;; Each has a thread, a robot and a current simulation of its own. What a simulation has to say is
;;; shown by all that listen to it, and each of them can answer what breaks in its thread.

(defvar *sessions* '() "The sessions at work, the newest first.")
(defvar *sessions-lock* (make-lock "sessions"))

(defun call-among-sessions (session function)
  "Call FUNCTION, while SESSION is at work."
  (with-lock (*sessions-lock*) (push session *sessions*))
  (unwind-protect (funcall function)
    (with-lock (*sessions-lock*) (removef *sessions* session))))

(defun sessions-at-work ()
  "Return a list of the sessions at work, the newest first."
  (with-lock (*sessions-lock*) (copy-list *sessions*)))

(defun hears-p (session simulation)
  "True if SESSION listens to SIMULATION, or to what it was before it was rewound."
  (let ((heard (session-simulation session)))
    (and heard (eq (latest heard) (latest simulation)))))

(defun sessions-hearing (simulation)
  "Return the sessions at work that listen to SIMULATION."
  (and simulation
       (remove-if-not (lambda (session) (hears-p session simulation)) (sessions-at-work))))

(defun session-with-queue (queue)
  "Return a session at work that listens to a run whose messages come in QUEUE, or NIL."
  (find-if (lambda (session)
             (let ((heard (session-simulation session)))
               (and heard (eq queue (simulation-messages heard)))))
           (with-lock (*sessions-lock*) *sessions*)))

(defgeneric session-meant (item)
  (:documentation "Return the session that is to show, whatever run it is in, a message that begins
with ITEM; or NIL.")
  (:method (item) (declare (ignore item)) nil))

(defun session-addressed (message)
  "Return the session at work that MESSAGE is for in any case, in a list, or NIL."
  (let ((session (session-meant (first (message-items message)))))
    (and session
         (member session (with-lock (*sessions-lock*) *sessions*))
         (list session))))

(defun hearers (message session)
  "Return the sessions that are to show MESSAGE, which SESSION has taken: the one that it is for,
and those that listen to its run; or if there is none, SESSION."
  (or (union (session-addressed message)
             (sessions-hearing (or (message-run message) (session-simulation session))))
      (list session)))

(defun tell-hearers (session messages)
  "Show MESSAGES, which SESSION has taken, in those sessions that they are for."
  (let ((hearers (mapcar (lambda (message) (hearers message session)) messages)))
    (dolist (hearer (remove-duplicates (cons session (apply #'append hearers))))
      (tell-messages hearer (loop for message in messages
                                  for those in hearers
                                  when (member hearer those) collect message)))))

;;; What users' programs print in a simulator's thread, as continuations do, goes to the terminal,
;;; and to the windows of that simulation.

(defun session-of-thread ()
  (find (current-thread) (with-lock (*sessions-lock*) *sessions*) :key #'session-thread))

(defun consoles-beside (console)
  "Return the other consoles that show what this thread writes to CONSOLE."
  (when (and *simulation* (rest *sessions*) (not (session-of-thread)))
    (remove console (mapcar #'session-console (sessions-hearing *simulation*)))))

(setf *mirrors* 'consoles-beside)
