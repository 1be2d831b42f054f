;;;; tick.lisp -- what happens in a tick, in order.

(in-package :ars-magna.run)

;;; TICK is the order of a tick. While the world changes, no program runs but users' kickers,
;;; manipulations and events; continuations come after that, and then whoever looks on. So
;;; whatever else a program does happens between ticks, and a journal can repeat it.

(defmacro in-tick ((timeline world) &body body)
  "Run BODY, in which this thread changes WORLD: the part of a tick of TIMELINE that does so."
  `(progn
     (setf (timeline-ticking-p ,timeline) t
           (world-writer ,world) (current-thread))
     (unwind-protect (progn ,@body)
       (setf (timeline-ticking-p ,timeline) nil
             (world-writer ,world) nil))))

(declaim (inline notice-parameters))
(defun notice-parameters (simulation timeline)
  "Look after the parameters of SIMULATION, at least when there is a command that may read them."
  (when (or (timeline-thread timeline)
            (timeline-inbox timeline)
            (simulation-journal simulation))
    (follow-settings simulation)))

(defun set-parameter (name value)
  "Give the parameter NAME the VALUE, as somebody did in a run that is repeated."
  (setf (parameter-value name) value))

(define-operator 'parameter '(name datum) #'set-parameter)

(defun note-request (simulation request)
  (destructuring-bind (operator . arguments) (request-entry request)
    (note simulation operator arguments)))

;; What signals or throws is no reason to forget what was asked for after it.
(defun perform-all (simulation timeline)
  (let ((requests (take-requests timeline)))
    (unwind-protect
         (loop while requests
               do (let ((request (pop requests)))
                    (when (simulation-journal simulation) (note-request simulation request))
                    (perform request timeline)))
      (when requests (put-back requests timeline)))))

(declaim (inline perform-requests run-due-events prolong-journal tell-observers
                 let-participants-act))
(defun perform-requests (simulation timeline)
  "Perform what has been asked of SIMULATION since the last tick, in the order of asking."
  (when (timeline-inbox timeline) (perform-all simulation timeline)))

(defun run-due-events (timeline)
  "Let the tick begin that TIMELINE is to pass, and run what is due in it."
  (advance-agenda (timeline-agenda timeline)))

(defun prolong-journal (simulation)
  "Let the journal of SIMULATION, if it keeps one that is not full, reach to now."
  (let ((journal (simulation-journal simulation)))
    (when (and journal (not (journal-full-p journal)))
      (setf (journal-end journal) (simulation-tick simulation)))))

(defun tell-observers (simulation)
  (dolist (observer (simulation-observers simulation))
    (call-user-code observer "an observer" simulation)))

(defun let-participants-act (simulation)
  (dolist (participant (simulation-participants simulation))
    (call-user-code #'participant-after-tick "a participant" participant simulation)))

(defun tick (simulation)
  "Pass one tick of SIMULATION. To be called by its owner only."
  (declare #.*hot* (type simulation simulation))
  (let ((timeline (simulation-timeline simulation))
        (world (simulation-world simulation)))
    (declare (type timeline timeline) (type world world))
    (in-tick (timeline world)
      (notice-parameters simulation timeline)
      (perform-requests simulation timeline)
      (run-due-events timeline)
      (run-kickers world)
      (settle-robots world)
      (tend-tracks world)
      (check-grips world))
    (prolong-journal simulation)
    (deliver-notifications timeline)
    (tell-observers simulation)
    (let-participants-act simulation)))
