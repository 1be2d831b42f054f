;;;; forking.lisp -- copying a run in its current state, plans included.

(in-package :ars-magna.run)

(export '(call-with-fork *fork-operator* refuse-fork counterpart-in-current-run))

;;; A fork is a headless run with its own world. The variables bound in the original (its robots,
;;; the fluents of plans) are copied as well: the fork keeps their values as its environment, which
;;; is bound while code works in the fork.

(defvar *fork-operator* 'fork-simulation
  "The operator that the user called to make the fork, for error messages.")

(defun refuse-fork (reason &rest arguments)
  "Signal MISUSE: no fork can be made. The message is REASON, a format control for ARGUMENTS."
  (reject-use "~(~A~): ~?" *fork-operator* reason arguments))

(defmethod copy-plan-value ((simulation simulation) fork)
  (if (eq simulation (copier-option fork :simulation))
      (copy-slots simulation fork)
      simulation))

(defmethod copy-plan-value ((timeline timeline) fork)
  (if (eq timeline (simulation-timeline (copier-option fork :simulation)))
      (copy-slots timeline fork)
      timeline))

(defun copy-run (simulation copier)
  "Return a copy of SIMULATION, made by COPIER, with the participants in its options and no
journal."
  (let ((copy (copying (copier)
                (forked (simulation-world simulation) copier)
                (let ((copy (forked simulation copier)))
                  (setf (simulation-participants copy)
                        (loop for participant in (copier-option copier :participants)
                              for twin = (participant-copy participant copy copier)
                              when twin collect twin)
                        (simulation-environment copy)
                        (loop for (symbol . value) in (copier-environment copier)
                              collect (cons symbol (forked value copier)))
                        (simulation-variables copy)
                        (mapcar #'car (copier-environment copier))
                        (simulation-plans-dice-p copy) (simulation-plans-dice-p simulation))
                  copy))))
    (setf (timeline-run (simulation-timeline copy)) copy
          (timeline-fork-p (simulation-timeline copy)) t)
    copy))

(defun fork-options (simulation continuations decisions)
  "Return the options of a copier that forks SIMULATION. It copies continuations of commands only if
CONTINUATIONS is true. DECISIONS is an alist from values that cannot be copied to replacements."
  (list :simulation simulation
        :world (simulation-world simulation)
        :participants (simulation-participants simulation)
        :continuations continuations
        :decisions decisions
        :place-of (lambda (value)
                    (some (lambda (participant) (participant-place participant value))
                          (simulation-participants simulation)))))

(defun copy-without-participants (simulation)
  (with-copier (copier :options (list :simulation simulation
                                      :world (simulation-world simulation)))
    (copy-run simulation copier)))

(defun environment-for-fork (simulation)
  "Return the environment to copy for a fork of SIMULATION: an alist from variables to values. If
SIMULATION has no dice for CL:RANDOM, as in a live run, new dice are made."
  (let ((environment (environment-of simulation)))
    (if (assoc *random-state-variable* environment)
        environment
        (acons *random-state-variable* (seeded-random-state (+ (simulation-seed simulation)
                                                               (simulation-tick simulation)))
               environment))))

;; If a continuation makes a fork, other continuations and plans have not acted yet in that tick.
(defun finish-tick (fork phase)
  "FORK was made in the phase PHASE of a tick. Pass the rest of this tick."
  (when (<= (phase-number :continuations) phase (phase-number :observers))
    (call-in-simulation fork (lambda ()
                               (deliver-notifications (simulation-timeline fork))
                               (let-participants-act fork)))))

(defun fork-now (simulation continuations decisions)
  "Return a fork of SIMULATION, which is between ticks. For CONTINUATIONS and DECISIONS see
FORK-OPTIONS. Signals MISUSE inside a tick, and CANNOT-FORK."
  (when (simulation-inside-tick-p simulation)
    (refuse-fork "a tick is under way. Fork the run between ticks, as in a continuation."))
  (when (eq simulation *simulation*) (record-settings simulation))
  (let ((copy (with-copier (copier :environment (environment-for-fork simulation)
                                   :options (fork-options simulation continuations decisions))
                (copy-run simulation copier)))
        (journal (simulation-journal simulation)))
    (setf (simulation-messages copy) (copy-message-queue (simulation-messages simulation))
          (simulation-trails copy) (simulation-trails simulation))
    (share-warnings simulation copy)
    (when journal
      (setf (simulation-journal copy) (copied-journal journal (simulation-tick simulation))))
    (finish-tick copy (timeline-phase (simulation-timeline simulation)))
    copy))

;;; A participant may be busy in another thread.

(defun call-through-participants (caller participants function)
  "Call FUNCTION inside nested calls of CALLER, such as PARTICIPANT-AT-REST, one call for each of
the PARTICIPANTS. Return the value of FUNCTION."
  (if participants
      (funcall caller (first participants)
               (lambda () (call-through-participants caller (rest participants) function)))
      (funcall function)))

(defconstant +fork-attempts+ 2000
  "The maximum number of attempts to make a fork, one each tick or every few milliseconds.")

(defun keep-trying-to-fork (simulation try)
  "Call the function TRY until it returns a fork of SIMULATION instead of :BUSY; return the fork.
Signals MISUSE after +FORK-ATTEMPTS+ attempts."
  (loop with moment = (make-semaphore "fork")
        repeat +fork-attempts+
        for fork = (funcall try)
        unless (eq :busy fork) return fork
        do (serve-and-wait-once moment 0.002)
        finally (refuse-fork "the plans of ~A are still working. Let plans wait between long calls ~
                              of Lisp functions, or end them by (end-plan :all)."
                             (simulation-name simulation))))

(defun await-fork (simulation continuations decisions)
  "Return a fork as FORK-NOW does, once SIMULATION is between ticks and its participants at rest."
  (flet ((try ()
           (asking (simulation)
             (call-through-participants #'participant-at-rest (simulation-participants simulation)
                          (lambda () (fork-now simulation continuations decisions))))))
    (let ((fork (try)))
      (if (eq :busy fork)
          (call-through-participants #'call-as-participant-makes-way
                                     (simulation-participants simulation)
                       (lambda () (keep-trying-to-fork simulation #'try)))
          fork))))

;; The restarts are made in this thread, which asked for the fork: another may own the run.
(defun ask-about-uncopiable-value (condition)
  "Signal CONDITION, a CANNOT-FORK, with restarts. Return two values: the fork's replacement for the
value that cannot be copied, and true. If the user wants no fork, return NIL and false."
  (restart-case (error condition)
    (share-value ()
      :report "Let both runs have the same one."
      (values (cannot-fork-value condition) t))
    (leave-out-value () :report "Let the fork have NIL instead." (values nil t))
    (make-no-fork () :report "Make no fork, but return NIL." (values nil nil))))

(defun fork-or-ask (simulation continuations)
  "Return a fork of SIMULATION, or NIL if the user has chosen to make none."
  (let ((decisions '()))
    (collect-garbage-early (octets-of-copy (simulation-world simulation)))
    (loop
      (handler-case (return (await-fork simulation continuations decisions))
        (cannot-fork (condition)
          (multiple-value-bind (replacement decided-p) (ask-about-uncopiable-value condition)
            (unless decided-p (return nil))
            (push (cons (cannot-fork-value condition) replacement) decisions)))))))

(defun parse-fork-arguments (arguments)
  "Parse ARGUMENTS of FORK-SIMULATION. Return the simulation and the plist of options."
  (if (keywordp (first arguments))
      (values (current-simulation) arguments)
      (values (if arguments
                  (resolve-simulation (first arguments) *fork-operator*)
                  (current-simulation))
              (rest arguments))))

(defun check-fork-options (options)
  (check-argument fork-simulation options
                  (and (evenp (length options))
                       (loop for key in options by #'cddr
                             always (member key '(:seed :continuations))))
                  "(fork-simulation [simulation] [:seed integer] [:continuations boolean])")
  (let ((seed (getf options :seed)))
    (unless (typep seed '(or null integer))
      (reject-argument *fork-operator* 'seed seed "an integer, or NIL"))))

(addition fork-simulation)
(defun fork-simulation (&rest arguments)
  "Return a headless copy of a run at the same tick, with its own world, robots, agenda, parameters,
dice, messages and journal, and the plans in progress. The copy continues exactly as the original
would, given the same requests. ARGUMENTS are the simulation, by default the current one, and
  :seed           an integer that seeds all further randomness in the copy
  :continuations  true to copy the continuations of commands in progress, too, with the values
                  they close over; by default only continuations of plans are called in the fork
- Each run has its own fluents and valves, including those in global variables. WITH-FORK binds the
  robots' names; other global variables are shared.
- Code that runs in the fork must not change or command the original run: that signals MISUSE.
  COUNTERPART returns the fork's own objects.
- A live run is forked between two ticks. In a live run, CL:RANDOM uses the dice of each thread; in
  the fork it draws other numbers. All else continues as in the original.
- Observers stay with the original.
Signals MISUSE inside a tick and inside a plan's own step; a continuation runs between ticks.
Signals CANNOT-FORK, with restarts, for state outside the run; MAKE-NO-FORK returns NIL."
  (multiple-value-bind (simulation options) (parse-fork-arguments arguments)
    (check-fork-options options)
    (check-not-over simulation *fork-operator*)
    (mapc #'check-forkable (simulation-participants simulation))
    (setf (simulation-forked-p simulation) t)
    (let ((fork (fork-or-ask simulation (getf options :continuations)))
          (seed (getf options :seed)))
      (when fork
        (setf (message-queue-error-policy (simulation-messages fork))
              (message-queue-error-policy (simulation-messages simulation)))
        (when seed (call-in-simulation fork (lambda () (set-seed seed fork)))))
      fork)))

(addition release-fork)
(defun release-fork (fork)
  "End FORK, a simulation that FORK-SIMULATION returned. Commands and plans in FORK do not continue,
and no continuation is called; unread errors go to the error output. Return nothing. Signals
WRONG-ARGUMENT if FORK is no fork."
  (check-argument release-fork fork (and (simulation-p fork) (fork-p fork))
                  "a fork, as FORK-SIMULATION returns")
  (let ((fork (latest-successor fork)))
    (unless (simulation-over fork)
      (show-unread-messages (simulation-messages fork))
      (setf (timeline-over (simulation-timeline fork)) "the fork has been released")))
  (values))

(defun call-with-fork (function &rest options)
  "Call FUNCTION in a fork of the current simulation, made with OPTIONS; see WITH-FORK."
  (let ((fork (let ((*fork-operator* 'with-fork)) (apply #'fork-simulation options))))
    (when fork
      (in-any-case
        (multiple-value-prog1 (call-in-simulation fork function)
          (signal-pending-error (simulation-messages (latest-successor fork))))
        (release-fork fork)))))

(addition with-fork)
(define-user-macro with-fork ((&key seed continuations) &body body)
  "Run BODY in a fork of the current simulation, see FORK-SIMULATION. In BODY, the fork is the
current simulation, and the robots' names mean the robots of the fork. The fork ends with BODY.
Return the values of BODY, or NIL if no fork could be made. Errors in users' code are treated as in
the original run, see WITH-SIMULATION."
  `(call-with-fork (lambda () ,@body) :seed ,seed :continuations ,continuations))

(addition call-in-fork)
(defun call-in-fork (fork function)
  "Call FUNCTION, without arguments, with FORK as the current simulation and robots bound as in
WITH-FORK. Return the values of FUNCTION. You can call CALL-IN-FORK several times for the same FORK.
If FORK was rewound, its successor is used."
  (check-argument call-in-fork fork (and (simulation-p fork) (fork-p fork))
                  "a fork, as FORK-SIMULATION returns")
  (check-argument call-in-fork function (functionp function) "a function of no arguments")
  (call-in-simulation (latest-successor fork) function))

;;; The copy of an object in a fork.

(defgeneric counterpart-in-current-run (object)
  (:documentation "Return the copy of OBJECT in the current simulation, or NIL. OBJECT belongs to
the run that was forked. Signals WRONG-ARGUMENT for an object that does not belong to a run.")
  (:method (object)
    (reject-argument 'counterpart "object" object
                     (one-line "a robot, a part of one, a thing, a designator, an odometer, a
task, a fluent or a valve"))))

(defmethod counterpart-in-current-run ((robot robot))
  (find (robot-name robot) (simulation-robots *simulation*) :key #'robot-name :test #'eq))

(defmethod counterpart-in-current-run ((part part))
  (let ((robot (counterpart-in-current-run (part-robot part))))
    (and robot (robot-part robot (type-of part) (part-index part)))))

(defmethod counterpart-in-current-run ((odometer odometer))
  (let ((robot (counterpart-in-current-run (odometer-robot odometer))))
    (and robot (robot-odometer robot (odometer-name odometer)))))

(defmethod counterpart-in-current-run ((designator designator))
  (let ((robot (counterpart-in-current-run (designator-robot designator))))
    (and robot (designator-with-serial robot (designator-serial designator)))))

(defmethod counterpart-in-current-run ((thing thing))
  (find-thing (thing-serial thing) *world*))

(addition counterpart)
(defun counterpart (object &optional (fork (current-simulation)))
  "Return the copy of OBJECT in FORK, by default the current simulation. FORK is a direct or
indirect fork of the run of OBJECT, or the successor of that run after REWIND. OBJECT may be a
robot, part, thing, designator, odometer, task, fluent or valve. Return NIL if FORK has no copy: the
thing is destroyed there, the designator invalid, or the task over. Signals WRONG-ARGUMENT."
  (check-argument counterpart fork
                  (and (simulation-p fork) (or (fork-p fork) (simulation-line fork)))
                  "a fork, as FORK-SIMULATION returns, or a run that was rewound")
  (call-in-simulation (latest-successor fork) (lambda () (counterpart-in-current-run object))))
