;;;; past.lisp -- what a run remembers of its past, so that it can be rewound.

(in-package :ars-magna.run)

(export '(note-doing))

;;; A run that is told to keep forks (keeping.lisp) has a PAST: these forks, and as ACTS, in order,
;;; everything that was done to the run since the oldest fork: what its journal has, and what was
;;; asked of plans from outside. A fork of the past goes on as the run did if the acts that it does
;;; not repeat by itself are done to it again (redoing.lisp).

(defstruct (act (:constructor make-act (kind tick phase moment own-p operator arguments asker))
                (:copier nil))
  "That something was done. KIND is :REQUEST, for what a tick has begun with, or else :CHANGE. TICK
had passed, or was under way in its PHASE, a number, 0 between ticks; of a request PHASE says when
it was asked for. MOMENT is how often by then in the tick what goes on in forks too had acted. OWN-P
is true of what a fork does by itself. OPERATOR is the name of an operator, and ARGUMENTS are
externalized, or a function; they are memorized. ASKER is a note of who asked for it, or NIL."
  (kind :change :type (member :request :change) :read-only t)
  (tick 0 :type fixnum :read-only t)
  (phase 0 :type fixnum :read-only t)
  (moment 0 :type fixnum :read-only t)
  (own-p nil :read-only t)
  (operator nil :type (or symbol function) :read-only t)
  (arguments '() :type list :read-only t)
  (asker nil :read-only t))

(defstruct (kept (:constructor make-kept (fork tick acts)) (:copier nil))
  "FORK, which was made at the end of TICK, when ACTS, the newest first, had been done."
  (tick 0 :type fixnum :read-only t)
  (fork nil :type simulation :read-only t)
  (acts '() :type list :read-only t))

(defstruct (kept-past (:conc-name past-)
                      (:constructor make-past
                          (limit keeper &key forks acts cost (count (length acts))))
                      (:copier nil))
  "What is kept of a run's past: at most LIMIT FORKS, and COUNT ACTS, the newest of both first. The
next fork is to be made at the tick NEXT, not before DUE, a time in seconds; KEEPER, a function of
the run and its past, is then called. ROLLED is what the dice of programs were when that was last
looked at, or NIL. PACE is in how many ticks that is looked at again. COST is how
many seconds a fork takes, on the average. WANTED is since when, in seconds, a fork is due that
could not be made, as somebody was at work in the run; or NIL."
  (limit 0 :type fixnum)
  (keeper nil :type function :read-only t)
  (forks '() :type list)
  (acts '() :type t)
  (count 0 :type fixnum)
  (next 0 :type fixnum)
  (due 0d0 :type double-float)
  (cost 2d-4 :type double-float)
  (pace 1 :type fixnum)
  (wanted nil :type (or null double-float))
  (rolled nil)
  (warned-p nil :type boolean))

(declaim (inline noting-p))
(defun noting-p (simulation)
  "True if somebody wants to know what is done to SIMULATION."
  (or (simulation-journal simulation) (simulation-past simulation)))

(defun of-itself-p (request)
  "True if a fork comes to REQUEST by itself, as what goes on there too has asked for it."
  (or (request-forked-p request) (asked-inside-p request)))

(defun request-act (request simulation operator arguments)
  "Return the act that SIMULATION begins a tick with REQUEST: for OPERATOR, with ARGUMENTS, which
are externalized and memorized."
  (make-act :request (simulation-tick simulation) (request-phase request) 0
            (of-itself-p request) operator arguments (request-asker request)))

(defun change-act (simulation operator arguments)
  "Return the act that OPERATOR is done here and now with ARGUMENTS."
  (let ((timeline (simulation-timeline simulation)))
    (make-act :change (simulation-tick simulation) (phase-here timeline)
              (timeline-moments timeline)
              (goes-on-in-forks-p) operator arguments nil)))

;; Whoever acts may be in any thread.
(defun add-act (past act)
  (atomic-push act (past-acts past))
  (incf (past-count past)))

(defun remember (simulation operator arguments &optional request)
  "Let SIMULATION, if it has a past, remember that OPERATOR was asked for with ARGUMENTS, which are
externalized or OPERATOR is a function, see ACT; by REQUEST, if that is given."
  (let ((past (simulation-past simulation)))
    (when past
      (let ((arguments (memorized arguments)))
        (add-act past (if request
                          (request-act request simulation operator arguments)
                          (change-act simulation operator arguments)))))))

(defun pending-acts (simulation)
  "Return what is asked of SIMULATION and waits for the next tick, as acts, the newest first."
  (loop for request in (timeline-inbox (simulation-timeline simulation))
        for (operator . arguments) = (request-entry request)
        collect (request-act request simulation operator
                             (memorized (externalize arguments)))))

;; In these phases only what a fork has too can act.
(defun changing-inside-p (simulation)
  "True in the phases of a tick of SIMULATION in which the world changes."
  (changing-phase-p (phase-here (simulation-timeline simulation))))

;;; Programs around the run, and continuations, roll dice that plans roll too; and are not repeated.

(defun look-at-dice (simulation past)
  "Let PAST know what the dice of programs of SIMULATION are here and now. Return that if they have
been rolled since it was last looked at, or NIL. Only a headless run has dice that all its programs
roll."
  (when (member *lisps-dice* (simulation-variables simulation) :test #'eq)
    (let ((before (past-rolled past)))
      (setf (past-rolled past) (dice-rolled before))
      (if (eq before (past-rolled past)) nil (past-rolled past)))))

(defun note-dice (simulation)
  "Let SIMULATION, if it has a past, remember what the dice of programs are here and now, if they
have been rolled by what a fork may not do again."
  (let* ((past (simulation-past simulation))
         (rolled (and past (look-at-dice simulation past))))
    (when rolled (remember simulation #'roll-back (list rolled)))))

(defun note-doing (simulation function &rest arguments)
  "Let SIMULATION, if it has a past, remember that from outside something was done that no journal
has: FUNCTION, of ARGUMENTS, does it again. What a fork does by itself does not count. Return
nothing."
  (when (and (simulation-past simulation)
             (not (goes-on-in-forks-p))
             (not (changing-inside-p simulation)))
    (when (eq simulation *simulation*) (note-dice simulation))
    (remember simulation function arguments))
  (values))

;;; Which part of the past is before a moment.

(defun asked-in-tick-p (act tick)
  "True if ACT is a request that was made inside of TICK, and is carried out after that."
  (and (eq :request (act-kind act))
       (= (act-tick act) tick)
       (plusp (act-phase act))))

(defun settled-by-p (act tick)
  "True if ACT, and all before it, was done before the end of TICK."
  (or (< (act-tick act) tick)
      (and (= (act-tick act) tick)
           (eq :change (act-kind act))
           (telling-phase-p (act-phase act)))))

(defun acts-until (tick acts)
  "Return those of ACTS, the newest first, that were done before the end of TICK, a tail of it; and
in a list, the newest first, what had been asked for by then and not yet been done."
  (let ((tail (member-if (lambda (act) (settled-by-p act tick)) acts)))
    (values tail
            (remove-if-not (lambda (act) (asked-in-tick-p act tick)) (ldiff acts tail)))))

(defun acts-since (kept acts)
  "Return those of ACTS, the newest first, that were done after KEPT had been made, the oldest
first."
  (reverse (ldiff acts (kept-acts kept))))
