;;;; residents.lisp -- the runs and robots that names mean at top level, also after maps change.

(in-package :ars-magna.run)

;;; Rules for threads that start, stop and replace simulators.
;;; - Only the thread that owns a world changes which run the world has, whether that is over, which
;;;   thread passes its ticks, whether the world is resident in its map, and which robot there has
;;;   which name. Another thread may only tell the one that passes ticks to stop.
;;; - Worlds and runs that follow one another in a map share one custody.
;;; - A thread that has taken custody checks again. It starts or settles nothing in a run that is
;;;   over, in a world that is no longer resident, or for a retired robot; it looks up the new ones.

(defun blueprints-in (map)
  (remove map (all-blueprints)
          :test-not #'eq
          :key (lambda (blueprint) (find-map (blueprint-map blueprint) nil))))

(defun first-robot-in (map)
  "Return the robot of MAP that was defined first. Signals MISUSE if MAP has no robot."
  (let ((blueprint (first (blueprints-in map))))
    (if blueprint
        (blueprint-robot blueprint)
        (reject-use "Map ~(~A~) has no robot. Define one: (defrobot NAME (~:*~(~A~) (X Y) ANGLE))."
                    (map-name map)))))

(defun reject-robot-list (designators)
  "Signal UNKNOWN-NAME: the list DESIGNATORS was given instead of one robot."
  (error 'unknown-name
         :kind "robot or map" :name designators
         :remedy (format nil "Give one robot~@[, as '~(~A~)~]: all robots of its map are in its ~
                              world."
                         (and (symbolp (first designators)) (first designators)))))

(defun robot-to-start (designator)
  "Return the robot that DESIGNATOR means: a robot, a map with robots, or the name of a robot or
map. If the map or definition of a robot has been replaced, return the current robot of this name."
  (let ((robot (cond ((map-p designator) (first-robot-in designator))
                     ((find-robot designator nil))
                     ((find-map designator nil) (first-robot-in (find-map designator)))
                     ((consp designator) (reject-robot-list designator))
                     (t (reject-name "robot or map" designator
                                     (append (mapcar #'blueprint-name (all-blueprints))
                                             (mapcar #'map-name (all-maps))))))))
    (if (robot-retired robot)
        (find-current-robot (robot-name robot))
        robot)))

(defun bind-robot-name (robot)
  (setf (global-value (robot-name robot)) robot))

(defun ensure-named-robot (blueprint)
  "Return the resident robot of BLUEPRINT, made if needed. Set the robot's variable to this robot."
  (loop
    (let ((robot (ensure-resident-robot blueprint)))
      ;; Another thread that has replaced its world meanwhile has retired it.
      (asking (robot)
        (unless (robot-retired robot) (bind-robot-name robot)))
      (unless (robot-retired robot) (return robot)))))

(defun find-current-robot (name)
  "Return the current robot NAME. Make the robot if it could not be made before."
  (let* ((blueprint (find-blueprint name))
         (robot (blueprint-robot blueprint)))
    (if (or (null robot) (robot-retired robot))
        (ensure-named-robot blueprint)
        robot)))

;;; When a map is defined anew.

;;; The run of the old map's world ends. The robots defined in the map are made again in the new
;;; map, if they fit. Headless runs have their own worlds and continue.

(defun warn-of-ended-run (map simulation new)
  (when (or (live-p simulation)
            (and (plusp (simulation-tick simulation)) (not (idle-p simulation))))
    (warn-of-definition "Map ~(~A~) is ~:[no longer defined~;defined anew~]. Its simulation has ~
                         ended at tick ~D~@[; runs started from now on use the new map ~(~A~)~]."
                        (map-name map) new (simulation-tick simulation)
                        (and new (map-name new)))))

(defun retire-named-robot (name reason)
  "Retire the robot NAME, which does not fit into the new map, for REASON."
  (unless (defined-in-this-file-p name *robots*)
    (warn-of-definition "The robot ~(~A~) takes no more commands: ~A." name reason))
  ;; A headless run may have bound the variable to another robot here.
  (let ((robot (ignore-errors (global-value name))))
    (when (robot-p robot) (retire-robot robot reason))))

(defun remake-robots (map)
  "Make the robots that are defined in MAP, a new map, and retire those that do not fit into it."
  (dolist (blueprint (blueprints-in map))
    (let ((trouble (start-problem-text map (blueprint-x blueprint) (blueprint-y blueprint))))
      (if trouble
          (retire-named-robot
           (blueprint-name blueprint)
           (format nil "it does not fit into the new map ~(~A~), because ~A; define the robot anew"
                   (map-name map) trouble))
          (ensure-named-robot blueprint)))))

(defun end-world-run (world reason)
  "End the run of WORLD and retire its robots, for REASON. WORLD cannot be started again. Return
false if another world has become resident in its map."
  (call-without-clock (ensure-timeline world)
              (lambda ()
                (when (eq world (map-resident (world-map world)))
                  (retire-robots (world-robots world) reason)
                  (end-simulation (world-simulation world) reason)
                  t))))

(defun end-resident-world (map reason)
  "End the resident world of MAP for REASON. Another map has replaced MAP."
  ;; Another thread may rewind its run meanwhile, which makes another world resident.
  (loop until (end-world-run (map-resident map) reason)))

;; A time limit must not leave the old world live: no name would lead to it.
(defun end-resident-world-safely (map reason)
  "Call END-RESIDENT-WORLD at once or, if this thread is interrupted, between two ticks."
  (let ((done-p nil))
    (deferring-interrupts
      (unwind-protect (allowing-interrupts
                        (end-resident-world map reason)
                        (setf done-p t))
        (unless done-p
          (ask-later (ensure-timeline (map-resident map))
                     (lambda () (end-resident-world map reason))))))))

(defmethod map-replaced ((old map) new)
  (let* ((world (map-resident old))
         ;; Make the run if there is none: another thread may be making it at this moment.
         (simulation (and world (world-simulation world)))
         (reason (if new "its map has been defined anew" "its map has been taken back")))
    (in-any-case
      (when world (warn-of-ended-run old simulation new))
      (when world (end-resident-world-safely old reason))
      (when new (remake-robots new)))))

(defmethod map-replaced ((old null) (new map))
  ;; There may be robots of a map that was undefined.
  (remake-robots new))

(defmethod value-to-restore ((simulation simulation))
  (latest-successor simulation))

(defun run-so-far (world)
  "Return the run of WORLD; NIL if it has none yet."
  (and (world-timeline world) (timeline-run (world-timeline world))))

(defmethod value-to-restore ((world world))
  (let ((simulation (run-so-far world)))
    (if simulation (simulation-world (latest-successor simulation)) world)))

(defmethod redo-definition ((map map))
  ;; Its run may have been rewound meanwhile.
  (when (map-resident map)
    (setf (map-resident map) (value-to-restore (map-resident map))))
  (let* ((world (map-resident map))
         (simulation (and world (run-so-far world))))
    (when world
      (dolist (robot (world-robots world)) (setf (robot-retired robot) nil)))
    (when (and simulation (simulation-over simulation))
      (restart-world world (simulation-seed simulation))))
  map)

(setf *variables-to-restore* (union *variables-to-restore* '(*simulation* *world*)))
