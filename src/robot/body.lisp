;;;; body.lisp -- defrobot: what a robot is made of, and where it starts (manual 5.2).

(in-package :ars-magna.robot)

;;; A body is the recipe of a robot. DEFROBOT puts a robot made by it into its map's resident
;;; world and binds the robot's name; a fresh simulation makes another by the same recipe.

(defstruct (body (:copier nil))
  "What DEFROBOT said of a robot."
  (name nil :type symbol :read-only t)
  (map nil :type symbol :read-only t)
  (x 0d0 :type double-float :read-only t)
  (y 0d0 :type double-float :read-only t)
  (angle 0d0 :type double-float :read-only t)
  (cameras '() :type list :read-only t)
  (hands '() :type list :read-only t)
  (bins '() :type list :read-only t))

(setf (documentation 'body-p 'function) "True of what DEFROBOT said of a robot."
      (documentation 'body-name 'function) "Return the name of the robot."
      (documentation 'body-map 'function) "Return the name of the map that the robot starts in.")

(defvar *bodies* '() "The bodies of all robots, in order of definition.")

(addition all-robots)
(defun all-robots ()
  "Return a list of the names of all robots, in order of definition."
  (mapcar #'body-name *bodies*))

(defun find-body (name)
  (or (find name *bodies* :key #'body-name :test #'same-name-p)
      (reject-name "robot" name (all-robots))))

(defun find-body-name (name)
  (body-name (find-body name)))

(addition find-robot)
(defun find-robot (name)
  "Return the robot called NAME, a symbol or string: the one that the variable of that name
holds. Signals UNKNOWN-NAME."
  (symbol-value (find-body-name name)))

;;; Making robots.

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
                    (loop for capacity in (body-bins body) collect (list :capacity capacity)))))

(defun make-robot (body world)
  "Return a robot made by BODY, at its start in WORLD."
  (let ((robot (%make-robot :name (body-name body) :body body :world world)))
    (outfit robot body)
    (set-robot-pose robot (body-x body) (body-y body) (body-angle body))
    (add-odometer robot 'main)
    (setf (world-robots world) (append (world-robots world) (list robot)))
    robot))

(defun reset-robot (robot)
  "Put ROBOT back to how it was made, its parts the same objects as before."
  (let ((body (robot-body robot)))
    (setf (resource-event robot) nil
          (robot-speed robot) 0.8d0
          (robot-turn-angle robot) 0.3d0
          (robot-last-place robot) nil
          (robot-drove-tick robot) -1
          (robot-odometer-list robot) '())
    (forget-designators robot)
    (set-robot-pose robot (body-x body) (body-y body) (body-angle body))
    (add-odometer robot 'main)
    (map nil #'reset-camera (robot-cameras robot))
    (map nil #'reset-hand (robot-hands robot))
    (map nil #'reset-bin (robot-bins robot))
    robot))

(defun reset-part (part)
  (setf (resource-event part) nil
        (part-location part) nil))

(defun reset-camera (camera)
  (reset-part camera)
  (setf (camera-angle camera) 0d0
        (camera-last-view camera) '()
        (camera-tracking camera) nil))

(defun reset-hand (hand)
  (reset-part hand)
  (setf (hand-contents hand) '()))

(defun reset-bin (bin)
  (reset-part bin)
  (setf (storage-bin-contents bin) '()
        (storage-bin-closed-p bin) nil))

;;; The defining form.

(defun parse-camera (specification reject)
  (unless (and (listp specification) (= (length specification) 2)
               (realp (first specification)) (< 0 (first specification) (+ 2pi 1d-9))
               (typep (second specification) '(integer 1)))
    (funcall reject specification "(field-of-view resolution): radians above 0 and at most 2 pi, ~
                                   and a number of pixels"))
  (list (double (first specification)) (second specification)))

(defun parse-amount (amount reject)
  (unless (and (realp amount) (not (minusp amount)))
    (funcall reject amount "a number, 0 or more"))
  (double amount))

(defun parse-place (environment position angle reject)
  "Return the map, and where in it the robot starts."
  (let ((map (find-map environment)))
    (destructuring-bind (x y) position
      (unless (and (realp x) (realp y) (not (wall-at-p map x y)))
        (funcall reject position
                 (format nil "a position in the open: ~D x ~D cells, and that one is a wall"
                         (map-width map) (map-height map))))
      (unless (realp angle) (funcall reject angle "a heading in radians"))
      map)))

(defun make-body-from (name environment position angle cameras hands bins)
  (flet ((reject (clause control)
           (reject-clause (format nil "defrobot ~(~A~)" name) clause (format nil control))))
    (let ((map (parse-place environment position angle #'reject)))
      (make-body :name name :map (map-name map)
                 :x (double (first position)) :y (double (second position))
                 :angle (double angle)
                 :cameras (loop for camera in cameras collect (parse-camera camera #'reject))
                 :hands (loop for hand in hands collect (parse-amount hand #'reject))
                 :bins (loop for bin in bins collect (parse-amount bin #'reject))))))

(defun register-body (body)
  (setf *bodies* (append (remove (body-name body) *bodies*
                                 :key #'body-name :test #'same-name-p)
                         (list body))))

(addition define-robot)
(defun define-robot (name environment position angle &key cameras hands bins)
  "Do as DEFROBOT does, with values: ENVIRONMENT is a map or its name, POSITION a list (x y),
CAMERAS a list of lists (fov resolution). Return the robot."
  (let* ((body (make-body-from name environment position angle cameras hands bins))
         (world (map-resident-world (find-map (body-map body))))
         (old (find name (world-robots world) :key #'robot-name :test #'same-name-p)))
    (register-body body)
    (flet ((settle ()
             (setf (world-robots world) (remove old (world-robots world)))
             (setf (symbol-value name) (make-robot body world))))
      (if (world-simulation world)
          (asking ((world-simulation world)) (settle))
          (settle)))))

(defun check-robot-form (name start options)
  (flet ((reject (clause expected)
           (reject-clause (format nil "defrobot ~(~A~)" name) clause expected)))
    (unless (and name (symbolp name)) (reject name "a symbol as the robot's name"))
    (unless (and (consp start) (= (length start) 3)
                 (listp (second start)) (= (length (second start)) 2))
      (reject start "(environment (x y) angle)"))
    (loop for (key value . more) on options by #'cddr
          do (unless (member key '(:cameras :hands :bins))
               (reject (list key value)
                       ":cameras ((fov res) ...), :hands (strength ...) or :bins (capacity ...)"))
             (unless (listp value) (reject (list key value) "a list after the keyword")))
    (when (oddp (length options)) (reject options "pairs of a keyword and a list"))))

(public defrobot)
(defmacro defrobot (name (&rest start) &rest options)
  "Define a robot: (defrobot NAME (ENVIRONMENT (X Y) ANGLE) [:cameras ((FOV RESOLUTION) ...)]
[:hands (STRENGTH ...)] [:bins (CAPACITY ...)]). NAME becomes a special variable bound to the
robot, which stands in the resident world of the map ENVIRONMENT (its variable or name) at (X,Y),
in metres, heading ANGLE, in radians. Numbers are evaluated. Signals MALFORMED-DEFINITION
(manual 5.2)."
  (check-robot-form name start options)
  (destructuring-bind (environment (x y) angle) start
    (destructuring-bind (&key cameras hands bins) options
      `(progn
         (defvar ,name)
         (define-robot ',name ',environment (list ,x ,y) ,angle
           :cameras (list ,@(loop for camera in cameras
                                  collect (if (listp camera) `(list ,@camera) camera)))
           :hands (list ,@hands)
           :bins (list ,@bins))
         ',name))))
