;;;; past.lisp -- what a run remembers of its past, so that it can be rewound.

(in-package :ars-magna.run)

;;; A run that is told to keep forks (keeping.lisp) has a PAST: these forks, and as ACTS, in order,
;;; everything that was done to the run since the oldest fork: what its journal has, and what was
;;; asked of plans from outside. A fork of the past goes on as the run did if the acts that it does
;;; not repeat by itself are done to it again (redoing.lisp).

(defstruct (act (:constructor make-act (kind tick phase own-p operator arguments asker))
                (:copier nil))
  "That something was done. KIND is :REQUEST, for what a tick has begun with, or else :CHANGE. TICK
had passed, or was under way in its PHASE, a number, 0 between ticks. OWN-P is true of what a fork
does by itself. OPERATOR is the name of an operator, or a function; ARGUMENTS are externalized.
ASKER is a note of who asked for it, or NIL."
  (kind :change :type (member :request :change) :read-only t)
  (tick 0 :type fixnum :read-only t)
  (phase 0 :type fixnum :read-only t)
  (own-p nil :read-only t)
  (operator nil :type (or symbol function) :read-only t)
  (arguments '() :type list :read-only t)
  (asker nil :read-only t))

(defstruct (kept (:constructor make-kept (fork tick acts)) (:copier nil))
  "FORK, which was made at the end of TICK, when ACTS, the newest first, had been done."
  (tick 0 :type fixnum :read-only t)
  (fork nil :type simulation :read-only t)
  (acts '() :type list :read-only t))

(defstruct (past (:constructor make-past (limit keeper &key forks acts cost (count (length acts))))
                 (:copier nil))
  "What is kept of a run's past: at most LIMIT FORKS, and COUNT ACTS, the newest of both first. The
next fork is to be made at the tick NEXT, not before DUE, a time in seconds; KEEPER, a function of
the run and its past, is then called. PACE is in how many ticks that is looked at again. COST is how
many seconds a fork takes, on the average."
  (limit 0 :type fixnum)
  (keeper nil :type function :read-only t)
  (forks '() :type list)
  (acts '() :type t)
  (count 0 :type fixnum)
  (next 0 :type fixnum)
  (due 0d0 :type double-float)
  (cost 2d-4 :type double-float)
  (pace 1 :type fixnum)
  (warned-p nil :type boolean))

(defun noting-p (simulation)
  "True if somebody wants to know what is done to SIMULATION."
  (or (simulation-journal simulation) (simulation-past simulation)))

;; Whoever acts may be in any thread.
(defun add-act (past act)
  (atomic-push act (past-acts past))
  (incf (past-count past)))

(defun phase-here (simulation)
  "Return the number of the phase of the tick of SIMULATION that this thread is in, 0 if in none."
  (if (owner-p simulation)
      (timeline-phase (simulation-timeline simulation))
      0))

(defun remember (simulation operator arguments &optional request)
  "Let SIMULATION, if it has a past, remember that OPERATOR was asked for with ARGUMENTS, which are
externalized; by REQUEST, if that is given."
  (let ((past (simulation-past simulation)))
    (when past
      (add-act past (make-act (if request :request :change)
                              (simulation-tick simulation)
                              (phase-here simulation)
                              (if request
                                  (or (request-forked-p request) (request-inside-p request))
                                  (goes-on-in-forks-p))
                              operator
                              arguments
                              (and request (request-asker request)))))))

;; In these phases only what a fork has too can act.
(defun changing-inside-p (simulation)
  "True in the phases of a tick of SIMULATION in which the world changes."
  (<= 1 (phase-here simulation) 4))

(defun note-doing (simulation function &rest arguments)
  "Let SIMULATION, if it has a past, remember that from outside something was done that no journal
has: FUNCTION, of ARGUMENTS, does it again. What a fork does by itself does not count. Return
nothing."
  (when (and (simulation-past simulation)
             (not (goes-on-in-forks-p))
             (not (changing-inside-p simulation)))
    (remember simulation function (externalize arguments)))
  (values))

;;; Which part of the past is before a moment.

(defun before-end-p (act tick)
  "True if ACT was done before the end of TICK, not afterwards."
  (or (< (act-tick act) tick)
      (and (= (act-tick act) tick) (<= 5 (act-phase act)))))

(defun acts-until (tick acts)
  "Return those of ACTS, the newest first, that were done before the end of TICK: the tail of it."
  (member-if (lambda (act) (before-end-p act tick)) acts))

(defun acts-since (kept acts)
  "Return those of ACTS, the newest first, that were done after KEPT had been made, the oldest
first."
  (reverse (ldiff acts (kept-acts kept))))
