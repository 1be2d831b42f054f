;;;; making.lisp -- robots, made by their blueprints and put back to their start (manual 5.2).

(in-package :ars-magna.robot)

(export '(blueprint-robot make-robot robot-of-blueprint start-trouble))

;;; DEFROBOT puts a robot made by its blueprint into its map's resident world and binds the robot's
;;; name; a fresh simulation makes another by the same blueprint.

(defun robot-of-blueprint (blueprint world)
  "Return the robot in WORLD that is called as BLUEPRINT says, or NIL."
  (find (blueprint-name blueprint) (world-robots world) :key #'robot-name :test #'eq))

(defun resident-robot (blueprint)
  "Return the robot made by BLUEPRINT, or an earlier one of its name, that top-level code commands."
  (let ((map (find-map (blueprint-map blueprint) nil)))
    (and map (map-resident map) (robot-of-blueprint blueprint (map-resident map)))))

(defun blueprint-robot (blueprint)
  "Return the robot of BLUEPRINT here and now: the value of its variable."
  (let* ((name (blueprint-name blueprint)) (value (and (boundp name) (symbol-value name))))
    (if (robot-p value) value (resident-robot blueprint))))

(addition all-robots)
(defun all-robots ()
  "Return a list of all robots, those that the variables of their names hold, in order of
definition."
  (remove nil (mapcar #'blueprint-robot (all-blueprints))))

(addition find-robot)
(defun find-robot (name &optional (errorp t))
  "Return the robot called NAME, a symbol or string: the one that the variable of that name holds;
a robot is returned as it is. If there is none, signal UNKNOWN-NAME, or return NIL if ERRORP is
NIL."
  (if (robot-p name)
      name
      (let ((blueprint (find-blueprint name errorp)))
        (and blueprint (blueprint-robot blueprint)))))

;;; Making robots.

(defun make-parts (robot specifications)
  "Return a list of parts of ROBOT, made as SPECIFICATIONS, lists (kind initarg value ...), say."
  (loop with counts = '()
        for (kind . initargs) in specifications
        collect (apply (kind-constructor kind)
                       :robot robot :index (1- (incf (getf counts kind 0)))
                       initargs)))

(defun outfit (robot blueprint)
  (setf (robot-mind robot) (make-mind :robot robot)
        (robot-parts robot) (make-parts robot (blueprint-parts blueprint))))

(defun kind-constructor (kind)
  "Return the function that makes parts of KIND, a symbol. Signals MISUSE if there is none."
  (let ((name (find-symbol (concatenate 'string "MAKE-" (symbol-name kind))
                           (symbol-package kind))))
    (if (and name (fboundp name))
        name
        (reject-use "Nothing makes a ~(~A~): there is no function make-~(~:*~A~)." kind))))

(defun start-trouble (map x y)
  "Return in words why a robot cannot start at (X,Y) in MAP, or NIL."
  (cond ((not (map-index map x y))
         (format nil "~A is outside the map, which is ~D by ~D metres"
                 (point-in-text x y) (map-width map) (map-height map)))
        ((wall-at-p map x y) (format nil "~A is inside a wall" (point-in-text x y)))))

(defun check-start (blueprint map)
  "Signal MISUSE unless a robot made by BLUEPRINT fits into MAP."
  (let ((trouble (start-trouble map (blueprint-x blueprint) (blueprint-y blueprint))))
    (when trouble
      (reject-use "~(~A~) no longer fits into ~(~A~): ~A. Define the robot anew."
                  (blueprint-name blueprint) (map-name map) trouble))))

(defun make-robot (blueprint world)
  "Return a robot made by BLUEPRINT, at its start in WORLD. Signals MISUSE if that is in a wall.
See reading 215."
  (check-start blueprint (world-map world))
  (let ((robot (%make-robot :name (blueprint-name blueprint) :blueprint blueprint :world world)))
    (ensure-timeline world)
    (outfit robot blueprint)
    (stand-at-start robot)
    (setf (world-robots world) (append (world-robots world) (list robot)))
    robot))

(defun stand-at-start (robot)
  "Put ROBOT where its blueprint says, with a fresh odometer."
  (let ((blueprint (robot-blueprint robot)))
    (set-robot-pose robot (blueprint-x blueprint) (blueprint-y blueprint)
                    (blueprint-angle blueprint))
    (add-odometer robot 'main)))

(defmethod reset :before ((robot robot))
  (mapc #'free-number (live-designators robot)))

(defmethod reset :after ((robot robot))
  (stand-at-start robot))
