;;;; watcher.lisp -- the state of time in a run, and snapshots of it, at no cost to its ticks.

(in-package :ars-magna.clim)

(defstruct (progress (:copier nil))
  "How time passes in a run. STATE is a keyword, see STATE-WORDS. MORE is a text that continues the
words for STATE, or NIL. RATE is the rate that was set: ticks per second, :FREE or NIL. REACHED is
the measured rate in ticks per second, or NIL if it is unknown."
  (state :still :type symbol :read-only t)
  (more nil :type (or null string) :read-only t)
  (rate nil :read-only t)
  (reached nil :type (or null real) :read-only t))

(defstruct (rate-sample (:copier nil))
  "The results of the last look at a run. LAST-TICK is the tick, and CALLS the number of calls of
user code. Measuring began at TICK and SECONDS. REACHED is the rate in ticks per second, or NIL."
  (last-tick 0 :type fixnum)
  (calls nil :type (or null fixnum))
  (tick 0 :type fixnum)
  (seconds 0d0 :type double-float)
  (reached nil :type (or null real)))

(defun state-words (state)
  (ecase state
    (:running "running")
    (:paused "paused")
    (:still "not live: ticks pass only when a program requests them")
    (:forked "in a fork: ticks pass only while lines run")
    (:ended "the trial is over: TRIAL OFF leaves the trial")
    (:stopped "stopped: the line RESUME continues")
    (:over "over")
    (:idle "idle: time stands still until there is something to do")
    (:waiting "waiting for a plan")
    (:busy "busy in")
    (:broken "stopped: a program has broken")))

(defun rate-text (rate)
  (cond ((eq rate :free) "as fast as possible")
        (rate (format nil "~A/s" (number-text rate)))))

(defun progress-text (progress)
  (format nil "~@[~A~]~@[ (~A reached)~]  ~A~@[ ~A~]"
          (rate-text (progress-rate progress))
          (rate-text (progress-reached progress))
          (state-words (progress-state progress))
          (progress-more progress)))

;;; Looking.

(defun blocking-code-text (simulation sample)
  "Return a text about the user code that has blocked SIMULATION since the last look, or NIL."
  (multiple-value-bind (text calls) (users-code-in-progress simulation)
    (and (eql calls (shiftf (rate-sample-calls sample) calls))
         (= (simulation-tick simulation) (rate-sample-last-tick sample))
         text)))

(defun chosen-rate (simulation)
  "Return the tick rate set for SIMULATION: ticks per second, :FREE, or NIL if it has no rate."
  (if (live-p simulation)
      (simulation-rate simulation)
      (nth-value 1 (ars-magna.cli:trial-or-fork-pace simulation))))

(defun paused-until-resume-p (simulation)
  "True if SIMULATION is paused, as a live run or as a trial, so that RESUME continues it."
  (if (live-p simulation)
      (paused-p simulation)
      (eq :paused (ars-magna.cli:trial-or-fork-pace simulation))))

(defun time-state (simulation sample)
  "Return a keyword of STATE-WORDS for SIMULATION, and a text to write after these words, or NIL."
  (let ((busy (blocking-code-text simulation sample)))
    (cond ((and (simulation-over simulation)
                (not (eq :ended (ars-magna.cli:trial-or-fork-pace simulation))))
           :over)
          ;; In a trial or fork the prompt lets ticks pass.
          ((not (live-p simulation))
           (or (ars-magna.cli:trial-or-fork-pace simulation)
               (if (headless-p simulation) :still :stopped)))
          ((users-code-in-debugger-p simulation)
           (values :broken (ars-magna.cli:other-debugger-text simulation)))
          (busy (values :busy busy))
          ((paused-p simulation) :paused)
          ((not (idle-p simulation)) :running)
          ((let ((*simulation* simulation)) (plans)) :waiting)
          (t :idle))))

(defconstant +least-measured-ticks+ 10 "The least number of ticks for a measurement of the rate.")

