;;;; residents.lisp -- the runs and robots that names mean at top level, also when maps change.

(in-package :ars-magna.run)

;;; One rule for threads that start, stop and replace simulators.
;;; - Only the thread that has a world in custody changes which run the world has, whether that is
;;;   over, which thread passes its ticks, whether the world is resident in its map, and which robot
;;;   there a name means. Another thread may only tell the one that passes ticks to stop.
;;; - Worlds and runs that follow one another in a map share one custody.
;;; - A thread that has got custody looks again. It starts and settles nothing in a run that is
;;;   over, in a world that is no longer resident, or for a retired robot; it looks up what is there
;;;   now.

(defun blueprints-in (map)
  (remove map (all-blueprints)
          :test-not #'eq
          :key (lambda (blueprint) (find-map (blueprint-map blueprint) nil))))

(defun first-robot-in (map)
  "Return the robot of MAP that was defined first. Signals MISUSE if there is none."
  (let ((blueprint (first (blueprints-in map))))
    (if blueprint
        (blueprint-robot blueprint)
        (reject-use "Map ~(~A~) has no robot. Define one: (defrobot NAME (~:*~(~A~) (X Y) ANGLE))."
                    (map-name map)))))

(defun reject-robots (designators)
  "Signal UNKNOWN-NAME: a list of DESIGNATORS is to be run."
  (error 'unknown-name
         :kind "robot or map" :name designators
         :remedy (format nil "Give one robot~@[, as '~(~A~)~]: all robots of its map are in its ~
                              world."
                         (and (symbolp (first designators)) (first designators)))))

(defun robot-to-start (designator)
  "Return the robot to run that DESIGNATOR means: a robot, a map with robots, or the name of either.
One whose map or definition has been replaced means the robot that is called so now."
  (let ((robot (cond ((map-p designator) (first-robot-in designator))
                     ((find-robot designator nil))
                     ((find-map designator nil) (first-robot-in (find-map designator)))
                     ((consp designator) (reject-robots designator))
                     (t (reject-name "robot or map" designator
                                     (append (mapcar #'blueprint-name (all-blueprints))
                                             (mapcar #'map-name (all-maps))))))))
    (if (robot-retired robot)
        (find-again (robot-name robot))
        robot)))

(defun set-robot (blueprint robot)
  "Let the variable of BLUEPRINT's name hold ROBOT at top level."
  (setf (global-value (blueprint-name blueprint)) robot))

(defun settle-by-name (blueprint)
  "Return the robot that SETTLE-ROBOT returns for BLUEPRINT, after letting its name mean it."
  (loop
    (let ((robot (settle-robot blueprint)))
      ;; A thread that has replaced its world meanwhile has retired it.
      (asking (robot)
        (unless (robot-retired robot) (set-robot blueprint robot)))
      (unless (robot-retired robot) (return robot)))))

(defun find-again (name)
  "Return the robot called NAME now, made anew if that has not been possible before."
  (let* ((blueprint (find-blueprint name))
         (robot (blueprint-robot blueprint)))
    (if (or (null robot) (robot-retired robot))
        (settle-by-name blueprint)
        robot)))

;;; When a map is defined anew.

;;; The run of the old map's world ends. The robots that are defined in the map are made anew in the
;;; new one, as far as they fit. Headless runs under way have worlds of their own and go on.

(defun say-stopped (map simulation new)
  "Say that SIMULATION of MAP has ended, if it was under way: the map is NEW now, or NIL."
  (when (or (live-p simulation)
            (and (plusp (simulation-tick simulation)) (not (idle-p simulation))))
    (warn-of-definition "Map ~(~A~) is ~:[no longer defined~;defined anew~]. Its simulation has ~
                         ended at tick ~D~@[; what is started from now on is in the new ~(~A~)~]."
                        (map-name map) new (simulation-tick simulation)
                        (and new (map-name new)))))

(defun leave-out (name reason)
  "Let the robot called NAME have no place in its new map, for REASON."
  (unless (from-this-file-p name *robots*)
    (warn-of-definition "The robot ~(~A~) takes no more commands: ~A." name reason))
  ;; Not the one that a headless run may have bound the variable to here.
  (let ((robot (ignore-errors (global-value name))))
    (when (robot-p robot) (retire-robot robot reason))))

(defun move-robots (map)
  "Put robots made by the blueprints that are defined in MAP, which is new, into it."
  (dolist (blueprint (blueprints-in map))
    (let ((trouble (start-trouble map (blueprint-x blueprint) (blueprint-y blueprint))))
      (if trouble
          (leave-out (blueprint-name blueprint)
                     (format nil "it does not fit into the new map ~(~A~), as ~A; define it anew"
                             (map-name map) trouble))
          (settle-by-name blueprint)))))

(defun end-world (world reason)
  "End whatever run WORLD has, and let its robots take no more commands, for REASON. Nobody can
start it meanwhile, nor afterwards. True unless another world is resident in its map by now."
  (call-alone (ensure-timeline world)
              (lambda ()
                (when (eq world (map-resident (world-map world)))
                  (retire-robots (world-robots world) reason)
                  (end-simulation (world-simulation world) reason)
                  t))))

(defun end-resident (map reason)
  "End the resident world of MAP, which another map has replaced, for REASON."
  ;; A thread may rewind its run meanwhile, which makes another world resident.
  (loop until (end-world (map-resident map) reason)))

;; If a time limit comes meanwhile, the old world must not be left live: nobody could find it.
(defun end-in-any-case (map reason)
  "Do what END-RESIDENT does, at once or, if this thread is interrupted, when the world stands
still."
  (let ((done-p nil))
    (deferring-interrupts
      (unwind-protect (allowing-interrupts
                        (end-resident map reason)
                        (setf done-p t))
        (unless done-p
          (have-done (ensure-timeline (map-resident map))
                     (lambda () (end-resident map reason))))))))

(defmethod map-replaced ((old map) new)
  (let* ((world (map-resident old))
         ;; Also where there was none: somebody may be asking for it at this moment.
         (simulation (and world (world-simulation world)))
         (reason (if new "its map has been defined anew" "its map has been taken back")))
    (in-any-case
      (when world (say-stopped old simulation new))
      (when world (end-in-any-case old reason))
      (when new (move-robots new)))))

(defmethod map-replaced ((old null) (new map))
  ;; Robots may have been left over by a map that was undefined.
  (move-robots new))

(defmethod reinstate ((map map))
  (let* ((world (map-resident map))
         (simulation (and world (world-simulation world))))
    (when world
      (dolist (robot (world-robots world)) (setf (robot-retired robot) nil)))
    (when (and simulation (simulation-over simulation))
      (restart-world world (simulation-seed simulation))))
  map)

(setf *kept-variables* (union *kept-variables* '(*simulation* *world*)))
