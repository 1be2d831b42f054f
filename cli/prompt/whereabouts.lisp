;;;; whereabouts.lisp -- which prompts are in a trial or fork, and what is said of a run for that.

(in-package :ars-magna.cli)

(defun words-for-run (simulation)
  "Return in words where those are who are in SIMULATION: in a fork, a trial, or a map."
  (let* ((visitor (visitor-of simulation)) (visit (and visitor (session-visit visitor))))
    (cond ((timeline-fork-p (timeline-of simulation))
           (format nil "a fork of ~A at tick ~D" (simulation-name simulation)
                   (simulation-tick simulation)))
          (visit (words-for-visit visit))
          ((and *trial-replayed* (headless-p simulation)) *trial-replayed*)
          (t (simulation-name simulation)))))

(defun away-p (session)
  "True if SESSION is in a trial or a fork."
  (or (session-visit session) (plusp (session-forks session))))

(defun visitor-of (simulation)
  "Return the session that has come into SIMULATION by TRIAL or FORK and is there, or NIL."
  (find-if (lambda (session)
             (and (eq simulation (session-whereabouts session)) (away-p session)))
           (sessions-at-work)))

(defun way-in (simulation)
  "Return in words how a prompt has come into SIMULATION, if by TRIAL or FORK, or NIL."
  (let ((session (visitor-of simulation)))
    (and session (if (session-visit session) "a trial" "a fork"))))

(defun pace-of (simulation)
  "Return how time passes in SIMULATION, if a prompt is there by TRIAL or FORK: :RUNNING, :PAUSED,
:ENDED or :FORKED, and at what rate, or NIL. Else return NIL."
  (let ((session (visitor-of simulation)))
    (cond ((null session) nil)
          ((session-visit session) (pace-of-visit (session-visit session)))
          (t :forked))))