(defun begin-rate-measurement (sample tick seconds)
  (setf (rate-sample-tick sample) tick
        (rate-sample-seconds sample) seconds))

(defun measure-rate (sample tick seconds)
  "Return the ticks per second measured at the present TICK and SECONDS, or NIL if unknown."
  (let ((ticks (- tick (rate-sample-tick sample)))
        (elapsed (- seconds (rate-sample-seconds sample))))
    (when (or (minusp ticks)
              (and (> elapsed 0.9) (or (>= ticks +least-measured-ticks+) (> elapsed 5))))
      ;; Rounded to useful digits.
      (setf (rate-sample-reached sample)
            (unless (minusp ticks)
              (let ((rate (/ ticks elapsed)))
                (if (< rate 20) (/ (round rate 1/10) 10) (round rate)))))
      (begin-rate-measurement sample tick seconds))
    (rate-sample-reached sample)))

(defun measure-progress (simulation sample)
  "Return a PROGRESS object for SIMULATION. Update SAMPLE, which has the results of the last look."
  (multiple-value-bind (state more) (time-state simulation sample)
    (let ((tick (simulation-tick simulation)) (seconds (seconds-now)))
      (setf (rate-sample-last-tick sample) tick)
      (unless (eq state :running)
        (setf (rate-sample-reached sample) nil)
        (begin-rate-measurement sample tick seconds))
      (make-progress :state state :more more
                     :rate (chosen-rate simulation)
                     :reached (and (eq state :running) (measure-rate sample tick seconds))))))

;;; Parameters.

(defun global-parameter-values ()
  "Return a vector of the global values of all parameters, which live runs have."
  (cl:map 'vector (lambda (parameter) (global-value (parameter-symbol parameter)))
          (all-parameters)))

;;;; Snapshots

;;; Three threads meet here. The thread that runs the ticks calls the observer, which makes a
;;; snapshot if one is wanted and otherwise notes that the last one is stale. The thread that paints
;;; is notified of each snapshot, and reports when it has PAINTED. The pacer, in between, requests
;;; the next snapshot when it is due. So the window paints at most 30 times a second, however fast
;;; the ticks pass, and never when nothing happens. Changes between ticks (a robot put
;;; somewhere, a thing moved at the prompt) call no observer, nor does a run that pauses; the pacer
;;; looks for such changes twice a second.

(defconstant +seconds-between-pictures+ 1/30
  "The seconds from requesting a snapshot to requesting the next one.")
(defconstant +least-seconds-after-picture+ 0.003
  "The least number of seconds from painting a picture to requesting the next snapshot.")
(defconstant +seconds-between-checks+ 0.5
  "The interval, in seconds, at which to check for changes between ticks.")

