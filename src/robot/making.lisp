;;;; making.lisp -- robots are made from their blueprints, reset, and retired (manual 5.2).

(in-package :ars-magna.robot)

(export '(blueprint-robot make-robot start-problem-text check-not-retired retire-robot
          call-run-enders ensure-resident-robot current-resident-world-p))

;;; DEFROBOT puts a robot made by its blueprint into its map's resident world and binds the robot's
;;; name; a fresh simulation makes another by the same blueprint.

(defun blueprint-robot (blueprint)
  "Return BLUEPRINT's current robot: its variable's value, or its robot in the resident world."
  (let* ((name (blueprint-name blueprint)) (value (and (boundp name) (symbol-value name)))
         (map (find-map (blueprint-map blueprint) nil)))
    (cond ((robot-p value) value)
          ((and map (map-resident map))
           (find name (world-robots (map-resident map)) :key #'robot-name :test #'eq)))))

(addition all-robots)
(defun all-robots ()
  "Return a list of all robots, the values of their variables, in order of definition."
  (remove nil (mapcar #'blueprint-robot (all-blueprints))))

(addition find-robot)
(defun find-robot (name &optional (errorp t))
  "Return the robot named NAME, a symbol or string: the value of the variable of this name. If NAME
is a robot, return it. If there is no robot, signal UNKNOWN-NAME, or return NIL if ERRORP is NIL."
  (if (robot-p name)
      name
      (let ((blueprint (find-blueprint name errorp)))
        (and blueprint (blueprint-robot blueprint)))))

;;; Making robots.

(defun make-parts (robot specifications)
  "Return a list of parts of ROBOT, made from SPECIFICATIONS, lists (kind initarg value ...)."
  (loop with counts = '()
        for (kind . initargs) in specifications
        collect (apply (kind-constructor kind)
                       :robot robot :index (1- (incf (getf counts kind 0)))
                       initargs)))

(defun kind-constructor (kind)
  (let ((name (find-symbol (concatenate 'string "MAKE-" (symbol-name kind))
                           (symbol-package kind))))
    (if (and name (fboundp name))
        name
        (reject-use "No ~(~A~) can be made: there is no function make-~(~:*~A~)." kind))))

(defun start-problem-text (map x y)
  "Return a text that says why a robot cannot start at (X,Y) in MAP, or NIL if a robot can."
  (cond ((not (map-index map x y))
         (format nil "~A is outside the map, which is ~D by ~D metres"
                 (point-text x y) (map-width map) (map-height map)))
        ((wall-at-p map x y) (format nil "~A is inside a wall" (point-text x y)))))

(defun check-start (blueprint map)
  (let ((trouble (start-problem-text map (blueprint-x blueprint) (blueprint-y blueprint))))
    (when trouble
      (reject-use "~(~A~) no longer fits into ~(~A~): ~A. Define the robot again."
                  (blueprint-name blueprint) (map-name map) trouble))))

(defun make-robot (blueprint world)
  "Make a robot from BLUEPRINT in WORLD and return it. Signals MISUSE if its start is in a wall or
outside the map (reading 215)."
  (check-start blueprint (world-map world))
  (let ((robot (%make-robot :name (blueprint-name blueprint) :blueprint blueprint :world world)))
    (ensure-timeline world)
    (setf (robot-mind robot) (make-mind :robot robot)
          (robot-parts robot) (make-parts robot (blueprint-parts blueprint)))
    (put-at-start robot)
    (setf (world-robots world) (append (world-robots world) (list robot)))
    robot))

(defun put-at-start (robot)
  (let ((blueprint (robot-blueprint robot)))
    (set-robot-pose robot (blueprint-x blueprint) (blueprint-y blueprint)
                    (blueprint-angle blueprint))
    (add-odometer robot 'main)))

;; A reset world has a new floor, without bodies; see ARRANGE-ROBOTS.
(defmethod reset :before ((robot robot))
  (let ((body (shiftf (robot-body robot) nil)))
    (when body (setf (thing-alive-p body) nil (thing-location body) nil)))
  (mapc #'release-number (live-designators robot)))

(defmethod reset :after ((robot robot))
  (put-at-start robot))

;;; A robot is retired when its definition, its map or its run is replaced. Its commands are
;;; interrupted; commands to it signal an error that says why.

(defun retire-robot (robot reason)
  "Make ROBOT refuse commands from now on. REASON is a sentence without its full stop."
  (setf (robot-retired robot) reason))

(defun call-run-enders (robot)
  "Call the functions that were registered for the end of the run of ROBOT."
  (call-each #'funcall (shiftf (robot-enders robot) '())))

(defun check-not-retired (resource operator)
  "Signal MISUSE if the robot of RESOURCE, a robot or part, is retired."
  (let* ((robot (if (robot-p resource) resource (part-robot resource)))
         (newest (and (robot-retired robot) (find-robot (robot-name robot) nil))))
    (when (robot-retired robot)
      (reject-finished-run "~(~A~): the run of this ~(~A~) is over: ~A.~@[ Command the robot that ~
                            the variable ~(~A~) holds now.~]"
                           operator (robot-name robot) (robot-retired robot)
                           (and newest (null (robot-retired newest)) (robot-name robot))))))

(defun remove-robot (robot reason)
  (let ((world (robot-world robot)))
    (deferring-interrupts
      (in-any-case
        (retire-robot robot reason)
        (call-run-enders robot)
        (interrupt-resources (timeline-of robot) (robot-resources robot))
        (take-body robot)
        (setf (world-robots world) (remove robot (world-robots world)))
        (arrange-robots world)))))

(defun remove-robots-named (name reason)
  (dolist (world (remove nil (mapcar #'map-resident (all-maps))))
    (dolist (robot (remove name (world-robots world) :key #'robot-name :test-not #'eq))
      (asking ((ensure-timeline world)) (remove-robot robot reason)))))

(defun find-robot-from-blueprint (blueprint world)
  (find-if (lambda (robot)
             (and (eq blueprint (robot-blueprint robot)) (null (robot-retired robot))))
           (world-robots world)))

(defun ensure-robot-in (world blueprint)
  "Return the robot in WORLD that was made from BLUEPRINT, or make it. Remove other robots of the
same name. The calling thread must own WORLD."
  (or (find-robot-from-blueprint blueprint world)
      (progn
        (dolist (robot (world-robots world))
          (when (eq (robot-name robot) (blueprint-name blueprint))
            (remove-robot robot "it has been defined anew")))
        (prog1 (make-robot blueprint world)
          (arrange-robots world)))))

(defun current-resident-world-p (world)
  "True if WORLD is the resident world of its map, and no other map has replaced this map."
  (let ((map (world-map world)))
    (and (eq world (map-resident map))
         (eq map (find-map (map-name map) nil)))))

;; Another thread may do the same meanwhile: the thread that owns the world decides. If the world
;; has been replaced, repeat this for the new one.
(defun ensure-resident-robot (blueprint)
  "Put a robot made from BLUEPRINT into the resident world of its map, instead of robots from
earlier definitions of the same name. Return the robot, or the robot that is already there."
  (loop
    (let ((world (map-resident-world (find-map (blueprint-map blueprint)))) (robot nil))
      (check-start blueprint (world-map world))
      (unless (find-robot-from-blueprint blueprint world)
        (remove-robots-named (blueprint-name blueprint) "it has been defined anew"))
      (asking ((ensure-timeline world))
        (when (current-resident-world-p world) (setf robot (ensure-robot-in world blueprint))))
      (when robot (return robot)))))

(defmethod undo-definition ((blueprint blueprint))
  (remove-robots-named (blueprint-name blueprint) "its definition has been taken back"))

(defmethod redo-definition ((blueprint blueprint))
  (let ((robot (blueprint-robot blueprint)))
    (when (robot-p robot)
      (let ((world (robot-world robot)))
        ;; In the order in which they were defined.
        (setf (robot-retired robot) nil
              (world-robots world)
              (sort (copy-list (adjoin robot (world-robots world))) #'<
                    :key (lambda (each)
                           (or (position (robot-name each) (all-blueprints) :key #'blueprint-name)
                               -1)))))))
  blueprint)

(define-facts (blueprint blueprint)
  "Starts in" (format nil "~(~A~) at (~,2F,~,2F), heading ~,2F" (blueprint-map blueprint)
                      (blueprint-x blueprint) (blueprint-y blueprint)
                      (blueprint-angle blueprint))
  "Parts" (and (blueprint-parts blueprint)
               (format nil "~{~(~A~@[ (~{~A ~A~^, ~})~]~)~^; ~}" ; Kind, initargs, kind, initargs.
                       (loop for (kind . initargs) in (blueprint-parts blueprint)
                             collect kind
                             collect initargs))))
