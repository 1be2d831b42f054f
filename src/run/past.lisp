;;;; past.lisp -- what a run remembers of its past, so that it can be rewound.

(in-package :ars-magna.run)

(export '(note-doing let-fork-be-kept))

;;; A run that keeps forks has a PAST: these forks, and its ACTS, everything done to the run since
;;; the oldest fork, in order: the entries of the journal, and requests to plans from outside. A
;;; fork of the past goes the same way as the run if the acts that it does not repeat by itself are
;;; done to it again (redoing.lisp).

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
                      (:constructor make-past (limit &key forks acts cost (count (length acts))))
                      (:copier nil))
  "What is kept of a run's past: at most LIMIT FORKS, and COUNT ACTS, the newest of both first. The
next fork is due at the tick NEXT, not before DUE, a time in seconds. If the time has not come then,
the clock is read again PACE ticks later. ROLLED is the last known state of the dice of programs, or
NIL. COST is how many seconds a fork takes on average. WANTED is since when, in seconds, a fork is
due that could not be made, as the run was busy; or NIL."
  (limit 0 :type fixnum)
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

(defun remember (simulation operator arguments &optional request)
  "Let SIMULATION, if it has a past, remember that OPERATOR was asked for with ARGUMENTS, which are
externalized or OPERATOR is a function, see ACT; by REQUEST, if that is given."
  (let ((past (simulation-past simulation)))
    (when past
      (let ((arguments (memorized arguments)))
        ;; Whoever acts may be in any thread.
        (atomic-push (if request
                         (request-act request simulation operator arguments)
                         (change-act simulation operator arguments))
                     (past-acts past))
        (incf (past-count past))))))

(defun pending-acts (simulation)
  "Return what is asked of SIMULATION and waits for the next tick, as acts, the newest first."
  (loop for request in (timeline-inbox (simulation-timeline simulation))
        for (operator . arguments) = (request-entry request)
        collect (request-act request simulation operator
                             (memorized (externalize arguments)))))

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
  "Let SIMULATION, which has a past, remember what the dice of programs are here and now, if they
