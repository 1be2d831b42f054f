;;;; body.lisp -- what a robot is made of, where it starts, and making it (manual 5.2).

(in-package :ars-magna.robot)

;;; A body is the recipe of a robot. DEFROBOT puts a robot made by it into its map's resident
;;; world and binds the robot's name; a fresh simulation makes another by the same recipe. A robot
;;; whose world or definition has been replaced is retired: it takes no more commands.

(defstruct (body (:copier nil))
  "What DEFROBOT said of a robot."
  (name nil :type symbol :read-only t)
  (map nil :type symbol :read-only t)
  (x 0d0 :type double-float :read-only t)
  (y 0d0 :type double-float :read-only t)
  (angle 0d0 :type double-float :read-only t)
  (cameras '() :type list :read-only t)
  (hands '() :type list :read-only t)
  (bins '() :type list :read-only t)
  ;; Of other kinds: lists (kind initarg value ...).
  (parts '() :type list :read-only t))

(document-functions
  body-p "True of what DEFROBOT said of a robot."
  body-name "Return the name of the robot."
  body-map "Return the name of the map that the robot starts in."
  body-x "Return the x coordinate where the robot starts, in metres."
  body-y "Return the y coordinate where the robot starts, in metres.")

(define-registry robot "robot" :object-p body-p :by-symbol t
  :finder find-body :lister all-bodies :internal t)

(defun robot-of-body (body world)
  "Return the robot in WORLD that is called as BODY says, or NIL."
  (find (body-name body) (world-robots world) :key #'robot-name :test #'eq))

(defun resident-robot (body)
  "Return the robot made by BODY, or by an earlier one of its name, that top-level code commands."
  (let ((map (find-map (body-map body) nil)))
    (and map (map-resident map) (robot-of-body body (map-resident map)))))

(defun body-robot (body)
  "Return the robot of BODY here and now: the value of its variable."
  (let* ((name (body-name body)) (value (and (boundp name) (symbol-value name))))
    (if (robot-p value) value (resident-robot body))))

(addition all-robots)
(defun all-robots ()
  "Return a list of all robots, those that the variables of their names hold, in order of
definition."
  (remove nil (mapcar #'body-robot (all-bodies))))

(addition find-robot)
(defun find-robot (name &optional (errorp t))
  "Return the robot called NAME, a symbol or string: the one that the variable of that name holds;
a robot is returned as it is. If there is none, signal UNKNOWN-NAME, or return NIL if ERRORP is
NIL."
  (if (robot-p name)
      name
      (let ((body (find-body name errorp)))
        (and body (body-robot body)))))

;;; Making robots.

(defmethod reference ((body body))
  (list :body (name-string (body-name body))))

(defun make-parts (robot constructor specifications)
  (coerce (loop for specification in specifications
                for index from 0
                collect (apply constructor :robot robot :index index specification))
          'simple-vector))

(defun outfit (robot body)
  "Give ROBOT the parts that BODY lists."
  (setf (robot-cameras robot)
        (make-parts robot #'make-camera
                    (loop for (field-of-view resolution) in (body-cameras body)
                          collect (list :field-of-view field-of-view :resolution resolution)))
        (robot-hands robot)
        (make-parts robot #'make-hand
                    (loop for strength in (body-hands body) collect (list :strength strength)))
        (robot-bins robot)
        (make-parts robot #'make-storage-bin
                    (loop for capacity in (body-bins body) collect (list :capacity capacity)))
        (robot-sensors robot)
        (make-sensors robot (body-parts body))))

(defun make-sensors (robot specifications)
  "Return a vector of parts of ROBOT, made as SPECIFICATIONS, lists (kind initarg value ...), say."
  (coerce (loop for ((kind . initargs) . rest) on specifications
                collect (apply (kind-constructor kind)
                               :robot robot
                               :index (- (count kind specifications :key #'first)
                                         (count kind rest :key #'first)
                                         1)
                               initargs))
          'simple-vector))

(defun kind-constructor (kind)
  "Return the function that makes parts of KIND, a symbol."
  (find-symbol (format nil "MAKE-~A" kind) (symbol-package kind)))

(defun start-trouble (map x y)
  "Return in words why a robot cannot start at (X,Y) in MAP, or NIL."
  (cond ((not (map-index map x y))
         (format nil "(~F ~F) is outside the map, which is ~D by ~D metres"
                 x y (map-width map) (map-height map)))
        ((wall-at-p map x y) (format nil "(~F ~F) is inside a wall" x y))))

(defun check-start (body map)
  "Signal MISUSE unless a robot made by BODY fits into MAP."
  (let ((trouble (start-trouble map (body-x body) (body-y body))))
    (when trouble
      (reject-use "~(~A~) no longer fits into ~(~A~): ~A. Define the robot anew."
                  (body-name body) (map-name map) trouble))))

(defun make-robot (body world)
  "Return a robot made by BODY, at its start in WORLD. Signals MISUSE if that is in a wall."
  (check-start body (world-map world))
  (let ((robot (%make-robot :name (body-name body) :body body :world world)))
    (unless (world-timeline world)
      (setf (world-timeline world) (make-timeline (map-name (world-map world)))))
    (pushnew #'watch-thing (world-move-watchers world))
    (pushnew #'watch-container (world-move-watchers world))
    (outfit robot body)
    (stand-at-start robot)
    (setf (world-robots world) (append (world-robots world) (list robot)))
    robot))

(defun stand-at-start (robot)
  "Put ROBOT where its body says, with a fresh odometer."
  (let ((body (robot-body robot)))
    (set-robot-pose robot (body-x body) (body-y body) (body-angle body))
    (add-odometer robot 'main)))

(defmethod reset :before ((robot robot))
  (mapc #'free-number (live-designators robot)))

(defmethod reset :after ((robot robot))
  (stand-at-start robot))
