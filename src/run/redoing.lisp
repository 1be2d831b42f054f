;;;; redoing.lisp -- advance a kept fork to a later tick as the run went.

(in-package :ars-magna.run)

;;; The world, kickers, commands in progress and plans repeat by themselves. Everything else is
;;; repeated in the fork at the same tick and in the same phase. A plan's request is performed at
;;; the same position among the requests as the first time, so the world goes the same way even if a
;;; live plan was slow then. If a plan does not repeat a request, it is made in place of the plan:
;;; the plan has DIVERGED, which can happen if it depends on state that forks do not copy.

(defstruct (redoing (:constructor make-redoing (simulation acts)) (:copier nil))
  "The repetition of a past in SIMULATION. ACTS are the acts that are not yet repeated, the oldest
first. HELD are the requests that SIMULATION has made by itself and that are not yet due, the oldest
first. DIVERGED is the first tick at which an act could not be repeated exactly, or NIL."
  (simulation nil :type simulation :read-only t)
  (acts '() :type list)
  (held '() :type list)
  (diverged nil :type (or null fixnum)))

(defun note-divergence (redoing)
  (unless (redoing-diverged redoing)
    (setf (redoing-diverged redoing) (simulation-tick (redoing-simulation redoing)))))

(defun perform-act (act simulation)
  "Repeat ACT in SIMULATION, which is the current simulation."
  (let ((operator (act-operator act)) (arguments (recall-arguments (act-arguments act) simulation)))
    (if (functionp operator)
        (apply operator arguments)
        (perform-operator operator arguments simulation (or (act-asker act) "the past")))))

(defun repeat-act (act redoing)
  "Repeat ACT. If ACT has a function, an error is ignored, because the function failed the first
time, too. If ACT has an operator, an error is recorded as a divergence."
  (let* ((timeline (simulation-timeline (redoing-simulation redoing)))
         (before (timeline-inbox timeline)))
    (handler-case (perform-act act (redoing-simulation redoing))
      (error () (unless (functionp (act-operator act)) (note-divergence redoing))))
    ;; Requests made inside a tick must be kept when the run is rewound to that.
    (dolist (request (ldiff (timeline-inbox timeline) before))
      (setf (request-phase request) (act-phase act)))))

;;; Requests.

(defun same-request-p (request act)
  "True if REQUEST is the same request as that of ACT. If REQUEST is not an event, only the first
arguments are compared: which of its commands a plan withdraws is known only when the withdrawal is
performed."
  (destructuring-bind (operator . arguments) (request-entry request)
    (let ((arguments (externalize arguments)))
      (and (eq operator (act-operator act))
           (alike-p (first arguments) (first (act-arguments act)))
           (or (not (typep request 'event)) (alike-p arguments (act-arguments act)))))))

(defun repeat-request (act redoing)
  "Post the same request that the fork itself has made, if there is one; otherwise repeat the
request of ACT."
  (let* ((held (redoing-held redoing))
         (own (and (act-own-p act)
                   (find-if (lambda (request) (same-request-p request act)) held))))
    (when (and (act-own-p act) (null own)) (note-divergence redoing))
    (cond (own (setf (redoing-held redoing) (remove own held))
               (post-again own (simulation-timeline (redoing-simulation redoing))))
          (t (repeat-act act redoing)))))

;;; Passing ticks.

(defun next-act (redoing test)
  "If the next act is due and TEST is true of it, remove and return it. Otherwise return NIL."
  (let ((act (first (redoing-acts redoing))))
    (when (and act
               (<= (act-tick act) (simulation-tick (redoing-simulation redoing)))
               (funcall test act))
      (pop (redoing-acts redoing)))))

(defun redo-in-tick (redoing)
  "Repeat the acts that were done in the current tick after the world had changed, up to the current
moment; see BEGIN-MOMENT."
  (loop with moments = (timeline-moments (simulation-timeline (redoing-simulation redoing)))
        for act = (next-act redoing (lambda (act)
                                      (and (eq :change (act-kind act))
                                           (telling-phase-p (act-phase act))
                                           (<= (act-moment act) moments))))
        while act
        unless (act-own-p act) do (repeat-act act redoing)))

;; Changes that came before any request are made first, as they may cause requests of the fork
;; itself. These are then held, and each is let through at its position among the others.
(defun redo-between-ticks (redoing)
  "Repeat the acts that were done before the next tick."
  (loop for act = (next-act redoing (lambda (act) (eq :change (act-kind act))))
        while act
        unless (act-own-p act) do (repeat-act act redoing))
  (setf (redoing-held redoing)
        (append (redoing-held redoing)
                (remove-if-not #'repeated-by-fork-p
                               (take-requests
                                (simulation-timeline (redoing-simulation redoing))))))
  (loop for act = (next-act redoing (constantly t))
        while act
        do (if (eq :request (act-kind act))
               (repeat-request act redoing)
               (unless (act-own-p act) (repeat-act act redoing)))))

(defun ticks-to-go (redoing goal)
  "Return how many ticks may pass before an act is to be repeated or GOAL is reached."
  (let* ((simulation (redoing-simulation redoing)) (act (first (redoing-acts redoing))))
    (cond ((simulation-participants simulation) 1) ; They may make requests in any tick.
          (act (- (min goal (act-tick act)) (simulation-tick simulation)))
          (t (- goal (simulation-tick simulation))))))

;; The observer is called before the first participant acts, so earlier acts are repeated by then.
(defun advance-to (goal redoing)
  "Pass ticks up to GOAL, and repeat all acts on the way."
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
  "Advance SIMULATION, a kept fork that is the current simulation, to the tick GOAL and repeat ACTS,
which begin with the oldest. Return the tick at which a plan diverged, or NIL."
  (let ((redoing (make-redoing simulation acts))
        (*repeated* (simulation-timeline simulation))
        (*standard-output* (make-broadcast-stream))) ; Plans have printed this the first time.
    (advance-to goal redoing)
    (dolist (request (redoing-held redoing))
      (post-again request (simulation-timeline simulation)))
    (record-settings simulation)
    (redoing-diverged redoing)))
