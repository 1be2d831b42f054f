;;;; live.lisp -- SIMULATOR: runs whose ticks pass in real time (manual 2.3, A).

(in-package :ars-magna.run)

(export '(start-clock stop-clock call-with-thread-bindings *simulator-hooks*
          *simulator-hook-options*))

(define-event *simulator-hooks*
  "Functions called when SIMULATOR has started a run, with the robot and the plist of the options.")

(defvar *simulator-hook-options* '()
  "The names of the options of SIMULATOR that its hooks use, as symbols but not keywords.")

(defun call-with-thread-bindings (simulation function)
  "Call FUNCTION with the bindings of the thread of SIMULATION. They include the bindings of robots'
names in effect where SIMULATION was started, for example by a WITH-SIMULATION around SIMULATOR."
  (let ((*simulation* simulation)
        (*world* (simulation-world simulation))
        (*message-queue* (simulation-messages simulation))
        (*standard-output* (or (simulation-output simulation) *standard-output*))
        (*standard-input* (program-input *front-end* *standard-input*))
        (variables (set-difference (simulation-variables simulation)
                                   (cons *random-state-variable* *simulation-variables*))))
    (progv variables (robots-named variables)
      (call-with-parameters
       '() (lambda () (with-random-state ((seeded-random-state (simulation-seed simulation)))
                        (funcall function)))))))

