;;;; rewinding.lisp -- take a run back to an earlier tick and continue from there.

(in-package :ars-magna.run)

(export '(earliest-tick *rewind-hooks*))

;;; Rewinding a run makes a fork of the newest kept fork not later than the wanted tick, passes
;;; ticks of the new fork up to that tick, and replaces the run by it. The old run is then over. The
;;; fork becomes the current simulation and its robots the values of their variables. It has the
;;; run's observers and messages, and is live if the run was.

(define-event *rewind-hooks*
  "Functions that are called when a run is rewound, with the run and its successor.")

;;; Checks.

;; A clock's thread must not rewind other runs either: it and their clocks might await each other.
(defun run-paced-by-this-thread (simulation)
  "Return SIMULATION if its clock runs in this thread. Otherwise return the current simulation if
its clock runs in this thread, else NIL."
  (find-if (lambda (run) (and run (eq (current-thread) (simulation-thread run))))
           (list simulation *simulation*)))

(defun check-rewind-allowed-here (simulation)
  "Signal MISUSE if this code runs inside SIMULATION, or SIMULATION is headless and not current."
  (cond ((continues-in-forks-p)
         (reject-use "rewind: a plan cannot rewind its own run. Use PROJECT or TRY-BEST to look ~
                      ahead."))
        ((run-paced-by-this-thread simulation)
         (reject-use "rewind: this thread passes the ticks of ~A. Rewind ~A at the prompt or the ~
                      REPL, or from a thread of your own."
                     (simulation-name (run-paced-by-this-thread simulation))
                     (simulation-name simulation)))
        ((and (owner-p simulation)
              (or (timeline-passing-p (simulation-timeline simulation))
                  (plusp (timeline-phase (simulation-timeline simulation)))))
         (reject-use "rewind: ticks are passing in this thread. Rewind the run when RUN-TICKS has ~
                      returned."))
        ((and (headless-p simulation) (not (eq simulation *simulation*)))
         (reject-use "rewind: ~A is headless, and not the current simulation. Call REWIND where it ~
                      is the current simulation: in the body of WITH-SIMULATION, or in ~
                      CALL-IN-FORK."
                     (simulation-name simulation)))))

(defun earliest-tick (simulation)
  "Return the earliest tick that SIMULATION can be rewound to, or NIL if it keeps no forks."
  (let ((past (simulation-past simulation)))
    (and past (past-forks past) (fork-record-tick (first (last (past-forks past)))))))

(defun check-keeps-forks (simulation)
  (unless (earliest-tick simulation)
    (reject-use "rewind: ~A keeps no forks to go back to. Keep forks from now on by ~
                 (keep-forks), or from the beginning of the run by (with-simulation (ROBOT ~
                 :keep t) ...) or (simulator ROBOT :keep t)."
                (simulation-name simulation))))

(defun check-rewind-distance (ticks simulation)
  (let* ((first (earliest-tick simulation))
         (most (- (simulation-tick simulation) first)))
    (unless (<= ticks most)
      (reject-argument "rewind" "ticks" ticks
                       (format nil "at most ~D: you can go back to tick ~D" most first)))))

;;; Making the successor.

(defun past-until (tick simulation)
  "Return two values: the past of SIMULATION at the end of the tick TICK; and a list, the newest
first, of requests made but not performed by then."
  (let* ((past (simulation-past simulation))
         (acts (past-acts past)))
    (when (= tick (simulation-tick simulation))
      (setf acts (append (pending-acts simulation) acts)))
    (multiple-value-bind (done asked) (acts-until tick acts)
      (values (make-past (past-limit past)
                         :forks (remove-if (lambda (kept) (> (fork-record-tick kept) tick))
                                           (past-forks past))
                         :acts done
                         :cost (past-cost past))
              asked))))

(defun warn-of-divergence (run tick)
  (let ((*message-queue* (simulation-messages run)))
    (queue-notable-warning (format nil "The rewound run differs from the original: from tick ~D on ~
                                        a plan acts differently, which can happen if it depends on ~
                                        state outside its run."
                                   tick))))

(defun repetition-text (since tick)
  "Return a sentence about the state at TICK, which was reached from that at the tick SINCE with
definitions that have changed."
  (if (= since tick)
      (format nil "The state at tick ~D is as it was." tick)
      (format nil "The run was repeated from tick ~D to tick ~D with what is defined now, so the ~
                   state at tick ~:*~D may differ from what it was." since tick)))

(defun warn-of-redefinitions (kept run)
  "Queue a warning if definitions that RUN may use have changed since the fork KEPT was made, which
was advanced to the current tick of RUN."
  (multiple-value-bind (plans others) (definitions-changed-since (fork-record-changes kept) run)
    (let ((since (fork-record-tick kept)) (tick (simulation-tick run))
          (*message-queue* (simulation-messages run)))
      (when (if (< since tick)
                (or plans others)
                (and plans (some #'participant-unfinished (simulation-participants run))))
        (queue-notable-warning
         (format nil "Redefined since tick ~D: ~{~A~^, ~}. ~A~@[ ~A~]"
                 since (append plans others) (repetition-text since tick)
                 (and plans (format nil "Calls of plans in progress at tick ~D keep the old ~
                                         definition; later calls run the new one from its ~
                                         beginning." since))))))))

;; Otherwise such a robot would just stop.
(defun warn-of-ended-programs (run text)
  "Queue warnings about commands in progress in RUN that continuations have issued: TEXT, a format
control, with the robot and the command."
  (let ((*message-queue* (simulation-messages run)))
    (dolist (robot (simulation-robots run))
      (loop for (nil nil nil command nil asker) in (mapcan #'command-in-progress-status
                                                           (cons robot (robot-parts robot)))
            do (when (starts-with-subseq "the continuation of " asker)
                 (queue-notable-warning (format nil text (robot-label robot) command)))))))

(defun repeat-past (past asked tick)
  "Return two values: a copy of the run of PAST at the end of the tick TICK, with the requests ASKED
waiting; and the tick at which a plan diverged while the past was repeated, or NIL."
  (let* ((kept (first (past-forks past)))
         (run (await-fork (fork-record-fork kept) nil '()))
         (acts (reverse (ldiff (append asked (past-acts past)) (fork-record-acts kept))))
         (changes *definition-changes*)
         (done-p nil))
    (bind-joining-robots run (append asked acts))
    (unwind-protect
         (let ((diverged (call-in-simulation run (lambda () (repeat-acts run acts tick)))))
           ;; From here on, the run has gone by the definitions of now since the tick of KEPT.
           (push (make-fork-record (fork-record-fork kept) (fork-record-tick kept)
                                   (fork-record-acts kept) changes)
                 (past-forks past))
           (removef (past-forks past) kept)
           (setf (simulation-past run) past
                 done-p t)
           (values run diverged))
      (unless done-p (release-fork run)))))

;;; Replacing the run.

(defun variable-setter (old)
  "Return a function of a symbol and a value. The function sets the symbol where code in OLD sees
it: the binding, the global value or both."
  (cond ((headless-p old) #'set)
        ((not (eq old *simulation*)) (lambda (symbol value) (setf (global-value symbol) value)))
        ((eq old (global-value '*simulation*))
         (lambda (symbol value) (setf (global-value symbol) value (symbol-value symbol) value)))
        (t #'set)))

(defun robot-without-variable-p (symbol value)
  "True if VALUE is the robot called SYMBOL and has left its run."
  (and (robot-p value) (eq symbol (robot-name value)) (robot-retired value)))

(defun take-over-variables (new old)
  "Set the variables of OLD to their values in NEW, where code in OLD sees them."
  (let ((setter (variable-setter old)))
    (loop for (symbol . value) in (simulation-environment new)
          do (unless (robot-without-variable-p symbol value) (funcall setter symbol value)))
    (loop for parameter in (all-parameters)
          for value across (simulation-known-parameters new)
          do (funcall setter (parameter-symbol parameter) value))
    (funcall setter '*simulation* new)
    (funcall setter '*world* (simulation-world new))))

(defun restore-definitions-of-robots (new old)
  "Restore the definitions of robots as they were where NEW, which replaces the run OLD of a
resident world, begins. Queue a message that names the robots concerned."
  (let* ((robots (world-robots (simulation-world new)))
         (joined (set-difference (world-robots (simulation-world old)) robots :key #'robot-name))
         (restored (remove-if-not #'restore-definition robots))
         (removed (remove-if-not #'take-definition-back joined)))
    (when restored
      (message-set (format nil "~{~A~^, ~} ~:[is~;are~] again defined as at tick ~D."
                           (mapcar #'robot-label restored) (rest restored)
                           (simulation-tick new))))
    (when removed
      (message-set (format nil "~{~A~^, ~} joined after tick ~D and ~:[is~;are~] no longer defined."
                           (mapcar #'robot-label removed) (simulation-tick new) (rest removed))))))

(defun make-world-resident (new)
  "Make the world of NEW the world of top-level code, and set the variables of its robots."
  (let ((world (simulation-world new)))
    (setf (map-resident (world-map world)) world)
    (mapc #'bind-robot-name (world-robots world))))

(defun hand-over-observers (new old)
  "Make NEW the successor of OLD, and give NEW the observers, gate and messages of OLD."
  (link-successor new old)
  (setf (simulation-observers new) (simulation-observers old)
        (simulation-gate new) (simulation-gate old)
        (simulation-messages new) (simulation-messages old)
        (simulation-messages old) (make-message-queue))
  (call-listeners *rewind-hooks* old new))

(defun end-rewound-run (old new)
  (let ((reason (format nil "it was rewound to tick ~D, and a new run continues from there: the ~
                             value of *SIMULATION* where REWIND was called"
                        (simulation-tick new))))
    (retire-robots (simulation-robots old) reason)
    (end-simulation old reason)
    (setf (simulation-past old) nil)))

(defun move-errors (new old)
  "Move the errors that users' code has signalled at the end of OLD to the messages of NEW."
  (dolist (message (take-messages (simulation-messages old)))
    (when (eq :error (message-kind message))
      (queue-message message (simulation-messages new)))))

(defun take-over-state (new old from)
  "Record in NEW the rewind from the tick FROM. If OLD is current, give its variables their values
in NEW. If its world is resident, make that of NEW resident. Move errors of OLD to NEW."
  (let ((current-resident-world-p (not (headless-p old)))
        (current-p (or (eq old *simulation*) (eq old (global-value '*simulation*)))))
    (record-rewind from new)
    (when current-resident-world-p
      (restore-definitions-of-robots new old)
      (when (simulation-journal new) (merge-journal-definitions new)))
    (when current-p (take-over-variables new old))
    (when current-resident-world-p (make-world-resident new))
    (unless (fork-p old)
      (setf (simulation-environment new) '()
            (simulation-variables new) (simulation-variables old)
            (timeline-fork-p (simulation-timeline new)) nil))
    (move-errors new old)))

(defun replace-owned-run (new old then)
  "Replace OLD, which this thread owns, by NEW; then call THEN. Continuations of OLD are called, as
OLD is over. Non-local exits from continuations and interrupts of this thread do not stop the
replacement."
  (check-not-over old 'rewind)
  (let ((from (simulation-tick old)))
    ;; A thread waiting for custody gets it once NEW has replaced OLD.
    (setf (timeline-custody (simulation-timeline new)) (timeline-custody (simulation-timeline old)))
    (deferring-interrupts
      (in-any-case
        (hand-over-observers new old)
        (end-rewound-run old new)
        (take-over-state new old from)
        (funcall then)))))

(defun start-successor (new old rate paused-p)
  "Run NEW, which has replaced OLD, live at RATE, unless another thread has stopped OLD meanwhile."
  (when (pacing-claimed-p (simulation-timeline old))
    (start-clock new :rate rate :paused-p paused-p
                     :real (eq :real (simulation-thinking new)))))

(defun replace-run (new old)
  "Replace OLD by NEW, and run NEW live if OLD is live. Return NEW. If OLD is over, release NEW and
signal MISUSE."
  (let* ((timeline (simulation-timeline old))
         (rate (simulation-rate old)) (paused-p (paused-p old))
         (live-p (claim-pacing timeline))
         (done-p nil))
    (in-any-case
      (call-without-clock timeline
                          (lambda ()
                            (replace-owned-run new old
                                               (lambda ()
                                                 (setf done-p t)
                                                 (when live-p
                                                   (start-successor new old rate paused-p))))))
      (unless done-p (release-fork new)))
    new))

;;; The journal.

(defun record-rewind (from &optional (simulation (current-simulation)))
  "Record a rewind from the tick FROM to the current tick in the journal of SIMULATION."
  (record-operation simulation 'rewound (list from)))

(define-operator 'rewound '(integer) #'record-rewind)

(defvar *rewinding-lock* (make-lock "rewinding")
  "The lock held by the thread that rewinds a run: only one thread at a time can rewind.")

(defun rewind-with-lock (ticks simulation)
  (multiple-value-bind (tick past asked)
      (asking (simulation)
        (check-keeps-forks simulation)
        (check-rewind-distance ticks simulation)
        (let ((tick (- (simulation-tick simulation) ticks)))
          (multiple-value-call #'values tick (past-until tick simulation))))
    (let ((kept (first (past-forks past))))
      (multiple-value-bind (run diverged) (repeat-past past asked tick)
        (replace-run run simulation)
        (when diverged (warn-of-divergence run diverged))
        (warn-of-redefinitions kept run)
        (warn-of-ended-programs
         run "~A: the program that issued ~(~A~) ends here. After a rewind, plans go on, but ~
              chains of continuations do not.")
        run))))

(addition rewind)
(defun rewind (ticks &optional (simulation (current-simulation)))
  "Take SIMULATION back TICKS ticks, plans included. Return the new simulation, which continues from
that tick. The new simulation becomes the current simulation, with its robots as the values of their
variables, and is live, at the same rate, if SIMULATION was live. SIMULATION itself is over; its
robots take no more commands. SIMULATION must keep forks, see KEEP-FORKS. TICKS is a number from 0
to the number of ticks that have passed since SIMULATION began to keep forks; 0 undoes the requests
and changes since the last tick.
- Requests and changes after that tick are undone. The journal records the rewind. In a live run,
robots are defined as at that tick: what DEFROBOT and UNDEFINE have done since is undone.
- Commands and plans in progress at that tick continue, but programs do not. When REWIND is
  called, continuations of commands in progress receive :INTERRUPT. Commands that continue after
  that never call their continuations. So a program such as ROBOT-GO-TO issues no further commands.
- A call of RUN-PLAN that waits in another thread returns :STOPPED.
- Messages are kept, and so are variables that programs have set themselves.
- The run may be repeated from an earlier tick, with what is defined now. A warning names plans and
  other definitions that have changed since then: the state may differ from what it was.
- RUN-TICKS, RUN-UNTIL and CALL-IN-FORK use the successor of a fork that was rewound. The digest of
  such a fork remains that of its last state.
Signals WRONG-ARGUMENT, which names the largest possible number of ticks. Signals MISUSE inside
ticks and plans, in the thread of any clock, and if SIMULATION is over."
  (let ((simulation (resolve-simulation simulation 'rewind)))
    (check-argument rewind ticks (typep ticks 'unsigned-byte)
                    "a whole number of ticks, 0 or more")
    (check-not-over simulation 'rewind)
    (check-rewind-allowed-here simulation)
    (call-when-free *rewinding-lock*
                    (lambda ()
                      ;; Another thread may have been first.
                      (check-not-over simulation 'rewind)
                      (rewind-with-lock ticks simulation)))))
