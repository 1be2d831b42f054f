;;;; simulation.lisp -- a world with robots in it, run live or headless (manual A, 2.3).

(in-package :ars-magna.robot)

;;; Each world has one simulation. That of a map's resident world is made when it is first needed;
;;; SIMULATOR lets it run live. WITH-SIMULATION makes a fresh world, with fresh robots in it, for
;;; its extent. What a layer above does in each tick it adds to *TICK-PHASES*.

(defvar *tick-phases* '()
  "Functions of a simulation that each of its ticks calls after the events, in order.")

(defvar *busy-tests* '()
  "Functions of a simulation: true while it needs ticks although no event is pending.")

(defvar *simulation-variables* '()
  "Symbols that a headless simulation binds, to the values they have, so that what is set in it
ends with it and simulations side by side do not meet.")

(defvar *simulator-hooks* '()
  "Functions of a robot and the plist of SIMULATOR's options, called when it has started.")

(addition simulation-robots)
(defun simulation-robots (&optional (simulation (current-simulation)))
  "Return a list of the robots in SIMULATION."
  (world-robots (simulation-world simulation)))

(defun run-world-kickers (simulation)
  (let ((world (simulation-world simulation)))
    (setf (world-tick world) (simulation-tick simulation))
    (run-kickers world)))

(defun kickers-busy-p (simulation)
  (world-has-kickers-p (simulation-world simulation)))

(defun qualified-name (symbol)
  "Return a string that names SYMBOL with its package, for FIND-ROBOT and kin."
  (format nil "~@[~A::~]~A" (and (symbol-package symbol) (package-name (symbol-package symbol)))
          symbol))

(defun robot-names (simulation)
  (mapcar (lambda (robot) (qualified-name (robot-name robot))) (simulation-robots simulation)))

(defun begin-journal (simulation)
  (make-journal (list :map (qualified-name
                            (map-name (world-map (simulation-world simulation))))
                      :robots (robot-names simulation)
                      :seed (simulation-seed simulation)
                      :parameters (parameter-settings))))

(defun simulation-of (world seed journal)
  "Return a new simulation of WORLD."
  (let ((simulation (make-simulation
                     :name (map-name (world-map world)) :world world :seed seed
                     :phases (cons #'run-world-kickers (copy-list *tick-phases*))
                     :busy-tests (cons #'kickers-busy-p (copy-list *busy-tests*))
                     :messages *message-queue*)))
    (setf (world-simulation world) simulation)
    (when journal (setf (simulation-journal simulation) (begin-journal simulation)))
    simulation))

;;; Resident and fresh.

(defvar *simulations-lock* (make-lock "simulations"))

(defun ensure-simulation (world)
  "Return the simulation of WORLD; that of a resident world is made when it is first needed."
  (or (world-simulation world)
      (with-lock (*simulations-lock*)
        (or (world-simulation world)
            (simulation-of world (world-seed world) t)))))

(defun resident-simulation (map)
  "Return the simulation of the resident world of MAP, or of the map so named."
  (ensure-simulation (map-resident-world (find-map map))))

(addition robot-simulation)
(defun robot-simulation (robot)
  "Return the simulation of the world that ROBOT is in."
  (ensure-simulation (robot-world robot)))

(defun body-of (designator)
  "Return the body of the robot DESIGNATOR, which may be a robot or its name."
  (if (robot-p designator) (robot-body designator) (find-body designator)))

(defun fresh-simulation (robots &key (seed 0) journal)
  "Return a simulation, at tick 0, of a fresh world that holds the things of its map and fresh
ROBOTS, a list of names or robots of one map. With JOURNAL it keeps one."
  (let* ((bodies (mapcar #'body-of robots))
         (maps (remove-duplicates (mapcar #'find-map (mapcar #'body-map bodies)))))
    (unless (= (length maps) 1)
      (reject-use "One simulation has one map, and these robots are defined in ~
                   ~:[none~;~:*~{~A~^, ~}~]."
                  maps))
    (let ((world (make-world (first maps) :seed seed)))
      (dolist (body bodies) (make-robot body world))
      (simulation-of world seed journal))))

(defun call-with-simulation (function robots &key (seed 0) parameters clean journal)
  "Call FUNCTION in a fresh headless simulation; see WITH-SIMULATION."
  (check-argument with-simulation seed (integerp seed) "an integer")
  (call-with-parameters
   parameters
   (lambda ()
     (when clean (clean-simulation))
     (let* ((*message-queue* (make-message-queue))
            (names (variables-among robots))
            (simulation (fresh-simulation (ensure-list robots) :seed seed :journal journal))
            (*simulation* simulation)
            (*world* (simulation-world simulation))
            (robots (simulation-robots simulation)))
       (progv (append names (mapcar #'robot-name robots) *simulation-variables*)
           (append (robots-meant names) robots (mapcar #'symbol-value *simulation-variables*))
         (unwind-protect (funcall function)
           (end-headless simulation)))))))

(defun end-headless (simulation)
  (let ((reason "the headless simulation that it was in has ended"))
    (retire-robots (simulation-robots simulation) reason)
    (end-simulation simulation reason)))

(defun variables-among (names)
  "Return the symbols among NAMES, a list or a single name, that can be variables."
  (remove-if-not (lambda (name) (and (symbolp name) (variable-name-p name)))
                 (ensure-list names)))

(defun unquoted (form)
  "Return FORM without the quote that people put before names elsewhere."
  (if (and (consp form) (eq 'quote (first form))) (second form) form))

(defun robots-meant (names)
  "Return the robots of the current simulation that NAMES, of any package, mean."
  (loop for name in names collect (robot-of-body (find-body name) *world*)))

(defun retire-robots (robots reason)
  (dolist (robot robots) (retire-robot robot reason)))

(addition with-simulation)
(defmacro with-simulation ((robots &key (seed 0) parameters clean journal) &body body)
  "Run BODY with ROBOTS, the name of a robot or a list of names, of any package, bound to fresh
robots in a fresh world, headless: ticks pass only when BODY calls RUN-TICKS or RUN-UNTIL. The
integer SEED decides all chance. Parameters are bound to what they are here, or as the list
PARAMETERS of lists (name value) says; with CLEAN the simulation is clean. With JOURNAL it keeps a
journal. Messages go to a queue of its own. When BODY has ended, the run is over: what the robots
are doing is interrupted, and they take no more commands. Return the values of BODY."
  (let ((robots (unquoted robots)))
    `(call-with-simulation (lambda ()
                             (declare (special ,@(variables-among robots)))
                             ,@body)
                           ',robots
                           :seed ,seed :parameters ,parameters :clean ,clean :journal ,journal)))

;;; Live.

(defun end-simulation (simulation reason)
  "End the run of SIMULATION for good, for REASON: what its robots were doing is interrupted."
  (let ((robots (simulation-robots simulation)))
    (end-run simulation reason
             (loop for robot in robots append (cons robot (robot-parts robot)))
             (lambda () (mapc #'close-robot robots)))))

(defun restart-world (world seed)
  "Make WORLD and its robots what they were at the start."
  (reset-world world :seed seed)
  (mapc #'reset-robot (world-robots world))
  (simulation-of world seed t))

(defun bodies-in (map)
  "Return the bodies of the robots that are defined in MAP."
  (remove map (all-bodies) :test-not #'eq :key (lambda (body) (find-map (body-map body) nil))))

(defun first-robot-in (map)
  "Return the robot of MAP that was defined first. Signals MISUSE if there is none."
  (let ((body (first (bodies-in map))))
    (if body
        (body-robot body)
        (reject-use "Map ~(~A~) has no robot. Define one: (defrobot NAME (~:*~(~A~) (X Y) ANGLE))."
                    (map-name map)))))

(defun robot-to-start (designator)
  "Return the robot to run that DESIGNATOR means: a robot, a map with robots, or the name of either.
One whose map or definition has been replaced means the robot that is called so now."
  (let ((robot (cond ((map-p designator) (first-robot-in designator))
                     ((find-robot designator nil))
                     ((find-map designator nil) (first-robot-in (find-map designator)))
                     (t (reject-name "robot or map" designator
                                     (append (mapcar #'body-name (all-bodies))
                                             (mapcar #'map-name (all-maps))))))))
    (if (robot-retired robot)
        (find-again (robot-name robot))
        robot)))

(defun set-robot (body robot)
  "Let the variable of BODY's name hold ROBOT at top level."
  (setf (sb-ext:symbol-global-value (body-name body)) robot))

(defun find-again (name)
  "Return the robot called NAME now, made anew if that has not been possible before."
  (let* ((body (find-body name))
         (robot (body-robot body)))
    (if (or (null robot) (robot-retired robot))
        (set-robot body (settle body))
        robot)))

(public simulator)
(defun simulator (robot &rest options &key (rate *default-rate*) (seed nil) &allow-other-keys)
  "Run the world of ROBOT live, in a thread of its own, at RATE ticks per second or :FREE, and make
it the current simulation. ROBOT is a robot or a map with a robot in it, or the name of either. A
world that has run before starts anew, with SEED if that is given. Return the robot (manual A).
STOP-SIMULATOR stops it. Signals UNKNOWN-NAME, and MISUSE if the robot no longer fits into its map."
  (let* ((robot (robot-to-start robot))
         (world (robot-world robot))
         (simulation (ensure-simulation world)))
    (stop-clock simulation)
    (when (or seed (plusp (simulation-tick simulation)) (simulation-over simulation))
      (end-simulation simulation "it has been started anew")
      (setf simulation (restart-world world (or seed (simulation-seed simulation)))))
    (setf *simulation* simulation
          *world* world)
    (start-clock simulation :rate rate)
    (dolist (hook *simulator-hooks*) (funcall hook robot options))
    robot))

(defun headless-p (simulation)
  "True if SIMULATION is one of WITH-SIMULATION: not of the world that top-level code works in."
  (let ((world (simulation-world simulation)))
    (not (eq world (map-resident (world-map world))))))

(addition stop-simulator)
(defun stop-simulator (&optional (simulation (current-simulation)))
  "Stop the live SIMULATION after its current tick. What is under way stays pending. Return
nothing."
  (stop-clock simulation)
  (values))

(addition set-seed)
(defun set-seed (seed &optional (simulation (current-simulation)))
  "Make all chance in SIMULATION depend on the integer SEED from now on. Return SEED."
  (check-argument set-seed seed (integerp seed) "an integer")
  (change-from-outside simulation
                       (lambda () (seed-world (simulation-world simulation) seed))
                       (list :seed seed))
  seed)

(defmethod apply-entry ((operation (eql :seed)) arguments simulation)
  (set-seed (first arguments) simulation))
