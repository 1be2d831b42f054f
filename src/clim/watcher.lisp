;;;; watcher.lisp -- the state of time in a run, and snapshots of it, at no cost to its ticks.

(in-package :ars-magna.clim)

(defstruct (progress (:copier nil))
  "The state of time in a run. STATE is a word, MORE a text that continues it or NIL; RATE as set, a
number or :FREE, or NIL; REACHED in ticks a second, or NIL if that is not known."
  (state :still :type symbol :read-only t)
  (more nil :type (or null string) :read-only t)
  (rate nil :read-only t)
  (reached nil :type (or null real) :read-only t))

(defstruct (sample (:copier nil))
  "The last look at a run: its tick and the number of calls of user code then; the tick and second
at which measuring the rate began, and that rate."
  (last-tick 0 :type fixnum)
  (calls nil :type (or null fixnum))
  (tick 0 :type fixnum)
  (seconds 0d0 :type double-float)
  (reached nil :type (or null real)))

(defun state-words (state)
  (ecase state
    (:running "running")
    (:paused "paused")
    (:still "not live: ticks pass when a program asks for them")
    (:forked "in a fork: ticks pass when lines ask for them")
    (:ended "the trial is over: TRIAL OFF leaves it")
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

(defun busy-p (simulation sample)
  "Return in words which users' code has blocked SIMULATION since the last look, or NIL."
  (multiple-value-bind (text calls) (users-code-under-way simulation)
    (and (eql calls (shiftf (sample-calls sample) calls))
         (= (simulation-tick simulation) (sample-last-tick sample))
         text)))

(defun rate-set (simulation)
  "Return at what rate ticks pass in SIMULATION, as set; NIL if there is none."
  (if (live-p simulation)
      (simulation-rate simulation)
      (nth-value 1 (ars-magna.cli:pace-of simulation))))

(defun paused-here-p (simulation)
  "True if time stands still in SIMULATION until RESUME: it is paused, or a paused trial."
  (if (live-p simulation)
      (paused-p simulation)
      (eq :paused (ars-magna.cli:pace-of simulation))))

(defun state-of (simulation sample)
  "Return the state of SIMULATION, and NIL or a text that continues its name."
  (let ((busy (busy-p simulation sample)))
    (cond ((and (simulation-over simulation)
                (not (eq :ended (ars-magna.cli:pace-of simulation))))
           :over)
          ;; In a trial or fork the prompt lets ticks pass.
          ((not (live-p simulation))
           (or (ars-magna.cli:pace-of simulation) (if (headless-p simulation) :still :stopped)))
          ((users-code-broken-p simulation)
           (values :broken (ars-magna.cli:asker-of-break simulation)))
          (busy (values :busy busy))
          ((paused-p simulation) :paused)
          ((not (idle-p simulation)) :running)
          ((let ((*simulation* simulation)) (plans)) :waiting)
          (t :idle))))

(defconstant +measure+ 10 "From how many ticks on the rate is measured.")

(defun begin-measuring (sample tick seconds)
  (setf (sample-tick sample) tick
        (sample-seconds sample) seconds))

(defun measure (sample tick seconds)
  "Return how many ticks a second have passed recently; it is TICK at SECONDS."
  (let ((ticks (- tick (sample-tick sample))) (elapsed (- seconds (sample-seconds sample))))
    (when (or (minusp ticks) (and (> elapsed 0.9) (or (>= ticks +measure+) (> elapsed 5))))
      ;; Rounded to useful digits.
      (setf (sample-reached sample)
            (unless (minusp ticks)
              (let ((rate (/ ticks elapsed)))
                (if (< rate 20) (/ (round rate 1/10) 10) (round rate)))))
      (begin-measuring sample tick seconds))
    (sample-reached sample)))

(defun progress-of (simulation sample)
  "Return the state of time in SIMULATION; SAMPLE has the last look."
  (multiple-value-bind (state more) (state-of simulation sample)
    (let ((tick (simulation-tick simulation)) (seconds (seconds-now)))
      (setf (sample-last-tick sample) tick)
      (unless (eq state :running)
        (setf (sample-reached sample) nil)
        (begin-measuring sample tick seconds))
      (make-progress :state state :more more
                     :rate (rate-set simulation)
                     :reached (and (eq state :running) (measure sample tick seconds))))))

;;;; Snapshots

;;; Three threads meet here. The thread that runs the ticks calls the observer, which makes a
;;; snapshot if one is wanted and otherwise notes that the last one is stale. The thread that paints
;;; is notified of each snapshot, and reports when it has PAINTED. The pacer, in between, requests
;;; the next snapshot a while after that. So the window paints at most 30 times a second, however
;;; fast the ticks pass, and never when nothing happens. Changes between ticks (a robot put
;;; somewhere, a thing moved at the prompt) call no observer, nor does a run that pauses; the pacer
;;; looks for such changes twice a second.

(defconstant +pause+ 0.028
  "How long to wait after painting before wanting the next picture, in seconds.")
(defconstant +patience+ 0.5 "How often to look for changes between ticks, in seconds.")

(defstruct (watcher (:constructor make-watcher (robot news &optional (gone #'values)))
                    (:copier nil))
  "ROBOT is the name of the robot that is watched. NEWS is called, with no arguments and in some
thread, for each new snapshot; it must be quick. GONE is called, with the reason, when the run that
is watched has been over for a while."
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
  ;; What TRACES-OF-CHANGE was when the snapshot was made.
  (traces 0 :type fixnum)
  (painted (make-semaphore "painted") :read-only t)
  (over (make-semaphore "over") :read-only t)
  (over-p nil)
  (pacer nil)
  ;; Something else than its own end has ended the pacer.
  (unpaced-p nil :type boolean)
  ;; How time goes, and how it was found to go so far.
  (progress (make-progress) :type progress)
  (sample (make-sample) :type sample)
  ;; What is known of the plans.
  (plans (make-plan-look) :type plan-look :read-only t)
  ;; What GRAPHICS-SCALE* was when that was looked at last.
  (scale graphics-scale*))

(defun traces-of-change (simulation)
  "Return a number that changes whenever a program changes SIMULATION between ticks."
  (let ((journal (simulation-journal simulation)))
    (if journal (journal-length journal) 0)))

(defun publish (watcher simulation)
  "Make a snapshot of SIMULATION, which stands still, and report it."
  (setf (watcher-wanted-p watcher) nil
        (watcher-stale-p watcher) nil
        (watcher-traces watcher) (traces-of-change simulation)
        (watcher-snapshot watcher)
        (let ((old (watcher-snapshot watcher)))
          (take-snapshot (simulation-world simulation)
                         (and old
                              (eq (snapshot-map old) (world-map (simulation-world simulation)))
                              old))))
  (funcall (watcher-news watcher)))

(defun painted (watcher)
  "Note that the last snapshot of WATCHER was painted; the next may come."
  (signal-semaphore (watcher-painted watcher)))

(defun fetch (watcher)
  "Make a snapshot between ticks if one is still wanted then; not if a program passes the ticks
itself: it will come with the next tick."
  (let ((simulation (watcher-simulation watcher)))
    (when (and simulation (live-p simulation))
      (asking (simulation)
        (when (watcher-wanted-p watcher) (publish watcher simulation))))))

;;; The pacer.

(defun fetch-if-changed (watcher)
  (let ((simulation (watcher-simulation watcher)))
    (when (and simulation (/= (watcher-traces watcher) (traces-of-change simulation)))
      (setf (watcher-wanted-p watcher) t)
      (fetch watcher))))

;; A run that is being started again is over for a moment.
(defun check-run-over (watcher)
  "Report, at the second look, that the run that WATCHER watches is over."
  (let* ((simulation (watcher-simulation watcher))
         (reason (and simulation (simulation-over simulation))))
    (when (and reason (watcher-over-before-p watcher))
      (funcall (watcher-gone watcher) reason))
    (setf (watcher-over-before-p watcher) (and reason t))))

(defun look-at-progress (watcher)
  "Find out the state of time in the run of WATCHER; report it if it has changed."
  (let ((simulation (watcher-simulation watcher)))
    (when simulation
      ;; The run continues meanwhile, and a look may come when something is half done.
      (let ((new (or (ignore-errors (progress-of simulation (watcher-sample watcher)))
                     (watcher-progress watcher))))
        (unless (equalp new (watcher-progress watcher))
          (setf (watcher-progress watcher) new)
          (funcall (watcher-news watcher)))))))

(defun look-at-scale (watcher)
  (unless (eql graphics-scale* (shiftf (watcher-scale watcher) graphics-scale*))
    (funcall (watcher-news watcher))))

(defun look-for-plans (watcher)
  (when (look-at-plans (watcher-plans watcher))
    (funcall (watcher-news watcher))))

(defun look-for-changes (watcher)
  "Look for changes that no observer reports."
  (look-for-plans watcher)
  (look-at-progress watcher)
  (look-at-scale watcher)
  (fetch-if-changed watcher)
  (check-run-over watcher))

(defun run-pacer (watcher)
  (loop with next = (seconds-now)
        until (watcher-over-p watcher)
        do (when (wait-on-semaphore (watcher-painted watcher)
                                    (max 0.001 (- next (seconds-now))))
             (wait-on-semaphore (watcher-over watcher) +pause+)
             (look-for-plans watcher)
             (setf (watcher-wanted-p watcher) t)
             (when (watcher-stale-p watcher) (fetch watcher)))
           (when (<= next (seconds-now))
             (setf next (+ (seconds-now) +patience+))
             (look-for-changes watcher))))

;;; Beginning and ending.

(defun leave-simulation (simulation observer)
  "Remove OBSERVER from SIMULATION, if there is one."
  (when simulation
    (asking (simulation) (remove-observer observer simulation))))

;; Other threads read the watched run of WATCHER: between two runs there must always be one.
(defun watch-simulation (watcher simulation)
  "Make WATCHER watch SIMULATION from now on, instead of its present run. Return WATCHER."
  (let ((old (watcher-simulation watcher)) (observer (watcher-observer watcher))
        (tick (simulation-tick simulation)))
    (unless (eq simulation old)
      (keep-history simulation)
      (setf (watcher-observer watcher) (lambda (simulation)
                                         (if (watcher-wanted-p watcher)
                                             (publish watcher simulation)
                                             (setf (watcher-stale-p watcher) t)))
            (watcher-sample watcher) (make-sample :last-tick tick :tick tick
                                                  :seconds (seconds-now))
            (watcher-simulation watcher) simulation)
      (leave-simulation old observer)
      (direct-look (watcher-plans watcher) simulation)
      (asking (simulation)
        (add-observer (watcher-observer watcher) simulation)
        (publish watcher simulation))))
  watcher)

(defun pace-pictures (watcher)
  "Run the pacer of WATCHER until its work is over; report if something else ends this thread."
  (unwind-protect (run-pacer watcher)
    (unless (watcher-over-p watcher)
      (setf (watcher-unpaced-p watcher) t)
      (funcall (watcher-news watcher)))))

(defun start-pacer (watcher)
  (setf (watcher-pacer watcher)
        (start-thread (lambda () (pace-pictures watcher))
                      (format nil "pacer of ~A" (watcher-robot watcher)))))

;; As for the thread of a prompt, it is not the one that ends which starts another.
(defun restart-pacer-if-lost (watcher)
  "Start another pacer for WATCHER if its own was ended, as the user may do to any thread."
  (when (shiftf (watcher-unpaced-p watcher) nil) (start-pacer watcher)))

(defun start-watching (watcher simulation)
  (watch-simulation watcher simulation)
  (start-pacer watcher)
  watcher)

(defun stop-watching (watcher)
  (setf (watcher-over-p watcher) t)
  (signal-semaphore (watcher-over watcher))
  (signal-semaphore (watcher-painted watcher))
  (direct-look (watcher-plans watcher) nil)
  (leave-simulation (shiftf (watcher-simulation watcher) nil) (watcher-observer watcher))
  (let ((pacer (watcher-pacer watcher)))
    ;; When Lisp exits, the pacer may have ended before.
    (when (and pacer (not (eq pacer (current-thread))))
      (join-thread pacer)))
  (values))