have been rolled by what a fork may not do again."
  (let ((rolled (look-at-dice simulation (simulation-past simulation))))
    (when rolled (remember simulation #'roll-back (list rolled)))))

(defun note-doing (simulation function &rest arguments)
  "Let SIMULATION, if it has a past, remember that from outside something was done that no journal
has: FUNCTION, of ARGUMENTS, does it again. What a fork does by itself does not count. Return
nothing."
  (when (and (simulation-past simulation)
             (not (goes-on-in-forks-p))
             ;; In these phases only what a fork has too can act.
             (not (changing-phase-p (phase-here (simulation-timeline simulation)))))
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

;;;; Keeping forks

;;; A fork is made at the end of a tick. If there are too many, the one is dropped whose loss
;;; matters least for its age. So recent forks are close together, old ones far apart, and the first
;;; is always kept. The clock determines how often forks are made: keeping them must take only a
;;; small part of the time. No result depends on it, as rewinding repeats what happened between two
;;; forks.

(addition *forks-to-keep*)
(defvar *forks-to-keep* nil
  "What SIMULATOR takes for :KEEP unless it is told: how many forks a live run keeps, so that REWIND
can go back; T for a usual number, NIL for none. The prompt sets it to T.")

(defconstant +usual-forks+ 30 "How many forks a run keeps if nobody says how many.")
(defconstant +longest-pace+ 1024 "After how many ticks a run looks at the clock at the latest.")

(defconstant +least-cost+ 1d-4 "How many seconds a fork is taken to cost at least.")

(defparameter *keeping-share* 1/100
  "Which part of its time a run may spend on keeping forks; 1: it keeps one at each tick.")
(defparameter *most-kept-octets* (expt 2 28)
  "How many octets the kept forks of a run may take, as far as that can be foreseen.")

(defun room-for-forks (simulation past)
  "Return how many forks SIMULATION, of PAST, may keep."
  (let ((octets (+ 50000 (octets-of-copy (simulation-world simulation))))) ; of a fork, roughly
    (clamp (floor *most-kept-octets* octets) 3 (max 3 (past-limit past)))))

(defun least-needed (forks)
  "Return the one of FORKS, the newest first, without which the gap is smallest for its age. The
first and the last are needed."
  (loop with now = (kept-tick (first forks))
        with best = nil and least = nil
        for (newer kept older) on forks
        while older
        do (let ((loss (/ (- (kept-tick newer) (kept-tick older))
                          (1+ (- now (kept-tick older))))))
             (when (or (null least) (<= loss least))
               (setf best kept least loss)))
        finally (return best)))

(defun warn-of-no-fork (simulation past condition)
  "Say, once, that CONDITION keeps SIMULATION, of PAST, from keeping a fork."
  (unless (past-warned-p past)
    (setf (past-warned-p past) t)
    (warn-notably (format nil "What is so at tick ~D cannot be kept for REWIND: ~A."
                         (simulation-tick simulation)
                         (string-right-trim "." (brief-text condition))))))

(defun fork-to-keep (simulation past)
  "Return a fork of SIMULATION, of PAST; :BUSY if somebody is at work in it, NIL if it cannot be."
  (handler-case (call-around #'participant-at-rest (simulation-participants simulation)
                             (lambda () (fork-now simulation nil '())))
    (misuse () :busy)
    (error (condition) (warn-of-no-fork simulation past condition))))

(defun forget-if-full (simulation past)
  "Forget all that PAST has of SIMULATION if that is too much."
  (when (and (finite-p *journal-limit*) (> (past-count past) *journal-limit*))
    (setf (past-forks past) '() (past-acts past) '() (past-count past) 0)
    (warn-notably (format nil "So much has been asked of this run that REWIND can go back to tick ~
                              ~D at most; see *JOURNAL-LIMIT*."
                         (simulation-tick simulation)))))

;; The clock is coarse: of what one fork takes it tells little.
(defun note-cost (past began)
  "Let PAST know that making a fork began at BEGAN, in seconds, and has ended."
  (let ((cost (+ (* 15/16 (past-cost past)) (* 1/16 (- (seconds-now) began)))))
    (setf (past-cost past) cost
          (past-due past) (if (< *keeping-share* 1)
                              (+ began (/ (max cost +least-cost+) *keeping-share*))
                              began))))

(defun keep-fork (simulation past)
  "Let SIMULATION, which stands still, keep a fork in PAST, if that can be now. If somebody is at
work in it, that is to be at the end of the next tick."
  (forget-if-full simulation past)
  (let* ((began (or (past-wanted past) (seconds-now)))
         (tick (simulation-tick simulation))
         (fork (fork-to-keep simulation past)))
    (when (simulation-p fork)
      (push (make-kept fork tick (past-acts past)) (past-forks past))
      (loop with room = (room-for-forks simulation past)
            while (> (length (past-forks past)) room)
            do (removef (past-forks past) (least-needed (past-forks past)))))
    (setf (past-pace past) 1
          (past-next past) (1+ tick)
          (past-wanted past) (if (eq :busy fork) began nil))
    (unless (eq :busy fork)
      (note-cost past began))))

(defconstant +looks-for-fork+ 100
  "How often who makes way for a fork looks whether it has been made, before it gives that up.")

(defun let-fork-be-kept (simulation)
  "If SIMULATION could not keep a fork because this thread, which is at rest now, was at work, wait
until the tick has ended and there is one; not for long, as no tick may pass."
  (let ((past (simulation-past simulation)) (moment (make-semaphore "kept fork")))
    (when (and past (past-wanted past))
      (loop repeat +looks-for-fork+
            while (past-wanted past)
            do (wait-a-while moment 0.002))
      (setf (past-wanted past) nil))))

(defun keep-fork-in-time (simulation past)
  "Let SIMULATION keep a fork in PAST unless it has spent too much time on that."
  (cond ((>= (seconds-now) (past-due past)) (keep-fork simulation past))
        (t (setf (past-next past) (+ (simulation-tick simulation) (past-pace past))
                 (past-pace past) (min +longest-pace+ (* 2 (past-pace past)))))))

;;; How it is asked for.

(define-argument-type 'fork-count
  (lambda (value) (or (typep value 'boolean) (whole-p value 2 1000)))
  "a number of forks from 2 to 1000, T for a usual one, or NIL for none")

(defun begin-keeping (simulation limit)
  "Let SIMULATION, which this thread has in custody, keep forks, at most LIMIT, from now on."
  (let ((past (setf (simulation-past simulation) (make-past limit))))
    (when (eq simulation *simulation*) (look-at-dice simulation past))
    ;; One can go back as far as here: what has been asked for stays so.
    (dolist (request (timeline-inbox (simulation-timeline simulation)))
      (when (zerop (request-phase request))
        (setf (request-phase request) (phase-number :continuations))))
    (when (zerop (timeline-phase (simulation-timeline simulation)))
      (keep-fork simulation past))))

(addition keep-forks)
(defun keep-forks (&optional (count t) (simulation (current-simulation)))
  "Make SIMULATION keep forks of itself from now on, so that REWIND can go back to this tick at the
earliest. COUNT is the most it keeps, from 2 to 1000, by default 30, and fewer for a very large
world; NIL drops them all and stops keeping. Recent forks are closer together than old ones. Keeping
them takes about a hundredth of the run's time; requests to the run are kept, too. Return nothing.
Signals WRONG-ARGUMENT, and MISUSE if the run is over."
  (check-of-type 'keep-forks 'count count 'fork-count)
  (let ((simulation (simulation-meant simulation 'keep-forks)))
    (check-not-over simulation 'keep-forks)
    (asking (simulation)
      (let ((past (simulation-past simulation))
            (limit (if (eq t count) +usual-forks+ count)))
        (cond ((null count) (setf (simulation-past simulation) nil))
              (past (setf (past-limit past) limit))
              (t (begin-keeping simulation limit))))))
  (values))