(defstruct (watcher (:constructor make-watcher (robot news &optional (gone #'values)))
                    (:copier nil))
  "Makes snapshots of a run for a window. ROBOT is the name of the robot that is watched. The
function NEWS is called, with no arguments and in any thread, after each new snapshot; NEWS must be
quick. The function GONE is called with the reason when the watched run has been over for a while."
  (robot nil :type symbol)
  (news nil :type function :read-only t)
  (gone nil :type function :read-only t)
  ;; The run was over at the last look.
  (over-before-p nil)
  (simulation nil)
  (observer nil)
  (snapshot nil)
  (wanted-p t)
  (stale-p nil)
  ;; What COUNT-OF-CHANGES was when the snapshot was made.
  (traces 0 :type fixnum)
  (painted (make-semaphore "painted") :read-only t)
  (over (make-semaphore "over") :read-only t)
  (over-p nil)
  (pacer nil)
  ;; Something else than its own end has ended the pacer.
  (unpaced-p nil :type boolean)
  ;; How time goes, and how it was found to go so far.
  (progress (make-progress) :type progress)
  ;; The values of the parameters in force, at the last look or in the last snapshot.
  (parameters (parameter-values) :type vector)
  (sample (make-rate-sample) :type rate-sample)
  ;; What is known of the plans.
  (plans (make-plan-look) :type plan-look :read-only t)
  ;; What GRAPHICS-SCALE* was when that was looked at last.
  (scale graphics-scale*))

(defun count-of-changes (simulation)
  "Return a number that changes whenever a program changes SIMULATION between ticks."
  (let ((journal (simulation-journal simulation)))
    (if journal (journal-length journal) 0)))

(defun publish-snapshot (watcher simulation)
  "Make a snapshot of SIMULATION and report it to the window. No ticks may pass meanwhile."
  (setf (watcher-wanted-p watcher) nil
        (watcher-stale-p watcher) nil
        (watcher-traces watcher) (count-of-changes simulation)
        ;; A headless run has values of its own, bound in the thread that runs it.
        (watcher-parameters watcher) (if (headless-p simulation)
                                         (parameter-values)
                                         (global-parameter-values))
        (watcher-snapshot watcher)
        (let ((old (watcher-snapshot watcher)))
          (take-snapshot (simulation-world simulation)
                         (and old
                              (eq (snapshot-map old) (world-map (simulation-world simulation)))
                              old))))
  (funcall (watcher-news watcher)))

(defun report-painted (watcher)
  "Record that the last snapshot of WATCHER was painted, so that the next may be made."
  (signal-semaphore (watcher-painted watcher)))

(defun make-snapshot-if-wanted (watcher)
  "Make a snapshot between two ticks if WATCHER still wants one. If a program passes the ticks
itself, do nothing, because the next tick makes the snapshot."
  (let ((simulation (watcher-simulation watcher)))
    (when (and simulation (live-p simulation))
      (asking (simulation)
        (when (watcher-wanted-p watcher) (publish-snapshot watcher simulation))))))

;;; The pacer.

(defun make-snapshot-if-changed (watcher)
  (let ((simulation (watcher-simulation watcher)))
    (when (and simulation (/= (watcher-traces watcher) (count-of-changes simulation)))
      (setf (watcher-wanted-p watcher) t)
      (make-snapshot-if-wanted watcher))))

;; A run that is being started again is over for a moment.
(defun check-run-over (watcher)
  "Report that the run of WATCHER is over, when two checks in a row have found it over."
  (let* ((simulation (watcher-simulation watcher))
         (reason (and simulation (simulation-over simulation))))
    (when (and reason (watcher-over-before-p watcher))
      (funcall (watcher-gone watcher) reason))
    (setf (watcher-over-before-p watcher) (and reason t))))

(defun check-progress (watcher)
  "Determine how time passes in the run of WATCHER, and report a change to the window."
  (let ((simulation (watcher-simulation watcher)))
    (when simulation
      ;; The run continues meanwhile, and a look may come when something is half done.
      (let ((new (or (ignore-errors (measure-progress simulation (watcher-sample watcher)))
                     (watcher-progress watcher))))
        (unless (equalp new (watcher-progress watcher))
          (setf (watcher-progress watcher) new)
          (funcall (watcher-news watcher)))))))

(defun check-parameter-changes (watcher)
  "Report to the window of WATCHER if parameters of its live run have changed since the last look."
  (let ((simulation (watcher-simulation watcher)))
    (when (and simulation (not (headless-p simulation)))
      (let ((values (global-parameter-values)))
        (unless (every #'eql values (shiftf (watcher-parameters watcher) values))
          (funcall (watcher-news watcher)))))))

(defun check-graphics-scale (watcher)
  (unless (eql graphics-scale* (shiftf (watcher-scale watcher) graphics-scale*))
    (funcall (watcher-news watcher))))

(defun check-plans (watcher)
  (when (update-look-if-changed (watcher-plans watcher))
    (funcall (watcher-news watcher))))

(defun check-for-changes (watcher)
  "Check the run of WATCHER for changes that no observer reports."
  (check-plans watcher)
  (check-progress watcher)
  (check-parameter-changes watcher)
  (check-graphics-scale watcher)
  (make-snapshot-if-changed watcher)
  (check-run-over watcher))

(defun time-of-next-picture (due now)
  "Return when the picture after that of the time DUE is due, if that was painted at the time NOW."
  (max (+ due +seconds-between-pictures+)
       (+ now +least-seconds-after-picture+)))

(defun request-snapshot (watcher)
  (check-plans watcher)
  (setf (watcher-wanted-p watcher) t)
  (when (watcher-stale-p watcher) (make-snapshot-if-wanted watcher)))

(defun run-pacer (watcher)
  (loop with next = (seconds-now) and due = (seconds-now)
        until (watcher-over-p watcher)
        do (when (wait-on-semaphore (watcher-painted watcher)
                                    (max 0.001 (- next (seconds-now))))
             (setf due (time-of-next-picture due (seconds-now)))
             (wait-on-semaphore (watcher-over watcher) (- due (seconds-now)))
             (request-snapshot watcher))
           (when (<= next (seconds-now))
             (setf next (+ (seconds-now) +seconds-between-checks+))
             (check-for-changes watcher))))

;;; Beginning and ending.

(defun stop-observing (simulation observer)
  (when simulation
    (asking (simulation) (remove-observer observer simulation))))

;; Other threads read the watched run of WATCHER: between two runs there must always be one.
(defun watch-simulation (watcher simulation)
  "Make WATCHER watch SIMULATION from now on instead of its present run. Return WATCHER."
  (let ((old (watcher-simulation watcher)) (observer (watcher-observer watcher))
        (tick (simulation-tick simulation)))
    (unless (eq simulation old)
      (keep-history simulation)
      (setf (watcher-observer watcher) (lambda (simulation)
                                         (if (watcher-wanted-p watcher)
                                             (publish-snapshot watcher simulation)
                                             (setf (watcher-stale-p watcher) t)))
            (watcher-sample watcher) (make-rate-sample :last-tick tick :tick tick
                                                       :seconds (seconds-now))
            (watcher-simulation watcher) simulation)
      (stop-observing old observer)
      (set-look-simulation (watcher-plans watcher) simulation)
      (asking (simulation)
        (add-observer (watcher-observer watcher) simulation)
        (publish-snapshot watcher simulation))))
  watcher)

(defun run-guarded-pacer (watcher)
  "Run the pacer of WATCHER until the window closes. Report an earlier end to the window."
  (unwind-protect (run-pacer watcher)
    (unless (watcher-over-p watcher)
      (setf (watcher-unpaced-p watcher) t)
      (funcall (watcher-news watcher)))))

(defun start-pacer (watcher)
  (setf (watcher-pacer watcher)
        (start-thread (lambda () (run-guarded-pacer watcher))
                      (format nil "pacer of ~A" (watcher-robot watcher)))))

;; As for the thread of a prompt, it is not the one that ends which starts another.
(defun restart-pacer-if-lost (watcher)
  "Start a new pacer thread for WATCHER if the user has ended the old thread."
  (when (shiftf (watcher-unpaced-p watcher) nil) (start-pacer watcher)))

(defun start-watching (watcher simulation)
  (watch-simulation watcher simulation)
  (start-pacer watcher)
  watcher)

(defun stop-watching (watcher)
  (setf (watcher-over-p watcher) t)
  (signal-semaphore (watcher-over watcher))
  (signal-semaphore (watcher-painted watcher))
  (set-look-simulation (watcher-plans watcher) nil)
  (stop-observing (shiftf (watcher-simulation watcher) nil) (watcher-observer watcher))
  (let ((pacer (watcher-pacer watcher)))
    ;; When Lisp exits, the pacer may have ended before.
    (when (and pacer (not (eq pacer (current-thread))))
      (join-thread pacer)))
  (values))
