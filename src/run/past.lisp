;;;; past.lisp -- what a run records of its past, so that it can be rewound.

(in-package :ars-magna.run)

(export '(record-outside-act fork-postponed-p await-postponed-fork))

;;; A run that keeps forks has a PAST: these forks, and its ACTS, everything done to the run since
;;; the oldest fork, in order: the entries of the journal, and requests to plans from outside. A
;;; kept fork goes the same way as the run if the acts that it does not repeat by itself are
;;; repeated in it (redoing.lisp).

(defstruct (act (:constructor make-act (kind tick phase moment own-p operator arguments asker))
                (:copier nil))
  "A request or change to a run, called an act. KIND is :REQUEST for a request performed at the
start of a tick, else :CHANGE. TICK is the tick in which the act was made; for an act made between
two ticks, the earlier tick. PHASE is the phase of that tick, or 0 between ticks. OWN-P is true if
forks repeat the act by themselves. MOMENT is the number of earlier acts of this kind in the tick.
OPERATOR is a function or the name of an operator. ARGUMENTS are memorized and, if OPERATOR is a
name, also externalized. ASKER is a note of who made the act, or NIL."
  (kind :change :type (member :request :change) :read-only t)
  (tick 0 :type fixnum :read-only t)
  (phase 0 :type fixnum :read-only t)
  (moment 0 :type fixnum :read-only t)
  (own-p nil :read-only t)
  (operator nil :type (or symbol function) :read-only t)
  (arguments '() :type list :read-only t)
  (asker nil :read-only t))

(defstruct (fork-record (:constructor make-fork-record (fork tick acts changes)) (:copier nil))
  "A fork kept for rewinding. FORK was made at the end of TICK, after ACTS, the newest first, and
after CHANGES changes of definitions."
  (tick 0 :type fixnum :read-only t)
  (fork nil :type simulation :read-only t)
  (acts '() :type list :read-only t)
  (changes 0 :type fixnum :read-only t))

(defstruct (run-past (:conc-name past-)
                     (:constructor make-past (limit &key forks acts cost (count (length acts))))
                     (:copier nil))
  "The kept part of a run's past: FORKS, at most LIMIT forks, and ACTS, COUNT acts; both are lists,
newest first. The next fork is made at the tick NEXT or later, and not before the time DUE, in
seconds. If DUE has not come at the tick NEXT, the clock is read again PACE ticks later. ROLLED is
the last known state of the dice of programs, or NIL. COST is the average number of seconds that a
fork takes. WANTED is the time, in seconds, at which a busy run postponed a fork; or NIL."
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

(defun repeated-by-forks-p (request)
  "True if a fork makes REQUEST by itself, because the code that made REQUEST also runs in forks."
  (or (request-forked-p request) (requested-inside-tick-p request)))

(defun request-act (request simulation operator arguments)
  "Return the act for REQUEST, which SIMULATION performs. OPERATOR and ARGUMENTS are those of
REQUEST; ARGUMENTS are externalized and memorized."
  (make-act :request (simulation-tick simulation) (request-phase request) 0
            (repeated-by-forks-p request) operator arguments (request-asker request)))

(defun make-change-act (simulation operator arguments)
  (let ((timeline (simulation-timeline simulation)))
    (make-act :change (simulation-tick simulation) (phase-in-this-thread timeline)
              (timeline-moments timeline)
              (continues-in-forks-p) operator arguments nil)))

(defun record-act (simulation operator arguments &optional request)
  "If SIMULATION has a past, record that OPERATOR was called with ARGUMENTS, or that REQUEST asked
for this call. ARGUMENTS are externalized unless OPERATOR is a function, see ACT."
  (let ((past (simulation-past simulation)))
    (when past
      (let ((arguments (memorize-arguments arguments)))
        ;; Any thread may act.
        (atomic-push (if request
                         (request-act request simulation operator arguments)
                         (make-change-act simulation operator arguments))
                     (past-acts past))
        (incf (past-count past))))))

(defun pending-acts (simulation)
  "Return the requests that wait for the next tick of SIMULATION as acts, the newest first."
  (loop for request in (timeline-inbox (simulation-timeline simulation))
        for (operator . arguments) = (request-journal-entry request)
        collect (request-act request simulation operator
                             (memorize-arguments (externalize arguments)))))

;;; Programs around the run and continuations use the same CL:RANDOM state as plans, but are not
;;; repeated in forks. So its state is recorded after they have changed it.

(defun update-rolled-dice (simulation past)
  "Store the current dice of programs of SIMULATION in PAST. Return the dice if they were rolled
since the last call, or NIL. Only in a headless run do all programs share the same dice."
  (when (member *random-state-variable* (simulation-variables simulation) :test #'eq)
    (let ((before (past-rolled past)))
      (setf (past-rolled past) (take-random-snapshot before))
      (if (eq before (past-rolled past)) nil (past-rolled past)))))

(defun record-dice (simulation)
  "Record programs' dice in SIMULATION's past if code that a fork may not repeat has rolled them."
  (let ((rolled (update-rolled-dice simulation (simulation-past simulation))))
    (when rolled (record-act simulation #'restore-random-snapshot (list rolled)))))

(defun record-outside-act (simulation function &rest arguments)
  "If SIMULATION has a past, record there an act of a program that no journal records. FUNCTION with
ARGUMENTS repeats the act. Acts that a fork repeats by itself are not recorded. Return nothing."
  (when (and (simulation-past simulation)
             (not (continues-in-forks-p))
             ;; In these phases only code that a fork runs, too, can act.
             (not (changing-phase-p (phase-in-this-thread (simulation-timeline simulation)))))
    (when (eq simulation *simulation*) (record-dice simulation))
    (record-act simulation function arguments))
  (values))

;;; The part of the past before a moment.

(defun requested-in-tick-p (act tick)
  "True if ACT is a request that was made inside the tick TICK and performed later."
  (and (eq :request (act-kind act))
       (= (act-tick act) tick)
       (plusp (act-phase act))))

(defun done-by-end-p (act tick)
  "True if ACT, and so every earlier act, was done before the end of the tick TICK."
  (or (< (act-tick act) tick)
      (and (= (act-tick act) tick)
           (eq :change (act-kind act))
           (notifying-phase-p (act-phase act)))))

(defun acts-until (tick acts)
  "ACTS is a list, the newest act first. Return two values: the tail of acts done before the end of
the tick TICK; and a list, the newest first, of requests made but not performed by then."
  (let ((tail (member-if (lambda (act) (done-by-end-p act tick)) acts)))
    (values tail
            (remove-if-not (lambda (act) (requested-in-tick-p act tick)) (ldiff acts tail)))))

;;;; Keeping forks

;;; A fork is made at the end of a tick. If there are too many, the one is dropped whose gap is
;;; smallest for its age. So recent forks are close together, old ones far apart, and the first is
;;; always kept. The clock determines how often forks are made, so that they take only a small part
;;; of the time. No result depends on it, as rewinding repeats what happened between two forks.

(addition *forks-to-keep*)
(defvar *forks-to-keep* nil
  "The default of the option :KEEP of SIMULATOR: the number of forks that a live run keeps, so that
REWIND can go back; T for 30, NIL for none. The prompt sets this variable to T.")

(defconstant +default-fork-count+ 30 "How many forks a run keeps by default.")
(defconstant +most-ticks-between-clock-reads+ 1024
  "The most ticks that a run passes before it reads the clock.")

(defconstant +least-fork-cost+ 1d-4 "The least seconds that a fork is taken to cost.")

(defparameter *fork-time-share* 1/100
  "The part of its time that a run may spend on forks: with 1, a run keeps a fork at each tick.")
(defparameter *most-fork-octets* (expt 2 28)
  "The maximum size of the kept forks of a run, in octets (estimated).")

(defun most-forks (simulation past)
  (let ((octets (+ 50000 (octets-of-copy (simulation-world simulation))))) ; of a fork, roughly
    (clamp (floor *most-fork-octets* octets) 3 (max 3 (past-limit past)))))

(defun least-needed-fork (forks)
  "FORKS is a list with the newest fork first. Return the fork, neither the first nor the last,
whose removal leaves the smallest gap in proportion to its age."
  (loop with now = (fork-record-tick (first forks))
        with best = nil and least = nil
        for (newer kept older) on forks
        while older
        do (let ((loss (/ (- (fork-record-tick newer) (fork-record-tick older))
                          (1+ (- now (fork-record-tick older))))))
             (when (or (null least) (<= loss least))
               (setf best kept least loss)))
        finally (return best)))

(defun warn-of-unkept-fork (simulation past condition)
  (unless (past-warned-p past)
    (setf (past-warned-p past) t)
    (queue-notable-warning (format nil "The state at tick ~D cannot be kept for REWIND: ~A."
                                  (simulation-tick simulation)
                                  (string-right-trim "." (brief-condition-text condition))))))

(defun make-fork-to-keep (simulation past)
  "Return a fork of SIMULATION, :BUSY if a participant is busy, or NIL if forking fails."
  (handler-case (call-through-participants #'participant-at-rest
                                           (simulation-participants simulation)
                             (lambda () (fork-now simulation nil '())))
    (misuse () :busy)
    (error (condition) (warn-of-unkept-fork simulation past condition))))

(defun discard-past-if-full (simulation past)
  (when (and (finite-p *journal-limit*) (> (past-count past) *journal-limit*))
    (setf (past-forks past) '() (past-acts past) '() (past-count past) 0)
    (queue-notable-warning (format nil "This run has had so many requests that REWIND can go back ~
                                        only to tick ~D; see *JOURNAL-LIMIT*."
                                   (simulation-tick simulation)))))

;; The clock is coarse, so the cost is averaged over many forks.
(defun update-fork-cost (past began)
  "Update the average cost of a fork in PAST with a fork that was begun at time BEGAN, in seconds."
  (let ((cost (+ (* 15/16 (past-cost past)) (* 1/16 (- (seconds-now) began)))))
    (setf (past-cost past) cost
          (past-due past) (if (< *fork-time-share* 1)
                              (+ began (/ (max cost +least-fork-cost+) *fork-time-share*))
                              began))))

(defun keep-fork (simulation past)
  "If a fork of SIMULATION can be made, keep it in PAST. SIMULATION is between ticks. If a
participant is busy, try again at the end of the next tick."
  (discard-past-if-full simulation past)
  (let* ((began (or (past-wanted past) (seconds-now)))
         (tick (simulation-tick simulation))
         (changes *definition-changes*)
         (fork (make-fork-to-keep simulation past)))
    (when (simulation-p fork)
      (push (make-fork-record fork tick (past-acts past) changes) (past-forks past))
      (loop with room = (most-forks simulation past)
            while (> (length (past-forks past)) room)
            do (removef (past-forks past) (least-needed-fork (past-forks past)))))
    (setf (past-pace past) 1
          (past-next past) (1+ tick)
          (past-wanted past) (if (eq :busy fork) began nil))
    (unless (eq :busy fork)
      (update-fork-cost past began))))

(defconstant +max-fork-wait-checks+ 100
  "How many times a thread checks whether the fork that it waits for was made, before it gives up.")

(defun fork-postponed-p (simulation)
  "True if a fork of SIMULATION was postponed because a participant was busy. Any thread may ask."
  (let ((past (simulation-past simulation)))
    (and past (past-wanted past) t)))

(defun await-postponed-fork (simulation)
  "If a fork of SIMULATION was postponed because this thread was busy, wait until the fork is made
at the end of the next tick. Give up after +MAX-FORK-WAIT-CHECKS+ checks, as the ticks may have
stopped."
  (let ((past (simulation-past simulation)) (moment (make-semaphore "kept fork")))
    (when (and past (past-wanted past))
      (loop repeat +max-fork-wait-checks+
            while (past-wanted past)
            do (serve-and-wait-once moment 0.002))
      (setf (past-wanted past) nil))))

(defun keep-fork-if-affordable (simulation past)
  "Keep a fork of SIMULATION in PAST unless too much time was spent on keeping forks."
  (cond ((>= (seconds-now) (past-due past)) (keep-fork simulation past))
        (t (setf (past-next past) (+ (simulation-tick simulation) (past-pace past))
                 (past-pace past) (min +most-ticks-between-clock-reads+ (* 2 (past-pace past)))))))

;;; Keeping forks on request.

(define-argument-type 'fork-count
  (lambda (value) (or (typep value 'boolean) (whole-p value 2 1000)))
  "a number of forks from 2 to 1000, T for 30 forks, or NIL for none")

(defun begin-keeping-forks (simulation limit)
  "Make SIMULATION, which this thread owns, keep at most LIMIT forks from now on."
  (let ((past (setf (simulation-past simulation) (make-past limit))))
    (when (eq simulation *simulation*) (update-rolled-dice simulation past))
    ;; Requests made before this tick, the earliest for REWIND, are not undone by it.
    (dolist (request (timeline-inbox (simulation-timeline simulation)))
      (when (zerop (request-phase request))
        (setf (request-phase request) (phase-number :continuations))))
    (when (zerop (timeline-phase (simulation-timeline simulation)))
      (keep-fork simulation past))))

(addition keep-forks)
(defun keep-forks (&optional (count t) (simulation (current-simulation)))
  "Make SIMULATION keep forks of itself from now on, so that REWIND can go back to this tick at the
earliest. COUNT is the largest number of forks, from 2 to 1000 and by default 30; for a very large
world it is smaller. NIL drops all forks and keeps no more. Recent forks are closer together than
old forks. Keeping forks takes about a hundredth of the run's time; requests to the run are kept,
too. Return nothing. Signals WRONG-ARGUMENT, and MISUSE if the run is over."
  (check-argument-type 'keep-forks 'count count 'fork-count)
  (let ((simulation (resolve-simulation simulation 'keep-forks)))
    (check-not-over simulation 'keep-forks)
    (asking (simulation)
      (let ((past (simulation-past simulation))
            (limit (if (eq t count) +default-fork-count+ count)))
        (cond ((null count) (setf (simulation-past simulation) nil))
              (past (setf (past-limit past) limit))
              (t (begin-keeping-forks simulation limit))))))
  (values))
