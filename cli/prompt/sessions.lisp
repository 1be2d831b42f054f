;;;; sessions.lisp -- several prompts at once: that of the terminal, and one in each window.

(in-package :ars-magna.cli)

(export '(run-session-apart interrupt-session end-session enter-line at-work-on abandon-session
          asked-of-others-p))

;;; Each has a thread, a robot and a current simulation of its own.

(defun call-apart (simulation robot-name function)
  "Call FUNCTION, in whose thread a prompt commands the robot ROBOT-NAME of SIMULATION, whatever
others do."
  (let ((*session* nil)
        (*prompt-robot* robot-name)
        (*simulation* simulation)
        (*world* (simulation-world simulation))
        (*message-queue* (simulation-messages simulation))
        (*forks-to-keep* t))
    (handler-case (funcall function)
      ;; One that has come before the session was ready for it, or after.
      (user-interrupt () nil))))

(defun run-session-apart (session simulation robot-name)
  "Read lines of SESSION and do what they say to the robot ROBOT-NAME of SIMULATION, in this thread,
beside other sessions, until QUIT or the end of its input. Return SESSION."
  (call-apart simulation robot-name
              (lambda ()
                (call-typing (lambda () (run-session session)) (session-input session))))
  session)

;;; What those do to it who do not type.

(defun heed-in-session ()
  "Let the session of this thread end the line that is under way, if there is one. What has broken
in one whose user is lost is not ended: others are asked, as soon as the session is over."
  (when (and *session* (not (and *asking-p* (session-abandoned-p *session*))))
    (heed-interrupt)))

(defun interrupt-session (session)
  "Do what control C does in SESSION, from another thread: clear the line that is typed, or end the
one that is under way."
  (cond ((being-typed-p (session-input session)) (press-key (session-input session) :control-c))
        ((session-thread session)
         (interrupt-thread (session-thread session) #'heed-in-session)))
  (values))

(defun abandon-session (session)
  "Note that SESSION is about to be over though its user has not left it, as when his window is
lost: others are asked what he cannot answer any more, and told what its run says. Return nothing."
  (setf (session-abandoned-p session) t)
  (stop-listening session)
  (values))

(defun asked-of-others-p (session)
  "True if what has broken in the thread of SESSION, which is lost, others can answer."
  (and (break-state-own (session-break-state session)) (heirs-of session) t))

(defun end-session (session)
  "Let SESSION be over, from another thread. A line that is under way is interrupted; one that is
being typed, or has been typed ahead, is not carried out."
  (setf (session-over-p session) t)
  (interrupt-session session)
  (end-octets (typed-octets (session-input session))))

(defun enter-line (session text)
  "Let TEXT be a line that was entered in SESSION; what is being typed there stays."
  (press-key (session-input session) (list :entry text)))

(defun at-work-on (session)
  "True if a line is under way in SESSION: none is being typed."
  (and (session-thread session)
       (not (session-over-p session))
       (not (being-typed-p (session-input session)))))
