;;;; redoing.lisp -- bring a fork of the past to a later tick, in the way that the run went.

(in-package :ars-magna.run)

;;; The world, kickers, commands in progress and plans repeat by themselves. Everything else is done
;;; to the fork again, at the same tick and in the same phase. A plan's request is performed at the
;;; same position among the requests as the first time, so the world goes the same way even if a
;;; live plan was slow then. If a plan does not repeat a request, it is made in its place: the plan
;;; has STRAYED, which can happen if it depends on state that forks do not copy.

(defstruct (redoing (:constructor make-redoing (simulation acts)) (:copier nil))
  "That SIMULATION is given again what ACTS, those yet to come, the oldest first, were. HELD are
requests that it has come to by itself and that are not due, the oldest first. STRAYED is the first
tick at which it did not come to what it had come to, or NIL."
  (simulation nil :type simulation :read-only t)
  (acts '() :type list)
  (held '() :type list)
  (strayed nil :type (or null fixnum)))

(defun note-straying (redoing)
  (unless (redoing-strayed redoing)
    (setf (redoing-strayed redoing) (simulation-tick (redoing-simulation redoing)))))

(defun perform-act (act simulation)
  "Do again in SIMULATION, which is the current one, what ACT says."
  (let ((operator (act-operator act)) (arguments (recalled (act-arguments act) simulation)))
    (if (functionp operator)
        (apply operator arguments)
        (perform-operator operator arguments simulation (or (act-asker act) "the past")))))

(defun do-again (act redoing)
  "Do again what ACT says. If it failed then, it fails again."
  (let* ((timeline (simulation-timeline (redoing-simulation redoing)))
         (before (timeline-inbox timeline)))
    (handler-case (perform-act act (redoing-simulation redoing))
      (error () (unless (functionp (act-operator act)) (note-straying redoing))))
    ;; What was asked for inside a tick must not be forgotten when the run is rewound to it.
    (dolist (request (ldiff (timeline-inbox timeline) before))
      (setf (request-phase request) (act-phase act)))))

;;; Requests.

(defun same-request-p (request act)
  "True if REQUEST asks for what ACT says. Which of its own commands a plan withdraws is seen only
when that is performed."
  (destructuring-bind (operator . arguments) (request-entry request)
    (let ((arguments (externalize arguments)))
      (and (eq operator (act-operator act))
           (alike-p (first arguments) (first (act-arguments act)))
           (or (not (typep request 'event)) (alike-p arguments (act-arguments act)))))))

(defun ask-again (act redoing)
  "Ask again for what ACT, a request, says; if the fork has come to that by itself, for that."
  (let* ((held (redoing-held redoing))
         (own (and (act-own-p act)
                   (find-if (lambda (request) (same-request-p request act)) held))))
    (when (and (act-own-p act) (null own)) (note-straying redoing))
    (cond (own (setf (redoing-held redoing) (remove own held))
               (post-again own (simulation-timeline (redoing-simulation redoing))))
          (t (do-again act redoing)))))

;;; Going on.

(defun next-act (redoing test)
  "Return the next act, removed, if it was done by now and TEST is true of it; or NIL."
  (let ((act (first (redoing-acts redoing))))
    (when (and act
               (<= (act-tick act) (simulation-tick (redoing-simulation redoing)))
               (funcall test act))
      (pop (redoing-acts redoing)))))

(defun redo-in-tick (redoing)
  "Do again what was done in this tick, after the world had changed, before what goes on in forks
acted as often as it has by now."
  (loop with moments = (timeline-moments (simulation-timeline (redoing-simulation redoing)))
        for act = (next-act redoing (lambda (act)
                                      (and (eq :change (act-kind act))
                                           (telling-phase-p (act-phase act))
                                           (<= (act-moment act) moments))))
        while act
        unless (act-own-p act) do (do-again act redoing)))

;; Changes that came before any request are made first: the fork comes to requests of its own by
;; them too. Those are then held, and each is let in where it came the first time, among the rest.
(defun redo-between-ticks (redoing)
  "Do again what was done before the next tick."
  (loop for act = (next-act redoing (lambda (act) (eq :change (act-kind act))))
        while act
        unless (act-own-p act) do (do-again act redoing))
  (setf (redoing-held redoing)
        (append (redoing-held redoing)
                (remove-if-not #'of-itself-p
                               (take-requests
                                (simulation-timeline (redoing-simulation redoing))))))
  (loop for act = (next-act redoing (constantly t))
        while act
        do (if (eq :request (act-kind act))
               (ask-again act redoing)
               (unless (act-own-p act) (do-again act redoing)))))

(defun ticks-to-go (redoing goal)
  "Return how many ticks may pass before something is to be done again, or GOAL is reached."
  (let* ((simulation (redoing-simulation redoing)) (act (first (redoing-acts redoing))))
    (cond ((simulation-participants simulation) 1) ; They may come to requests in any tick.
          (act (- (min goal (act-tick act)) (simulation-tick simulation)))
          (t (- goal (simulation-tick simulation))))))

;; Who takes part is known before the first of them acts: so what came before that is done by then.
(defun go-on-to (goal redoing)
  "Pass ticks up to GOAL, and do all again on the way."
  (let* ((simulation (redoing-simulation redoing))
         (timeline (simulation-timeline simulation))
         (observer (lambda (simulation) (declare (ignore simulation)) (redo-in-tick redoing))))
    (setf (timeline-on-moment timeline) (lambda () (redo-in-tick redoing)))
    (add-observer observer simulation)
    (loop (redo-between-ticks redoing)
          (when (>= (simulation-tick simulation) goal) (return))
          (run-ticks (ticks-to-go redoing goal) simulation))
    (remove-observer observer simulation)
    (setf (timeline-on-moment timeline) nil)))

(defun redo (simulation acts goal)
  "Let SIMULATION, a fork of the past that is the current one, go on to the tick GOAL, given ACTS
again, the oldest first. Return the tick at which plans strayed from what they did then, or NIL.
What they print has been printed."
  (let ((redoing (make-redoing simulation acts))
        (*repeated* (simulation-timeline simulation))
        (*standard-output* (make-broadcast-stream)))
    (go-on-to goal redoing)
    (dolist (request (redoing-held redoing))
      (post-again request (simulation-timeline simulation)))
    (follow-settings simulation)
    (redoing-strayed redoing)))
