;;;; rewinding.lisp -- take a run back to an earlier tick, to continue from there in another way.

(in-package :ars-magna.run)

(export '(earliest-tick *rewind-hooks*))

;;; Rewinding a run makes a fork of the newest kept fork not later than the wanted tick, passes
;;; ticks of the new fork up to that tick, and replaces the run by it. The old run is then over. The
;;; fork becomes the current simulation and the value of the variables, has the run's observers and
;;; messages, and is live if the run was.

(define-event *rewind-hooks*
  "Functions of a run that is being rewound and of the one that is to go on in its place.")

;;; What may be rewound, and how far.

;; Nor another run than its own: who rewinds waits for a clock, and perhaps for this one.
(defun paced-here (simulation)
  "Return SIMULATION, or else the current one, if this is the thread of its clock; else NIL."
  (find-if (lambda (run) (and run (eq (current-thread) (simulation-thread run))))
           (list simulation *simulation*)))

(defun check-place-to-rewind (simulation)
  "Signal MISUSE where SIMULATION cannot be rewound because it is at work here, or not meant."
  (cond ((goes-on-in-forks-p)
         (reject-use "rewind: a plan is at work here, and would undo itself. PROJECT and TRY-BEST ~
                      look ahead instead."))
        ((paced-here simulation)
         (reject-use "rewind: ticks of ~A are passing here, in the thread of its clock. Rewind ~A ~
                      at the prompt or the REPL, or from a thread of your own."
                     (simulation-name (paced-here simulation)) (simulation-name simulation)))
        ((and (owner-p simulation)
              (or (timeline-passing-p (simulation-timeline simulation))
                  (plusp (timeline-phase (simulation-timeline simulation)))))
         (reject-use "rewind: ticks are passing here. Rewind the run when RUN-TICKS has returned."))
        ((and (headless-p simulation) (not (eq simulation *simulation*)))
         (reject-use "rewind: ~A is headless, and not the current simulation here. Rewind it where ~
                      it is: in the body of WITH-SIMULATION, or in CALL-IN-FORK."
                     (simulation-name simulation)))))

(defun earliest-tick (simulation)
  "Return the tick that SIMULATION can go back to, or NIL if it keeps no forks."
  (let ((past (simulation-past simulation)))
    (and past (past-forks past) (kept-tick (first (last (past-forks past)))))))

(defun check-past (simulation)
  "Signal MISUSE if SIMULATION has no past to go back to."
  (unless (earliest-tick simulation)
    (reject-use "rewind: nothing is kept of ~A that one could go back to. Ask for that at its ~
                 beginning, (with-simulation (ROBOT :keep t) ...) or (simulator ROBOT :keep t), ~
                 or from now on by (keep-forks)."
                (simulation-name simulation))))

(defun check-how-far (ticks simulation)
  "Signal WRONG-ARGUMENT unless SIMULATION can go back TICKS."
  (let* ((first (earliest-tick simulation))
         (most (- (simulation-tick simulation) first)))
    (unless (<= ticks most)
      (reject-argument "rewind" "ticks" ticks
                       (format nil "at most ~D: one can go back to tick ~D" most first)))))

;;; The run that goes on.

(defun past-until (tick simulation)
  "Return what the past of SIMULATION was at the end of TICK; and in a list, the newest first, what
had been asked of it by then and not yet been done."
  (let* ((past (simulation-past simulation))
         (acts (past-acts past)))
    (when (= tick (simulation-tick simulation))
      (setf acts (append (pending-acts simulation) acts)))
    (multiple-value-bind (done asked) (acts-until tick acts)
      (values (make-past (past-limit past)
                         :forks (remove-if (lambda (kept) (> (kept-tick kept) tick))
                                           (past-forks past))
                         :acts done
                         :cost (past-cost past))
              asked))))

(defun warn-of-straying (run tick)
  (let ((*message-queue* (simulation-messages run)))
    (warn-notably (format nil "Not all is as it was: a plan goes another way than it went from ~
                               tick ~D on, as it may if it depends on what is outside of its run."
                          tick))))

(defun repeat-past (past asked tick)
  "Return a run that is what the one of PAST was at the end of TICK, when ASKED had been asked of
it, and the tick at which plans strayed on the way, or NIL."
  (let* ((kept (first (past-forks past)))
         (run (await-fork (kept-fork kept) nil '()))
         (acts (reverse (ldiff (append asked (past-acts past)) (kept-acts kept))))
         (done-p nil))
    (unwind-protect
         (let ((strayed (call-inside run (lambda () (redo run acts tick)))))
           (setf (simulation-past run) past
                 done-p t)
           (values run strayed))
      (unless done-p (release-fork run)))))

;;; Its place.

(defun variable-setter (old)
  "Return the function of a symbol and a value that sets what is bound, or global, for OLD."
  (cond ((headless-p old) #'set)
        ((not (eq old *simulation*)) (lambda (symbol value) (setf (global-value symbol) value)))
        ((eq old (global-value '*simulation*))
         (lambda (symbol value) (setf (global-value symbol) value (symbol-value symbol) value)))
        (t #'set)))

(defun set-variables (new old)
  "Let the variables be what they are for NEW, where they are bound, or global, for OLD."
  (let ((setter (variable-setter old)))
    (loop for (symbol . value) in (simulation-environment new)
          do (funcall setter symbol value))
    (loop for parameter in (all-parameters)
          for value across (simulation-known-parameters new)
          do (funcall setter (parameter-symbol parameter) value))
    (funcall setter '*simulation* new)
    (funcall setter '*world* (simulation-world new))))

(defun settle-in-map (new)
  "Let the world of NEW be the one that top-level code works in, and its robots be called by name."
  (let ((world (simulation-world new)))
    (setf (map-resident (world-map world)) world)
    (dolist (robot (world-robots world))
      (set-robot (robot-blueprint robot) robot))))

(defun hand-over-looks (new old)
  "Let NEW have what OLD has of those outside: who looks on, the gate, the messages."
  (succeed-in-line new old)
  (setf (simulation-observers new) (simulation-observers old)
        (simulation-gate new) (simulation-gate old)
        (simulation-messages new) (simulation-messages old)
        (simulation-messages old) (make-message-queue))
  (tell-listeners *rewind-hooks* old new))

(defun end-rewound (old new)
  "Let OLD be over, as NEW goes on in its place."
  (let ((reason (format nil "it was rewound to tick ~D, and another run goes on from there: ~
                             *SIMULATION*, where it was rewound"
                        (simulation-tick new))))
    (retire-robots (simulation-robots old) reason)
    (end-simulation old reason)
    (setf (simulation-past old) nil)))

(defun hand-over-errors (new old)
  "Let NEW tell of the errors that came up when OLD ended, in users' code that was told so."
  (dolist (message (take-messages (simulation-messages old)))
    (when (eq :error (message-kind message))
      (queue-message message (simulation-messages new)))))

(defun succeed-to (new old from)
  "Let NEW be, in all respects, what OLD, which had come to the tick FROM, was."
  (let ((resident-p (not (headless-p old)))
        (current-p (or (eq old *simulation*) (eq old (global-value '*simulation*)))))
    (note-rewound from new)
    (when current-p (set-variables new old))
    (when resident-p (settle-in-map new))
    (unless (fork-p old)
      (setf (simulation-environment new) '()
            (simulation-variables new) (simulation-variables old)
            (timeline-fork-p (simulation-timeline new)) nil))
    (hand-over-errors new old)))

(defun take-the-place (new old then)
  "Let NEW go on in the place of OLD, which this thread has in custody; at last call THEN. Programs
are told that OLD is over; wherever they throw, and whatever interrupts this thread, NEW goes on."
  (check-not-over old 'rewind)
  (let ((from (simulation-tick old)))
    ;; A thread waiting for custody gets it once NEW has replaced OLD.
    (setf (timeline-custody (simulation-timeline new)) (timeline-custody (simulation-timeline old)))
    (deferring-interrupts
      (in-any-case
        (hand-over-looks new old)
        (end-rewound old new)
        (succeed-to new old from)
        (funcall then)))))

(defun start-in-place (new old rate paused-p)
  "Let NEW, which has taken the place of OLD, be live at RATE as that was; unless somebody has
stopped OLD meanwhile."
  (when (claimed-p (simulation-timeline old))
    (start-clock new :rate rate :paused-p paused-p
                     :real (eq :real (simulation-thinking new)))))

(defun replace-run (new old)
  "Let NEW go on in the place of OLD, live if that is. Return NEW. Signals MISUSE if OLD is over,
and releases NEW."
  (let* ((timeline (simulation-timeline old))
         (rate (simulation-rate old)) (paused-p (paused-p old))
         (live-p (claim-pacing timeline))
         (done-p nil))
    (in-any-case
      (call-alone timeline
                  (lambda ()
                    (take-the-place new old
                                    (lambda ()
                                      (setf done-p t)
                                      (when live-p
                                        (start-in-place new old rate paused-p))))))
      (unless done-p (release-fork new)))
    new))

;;; What the journal says of it.

(defun note-rewound (from &optional (simulation (current-simulation)))
  "Let the journal of SIMULATION say that it had come to the tick FROM, and was rewound to now."
  (note simulation 'rewound (list from)))

(define-operator 'rewound '(integer) #'note-rewound)

(defvar *rewinding-lock* (make-lock "rewinding")
  "What whoever rewinds a run holds: one after the other.")

(defun rewind-now (ticks simulation)
  "Do what REWIND says, while nobody else rewinds anything."
  (multiple-value-bind (tick past asked)
      (asking (simulation)
        (check-past simulation)
        (check-how-far ticks simulation)
        (let ((tick (- (simulation-tick simulation) ticks)))
          (multiple-value-call #'values tick (past-until tick simulation))))
    (multiple-value-bind (run strayed) (repeat-past past asked tick)
      (replace-run run simulation)
      (when strayed (warn-of-straying run strayed))
      run)))

(addition rewind)
(defun rewind (ticks &optional (simulation (current-simulation)))
  "Take SIMULATION back TICKS ticks, plans included. Return the simulation that continues from
there. It is the current one then, its robots are the values of their variables, and it is live, at
the same rate, if SIMULATION was. SIMULATION itself is over; its robots take no more commands. It
must keep forks, see KEEP-FORKS. TICKS is a number from 0, which undoes what was done since the last
tick, to how many have passed since it began to keep them.
- Requests and changes after that tick have not happened. The journal records the rewind.
- Commands and plans in progress continue. Programs do not: continuations of commands in progress at
  the call receive :INTERRUPT now, and those of commands that continue are never called. So a
  program such as ROBOT-GO-TO issues no further commands.
- RUN-PLAN, waiting in another thread, returns :STOPPED.
- Messages are kept, and so are variables that programs have set themselves.
- For RUN-TICKS, RUN-UNTIL and CALL-IN-FORK, a fork that was rewound stands for its successor; its
  digest is of its last state.
Signals WRONG-ARGUMENT, with the largest possible number of ticks; MISUSE inside ticks and plans, in
the thread of any clock, and if SIMULATION is over."
  (let ((simulation (simulation-meant simulation 'rewind)))
    (check-argument rewind ticks (typep ticks 'unsigned-byte)
                    "a whole number of ticks, 0 or more")
    (check-not-over simulation 'rewind)
    (check-place-to-rewind simulation)
    (call-when-free *rewinding-lock*
                    (lambda ()
                      ;; Another thread may have been first.
                      (check-not-over simulation 'rewind)
                      (rewind-now ticks simulation)))))
