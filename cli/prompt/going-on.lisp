;;;; going-on.lisp -- in which run each session is, and where it goes on when that is over.

(in-package :ars-magna.cli)

(export '(go-to-run run-after tell-of-run run-of-robot words-for-run away-p way-in pace-of))

(defun words-for-run (simulation)
  "Return in words where those are who are in SIMULATION: in a fork, a trial, or a map."
  (let* ((visitor (visitor-of simulation)) (visit (and visitor (session-visit visitor))))
    (cond ((timeline-fork-p (timeline-of simulation))
           (format nil "a fork of ~A at tick ~D" (simulation-name simulation)
                   (simulation-tick simulation)))
          (visit (trial-words (visit-experiment visit) (visit-condition visit) (visit-trial visit)))
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

;;; One prompt may end the run that others are in: by WORLD, or by starting a robot anew in Lisp.
;;; One rule says where these go on, in a terminal or a window: with their robot, if that is in a
;;; live run now; else where WORLD has led, with the robot that it has led to. Those that wait for a
;;; line say so at once, and listen there; each goes there before it does the next line.

(defvar *replacements* (make-hash-table :test 'eq :weakness :key :synchronized t)
  "For each run that WORLD has led out of, the one that it has led to and the name of the robot
there, in a list.")

(defun run-of-robot (name)
  "Return the live run that the robot called NAME is in now, or NIL."
  (let* ((robot (and name (find-robot name nil)))
         (simulation (and robot (robot-simulation robot))))
    (and simulation (live-p simulation) (not (simulation-over simulation)) simulation)))

(defun run-after (simulation robot-name)
  "Return the live run in which a prompt goes on that has commanded the robot ROBOT-NAME of
SIMULATION, which is over, and the name of the robot that it commands there; NIL if there is none."
  (let ((own (run-of-robot robot-name))
        (next (gethash simulation *replacements*)))
    (cond (own (values own robot-name))
          ((null next) nil)
          ((simulation-over (first next)) (apply #'run-after next))
          (t (values-list next)))))

;;; Others are told.

(defun say-in (session text)
  "Show TEXT, a line, in SESSION, and the prompt again. Any thread may ask."
  (with-lock ((session-lock session))
    (let ((console (session-console session)))
      (write-fitted console "~A" text)
      (restore-prompt console))))

(defun tell-others (session simulation text)
  "Show TEXT, a line about what SESSION has done to SIMULATION, in the other sessions there."
  (dolist (other (remove session (sessions-hearing simulation)))
    (say-in other text)))

(defun tell-of-run (session simulation robot-name)
  "Let SESSION, which somebody else leads to the robot ROBOT-NAME of SIMULATION, say so, and listen
to that. If it listens there already, it knows. Any thread may ask."
  (unless (eq simulation (session-simulation session))
    (say-in session (format nil "From here on: ~A in ~A.~%" robot-name
                            (words-for-run simulation)))
    (listen-instead session simulation)))

;;; Going there.

(defun go-to-run (simulation)
  "Let SIMULATION be the current one in this thread."
  (setf *simulation* simulation
        *world* (simulation-world simulation)))

(defun move-on (session)
  "If the run of SESSION, in whose thread this is, is over, go on in another if there is one."
  (when (and *simulation* (simulation-over *simulation*))
    (multiple-value-bind (simulation name) (run-after *simulation* *prompt-robot*)
      (when simulation
        (tell-of-run session simulation name)
        (go-to-run simulation)
        (setf *prompt-robot* name)
        (call-by-name (mapcar #'robot-name (simulation-robots simulation)))))))
