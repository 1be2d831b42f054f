;;;; redoing.lisp -- advance a kept fork to a later tick as the run went.

(in-package :ars-magna.run)

;;; The world, kickers, commands in progress and plans repeat by themselves. Everything else is
;;; repeated in the fork at the same tick and in the same phase. A plan's request is performed at
;;; the same position among the requests as the first time, so the world goes the same way even if a
;;; live plan was slow then. If a plan does not repeat a request, it is made in place of the plan:
;;; the plan has DIVERGED, which can happen if it depends on state that forks do not copy.

(defstruct (repetition (:constructor make-repetition (simulation acts)) (:copier nil))
  "The repetition of a past in SIMULATION. ACTS are the acts that are not yet repeated, the oldest
first. HELD are the requests made by SIMULATION itself and not yet due, the oldest
first. DIVERGED is the first tick at which an act could not be repeated exactly, or NIL."
  (simulation nil :type simulation :read-only t)
  (acts '() :type list)
  (held '() :type list)
  (diverged nil :type (or null fixnum)))

(defun note-divergence (repetition)
  (unless (repetition-diverged repetition)
    (setf (repetition-diverged repetition) (simulation-tick (repetition-simulation repetition)))))

(defun perform-act (act simulation)
  (let ((operator (act-operator act)) (arguments (recall-arguments (act-arguments act) simulation)))
    (if (functionp operator)
        (apply operator arguments)
        (perform-operator operator arguments simulation (or (act-asker act) "the past")))))

(defun repeat-act (act repetition)
  "Repeat ACT. If ACT has a function, an error is ignored, because the function failed the first
time, too. If ACT has an operator, an error is recorded as a divergence."
  (let* ((timeline (simulation-timeline (repetition-simulation repetition)))
         (before (timeline-inbox timeline)))
    (handler-case (perform-act act (repetition-simulation repetition))
      (error () (unless (functionp (act-operator act)) (note-divergence repetition))))
    ;; Requests made inside a tick must be kept when the run is rewound to that.
    (dolist (request (ldiff (timeline-inbox timeline) before))
      (setf (request-phase request) (act-phase act)))))

;;; Requests.

(defun same-request-p (request act)
  "True if REQUEST and the request of ACT are the same. Unless REQUEST is an event, compare only the
first arguments: what a plan withdraws is not known before the withdrawal."
  (destructuring-bind (operator . arguments) (request-journal-entry request)
    (let ((arguments (externalize arguments)))
      (and (eq operator (act-operator act))
           (alike-across-runs-p (first arguments) (first (act-arguments act)))
           (or (not (typep request 'event)) (alike-across-runs-p arguments (act-arguments act)))))))

(defun repeat-request (act repetition)
  "If the fork itself has made the request of ACT too, post the fork's request. Else repeat ACT."
  (let* ((held (repetition-held repetition))
         (own (and (act-own-p act)
                   (find-if (lambda (request) (same-request-p request act)) held))))
    (when (and (act-own-p act) (null own)) (note-divergence repetition))
    (cond (own (setf (repetition-held repetition) (remove own held))
               (post-again own (simulation-timeline (repetition-simulation repetition))))
          (t (repeat-act act repetition)))))

;;; Passing ticks.

(defun pop-due-act (repetition test)
  "If the next act is due and TEST is true of it, remove and return it. Otherwise return NIL."
  (let ((act (first (repetition-acts repetition))))
    (when (and act
               (<= (act-tick act) (simulation-tick (repetition-simulation repetition)))
               (funcall test act))
      (pop (repetition-acts repetition)))))

(defun redo-in-tick (repetition)
  "Repeat acts of this tick after the world's changes, up to now. See RECORD-CODE-MOMENT."
  (loop with moments = (timeline-moments (simulation-timeline (repetition-simulation repetition)))
        for act = (pop-due-act repetition (lambda (act)
                                            (and (eq :change (act-kind act))
                                                 (notifying-phase-p (act-phase act))
                                                 (<= (act-moment act) moments))))
        while act
        unless (act-own-p act) do (repeat-act act repetition)))

;; Changes that came before any request are made first, as they may cause requests of the fork
;; itself. These are then held, and each is let through at its position among the others.
(defun redo-between-ticks (repetition)
  "Repeat the acts that were done before the next tick."
  (loop for act = (pop-due-act repetition (lambda (act) (eq :change (act-kind act))))
        while act
        unless (act-own-p act) do (repeat-act act repetition))
  (setf (repetition-held repetition)
        (append (repetition-held repetition)
                (remove-if-not #'repeated-by-forks-p
                               (take-requests
                                (simulation-timeline (repetition-simulation repetition))))))
  (loop for act = (pop-due-act repetition (constantly t))
        while act
        do (if (eq :request (act-kind act))
               (repeat-request act repetition)
               (unless (act-own-p act) (repeat-act act repetition)))))

(defun ticks-to-next-act (repetition goal)
  "Return how many ticks may pass before an act is to be repeated or GOAL is reached."
  (let* ((simulation (repetition-simulation repetition)) (act (first (repetition-acts repetition))))
    (cond ((simulation-participants simulation) 1) ; They may make requests in any tick.
          (act (- (min goal (act-tick act)) (simulation-tick simulation)))
          (t (- goal (simulation-tick simulation))))))

;; The observer is called before the first participant acts, so earlier acts are repeated by then.
(defun advance-repetition (goal repetition)
  "Pass ticks up to GOAL, and repeat all acts on the way."
  (let* ((simulation (repetition-simulation repetition))
         (timeline (simulation-timeline simulation))
         (observer (lambda (simulation) (declare (ignore simulation)) (redo-in-tick repetition))))
    (setf (timeline-on-moment timeline) (lambda () (redo-in-tick repetition)))
    (add-observer observer simulation)
    (loop (redo-between-ticks repetition)
          (when (>= (simulation-tick simulation) goal) (return))
          (run-ticks (ticks-to-next-act repetition goal) simulation))
    (remove-observer observer simulation)
    (setf (timeline-on-moment timeline) nil)))

(defun repeat-acts (simulation acts goal)
  "Advance SIMULATION to the tick GOAL and repeat ACTS, the oldest first. SIMULATION is a kept fork
and the current simulation. Return the tick at which a plan diverged, or NIL."
  (let ((repetition (make-repetition simulation acts))
        (*repeated-timeline* (simulation-timeline simulation))
        (*standard-output* (make-broadcast-stream))) ; Plans have printed this the first time.
    ;; The fork may have been kept before a live run's plans, in their thread, reacted to its last
    ;; tick. In other runs plans react inside ticks.
    (when (timeline-real-p (simulation-timeline simulation)) (let-participants-act simulation))
    (advance-repetition goal repetition)
    (dolist (request (repetition-held repetition))
      (post-again request (simulation-timeline simulation)))
    (record-settings simulation)
    (repetition-diverged repetition)))