(defun start-clock (simulation &key (rate *default-rate*) (real t) paused-p)
  "Run SIMULATION live, in a new thread, at RATE; if PAUSED-P is true, ticks pass only after RESUME.
Plans also get a thread if REAL is true and thinking is not charged. Return SIMULATION. Signals
MISUSE if SIMULATION is already live, and WRONG-ARGUMENT unless RATE is a positive number or :FREE."
  (check-parameters)
  (let ((output (editor-output-stream))
        ;; Users' code there, and its debugger, read and print as in this thread.
        (caller (function-with-specials
                 (lambda (function)
                   (in-any-case
                     (call-with-thread-bindings simulation function)
                     (mapc #'participant-clock-stopped (simulation-participants simulation))))
                 '*package*)))
    (asking (simulation)
      (check-not-over simulation 'start-clock)
      (setf (simulation-output simulation) output
            *echo-output* output
            (simulation-plans-dice-p simulation) t)
      (choose-plan-threads (simulation-timeline simulation) real)
      (start-pacing (simulation-timeline simulation)
                    (lambda () (tick simulation))
                    (lambda () (idle-p simulation))
                    rate caller :paused-p paused-p)))
  simulation)

(defun stop-clock (simulation)
  "End the thread of the live SIMULATION after its current tick and wait until it has ended.
Commands in progress stay pending; START-CLOCK continues them. If SIMULATION was rewound, stop its
successor. Return SIMULATION."
  (let ((timeline (simulation-timeline simulation)))
    (stop-pacing timeline)
    ;; A thread that rewinds it checks this last, after it has linked the successor.
    (unclaim-pacing timeline)
    (let ((latest (latest-successor simulation)))
      (unless (eq simulation latest)
        (call-without-clock (simulation-timeline latest) (constantly nil)))))
  simulation)

;;; Starting and stopping.

(defun restart-world (world seed)
  "Reset WORLD and its robots with a new timeline. This thread owns WORLD. Return the new run."
  (let ((custody (timeline-custody (world-timeline world)))
        (variables (simulation-variables (world-simulation world))))
    (deferring-interrupts
      (permitting-changes (world)
        (reset-world world :seed seed)
        (arrange-robots world))
      (setf (world-timeline world) (make-timeline (map-name (world-map world)) custody)
            (simulation-variables (world-simulation world)) variables)))
  (world-simulation world))

(defun startable-p (simulation journal)
  "True if SIMULATION has not begun, is not over, was never live, and keeps a journal if JOURNAL is
true."
  (and (zerop (simulation-tick simulation))
       (not (simulation-over simulation))
       (null (pace simulation))
       (or (not journal) (simulation-journal simulation))))

(defun warn-of-namesakes (name other world)
  "If the robots NAME and OTHER, which start in one cell of WORLD, have the same name in different
packages, warn once and return true."
  (when (same-name-p name other)
    (warn-once (list :namesakes name) world
               (format nil "~A and ~A start in one cell, where they do not block each other. If ~
                            you need only one of them, remove the other: (undefine 'robot ~
                            '~(~A~))."
                       (qualified-name name) (qualified-name other)
                       (qualified-name name)))
    t))

;; A map, such as a shipped one, may have robots of several users who do not know of each other.
(defun check-world-robots-apart (world started-p)
  "Signal MISUSE if two robots of WORLD are in one cell or, if STARTED-P is false, start in one. For
robots of one name in different packages, only warn."
  (check-robots-apart 'simulator
                      (loop for robot in (world-robots world)
                            collect (cons (robot-name robot)
                                          (if started-p
                                              (list (robot-x robot) (robot-y robot))
                                              (robot-start-pose robot))))
                      (world-map world)
                      (lambda (name other) (warn-of-namesakes name other world))))

(defun simulation-to-start (world seed journal ghosts)
  "Return the simulation of WORLD that is to run live: a new one if the last is over, was live, has
passed ticks, or keeps no journal although JOURNAL is true. SEED, if given, seeds the dice. If
GHOSTS is true, robots have no bodies."
  (let* ((simulation (world-simulation world)) (kept (simulation-journal simulation))
         (startable-p (startable-p simulation journal)))
    (unless ghosts (check-world-robots-apart world startable-p))
    (setf (world-ghosts-p world) (and ghosts t))
    (when startable-p (permitting-changes (world) (arrange-robots world)))
    (cond ((not startable-p)
           (end-simulation simulation "it has been started anew")
           (restart-world world (or seed (simulation-seed simulation))))
          (t (when seed
               (seed-world world seed)
               (when kept (setf (getf (journal-header kept) :seed) seed)))
             simulation))))

(defun call-while-starting (world function)
  "Own WORLD, stop its clock, and call FUNCTION, which starts the clock again. Signals MISUSE in a
nested call, when this thread is already starting WORLD."
  (let* ((timeline (ensure-timeline world)) (custody (timeline-custody timeline)))
    (flet ((start ()
             (when (eq (current-thread) (custody-starter custody))
               (reject-use "simulator: this thread is already starting the same world."))
             (in-any-case
               (progn (setf (custody-starter custody) (current-thread))
                      (stop-pacing timeline)
                      (funcall function))
               ;; Another thread may have stopped it meanwhile and be starting it again.
               (swap-if-eq (custody-starter custody) (current-thread) nil))))
      (call-without-clock timeline #'start))))

(defun make-current-simulation (simulation everywhere)
  "Make SIMULATION the current simulation of this thread, and of all threads if EVERYWHERE is true."
  (setf *simulation* simulation
        *world* (simulation-world simulation))
  (when everywhere
    (setf (global-value '*simulation*) simulation
          (global-value '*world*) (simulation-world simulation))))

(defun start-world (world rate seed journal keep thinking ghosts everywhere)
  "Run WORLD live, with the options of SIMULATOR, and make its run the current simulation, see
MAKE-CURRENT-SIMULATION. This thread owns WORLD. Return the run."
  (let ((simulation (simulation-to-start world seed journal ghosts)))
    (set-initial-thinking simulation thinking)
    (if journal
        (update-journal-definitions simulation)
        (setf (simulation-journal simulation) nil))
    (setf (simulation-messages simulation) (resident-message-queue))
    (remove-errors-of-runs (resident-message-queue)
                           (lambda (run) (and run (simulation-over (latest-successor run)))))
    (make-current-simulation simulation everywhere)
    (initialize-run-variables simulation)
    (keep-forks keep simulation)
    (start-clock simulation :rate rate :real (eq thinking :real))))

;; The owner may be busy and is not asked: when the clock is stopped, the check is made again.
(defun check-startable (world journal)
  "Signal MISUSE if robots of WORLD are in one another's way, before the clock of WORLD is stopped."
  (check-world-robots-apart world (startable-p (world-simulation world) journal)))

(defun start-world-of-robot (robot rate seed journal keep thinking ghosts)
  "Run the world of ROBOT live, see START-WORLD. Return false if another thread has replaced ROBOT."
  (let ((world (robot-world robot))
        ;; This thread may be that of the current simulation, even if asked to stop.
        (everywhere (and *simulation* (pacing-thread-p (simulation-timeline *simulation*)))))
    (unless ghosts (check-startable world journal))
    (call-while-starting world (lambda ()
                           ;; Its map may have been replaced while it was made.
                           (when (and (eq world (map-resident (world-map world)))
                                      (not (current-resident-world-p world)))
                             (retire-robot robot "its map has been defined anew"))
                           (unless (robot-retired robot)
                             (start-world world rate seed journal keep thinking ghosts
                                          everywhere))))))

(defun check-not-fork (robot)
  (when (timeline-fork-p (ensure-timeline (robot-world robot)))
    (reject-use "simulator: ~A is in a fork, which has no clock: use RUN-TICKS there." robot)))

(defun check-options-of-simulator (options)
  "Signal MISUSE if the plist OPTIONS has an option that neither SIMULATOR nor its hooks know."
  (unless (getf options :allow-other-keys)
    (let ((strange (wrong-keyword-text `(&key rate seed journal keep thinking ghosts
                                           ,@*simulator-hook-options*)
                                    options)))
      (when strange (reject-use "simulator: ~A" strange)))))

(public simulator)
(defun simulator (robot &rest options
                  &key (rate *default-rate*) (seed nil) (journal t) (keep *forks-to-keep*)
                    (thinking :real) ghosts
                  &allow-other-keys)
  "Run the world of ROBOT live, in a separate thread, at RATE ticks per second or :FREE, and make
the run the current simulation. ROBOT is a robot, a map with a robot, or the name of a robot or map.
A world that has run before starts anew, with SEED if SEED is given. The run keeps a journal unless
JOURNAL is NIL; use NIL for busy programs at the rate :FREE. If KEEP is true, the run keeps forks,
so that it can be rewound, see KEEP-FORKS. THINKING says how much time thinking costs, see
SET-THINKING: with :REAL, plans have a separate thread; otherwise plans react within the ticks. If
GHOSTS is true, robots neither block nor see each other in this run. Return the robot (manual A).
STOP-SIMULATOR stops the run. Signals UNKNOWN-NAME, WRONG-ARGUMENT, and MISUSE if the robot no
longer fits into its map, or if two robots start in one cell. See reading 238."
  (check-options-of-simulator options)
  (check-rate rate)
  (check-argument simulator seed (typep seed '(or null integer)) "an integer, or NIL")
  (check-argument-type 'simulator 'keep keep 'fork-count)
  (check-thinking-mode 'simulator thinking)
  (let ((robot (loop for candidate = (robot-to-start robot)
                     do (check-not-fork candidate)
                     when (start-world-of-robot candidate rate seed journal keep thinking
                                                   ghosts)
                       return candidate)))
    (call-listeners *simulator-hooks* robot options)
    (set-variables-globally (robot-simulation robot))
    robot))

;; Lisp itself only says that the number of keyword arguments is odd.
(define-compiler-macro simulator (&whole form &rest arguments)
  (when (and arguments (evenp (length arguments)) (not (keywordp (second arguments))))
    (warn-of-style "simulator takes one robot and keyword arguments; its world contains all ~
                    robots of the robot's map."))
  form)

(addition stop-simulator)
(defun stop-simulator (&optional (simulation (current-simulation)))
  "Stop the live SIMULATION (or that of a robot) after its current tick. Commands in progress stay
pending. If SIMULATION was rewound, stop its successor. Return nothing. See reading 89."
  (let ((simulation (resolve-simulation simulation 'stop-simulator)))
    (stop-clock simulation)
    ;; Another thread may have started it again.
    (asking (simulation)
      (when (plusp (simulation-tick simulation))
        (let ((*message-queue* (simulation-messages simulation)))
          (warn-of-idle-kickers (simulation-world simulation))))))
  (values))
