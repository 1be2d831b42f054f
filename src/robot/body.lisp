;;;; body.lisp -- defrobot: what a robot is made of, and where it starts (manual 5.2).

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
  (bins '() :type list :read-only t))

(setf (documentation 'body-p 'function) "True of what DEFROBOT said of a robot."
      (documentation 'body-name 'function) "Return the name of the robot."
      (documentation 'body-map 'function) "Return the name of the map that the robot starts in.")

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

;;; Retiring robots.

(defun retire-robot (robot reason)
  "Let ROBOT take no more commands, for REASON, a sentence without its full stop."
  (setf (robot-retired robot) reason))

(defun check-in-run (resource operator)
  "Signal MISUSE if the robot that is RESOURCE, or has it as a part, is retired."
  (let ((robot (if (robot-p resource) resource (part-robot resource))))
    (when (robot-retired robot)
      (reject-use "~(~A~): the run of this ~(~A~) is over: ~A.~@[ Command the robot that the ~
                   variable ~(~A~) holds now.~]"
                  operator (robot-name robot) (robot-retired robot)
                  (and (successor robot) (robot-name robot))))))

(defun successor (robot)
  "Return the robot that is called as ROBOT, which is retired, and takes commands, or NIL."
  (let ((other (find-robot (robot-name robot) nil)))
    (and other (null (robot-retired other)) other)))

(defun robots-called (name)
  "Return the robots whose name is the symbol NAME in the worlds that top-level code works in."
  (loop for map in (all-maps)
        append (and (map-resident map)
                    (remove name (world-robots (map-resident map))
                            :key #'robot-name :test-not #'eq))))

(defun interrupt-robot (robot)
  "Interrupt all that ROBOT and its parts are doing. Called by the owner of its world."
  (let ((simulation (world-simulation (robot-world robot))))
    (when simulation
      (abandon simulation (cons robot (robot-parts robot))))))

(defun take-out (robot reason)
  "Retire ROBOT, interrupt what it is doing, and take it out of its world."
  (let ((world (robot-world robot)))
    (retire-robot robot reason)
    (interrupt-robot robot)
    (setf (world-robots world) (remove robot (world-robots world)))))

(defun ask-owner (world function)
  "Call FUNCTION where WORLD stands still."
  (if (world-simulation world)
      (ask (world-simulation world) function)
      (funcall function)))

(defun take-out-all (name reason)
  "Take all robots called NAME out of the worlds that top-level code works in."
  (dolist (robot (robots-called name))
    (ask-owner (robot-world robot) (lambda () (take-out robot reason)))))

(defun settle (body)
  "Put a robot made by BODY into the resident world of its map, instead of any that was made by an
earlier definition of its name, and return it."
  (let* ((world (map-resident-world (find-map (body-map body))))
         (robot nil))
    (check-start body (world-map world))
    (take-out-all (body-name body) "it has been defined anew")
    (ask-owner world (lambda () (setf robot (make-robot body world))))
    robot))

(defmethod take-back ((body body))
  (take-out-all (body-name body) "its definition has been taken back"))

(defun in-order-of-definition (robots)
  "Return ROBOTS in the order in which they were defined."
  (sort (copy-list robots) #'<
        :key (lambda (robot)
               (or (position (robot-name robot) (all-bodies) :key #'body-name) -1))))

(defmethod reinstate ((body body))
  (let ((robot (body-robot body)))
    (when (robot-p robot)
      (let ((world (robot-world robot)))
        (setf (robot-retired robot) nil
              (world-robots world) (in-order-of-definition
                                    (adjoin robot (world-robots world)))))))
  body)

;;; The defining form.

(defun parse-camera (specification reject)
  (unless (and (listp specification) (= (length specification) 2)
               (realp (first specification)) (< 0 (first specification) (+ 2pi 1d-9))
               (typep (second specification) '(integer 1)))
    (funcall reject specification
             "(field-of-view resolution): radians above 0, at most 2 pi, and a number of pixels"))
  (list (double (first specification)) (second specification)))

(defun parse-amount (amount reject)
  (unless (and (realp amount) (not (minusp amount)))
    (funcall reject amount "a number, 0 or more"))
  (double amount))

(defun maps-to-choose (name)
  "Return in words which maps there are, for somebody who has asked for NAME."
  (let ((names (mapcar #'map-name (all-maps))))
    (if names
        (format nil "a map: ~{~(~A~)~^, ~}~@[; did you mean ~(~A~)?~]"
                names (nearest-name name names))
        "a map; there is none yet")))

(defun parse-place (environment position angle reject)
  "Return the map, and where in it the robot starts."
  (unless (typep environment '(or map symbol string))
    (funcall reject environment "a map or its name"))
  (let ((map (or (find-map environment nil)
                 (funcall reject environment (maps-to-choose environment)))))
    (destructuring-bind (x y) position
      (unless (and (realp x) (realp y)) (funcall reject position "a position (x y), two numbers"))
      (let ((trouble (start-trouble map x y)))
        (when trouble
          (funcall reject position (format nil "a position in the open of ~(~A~), and ~A"
                                           (map-name map) trouble))))
      (unless (realp angle) (funcall reject angle "a heading in radians"))
      map)))

(defun make-body-from (name environment position angle cameras hands bins)
  (flet ((reject (clause expected)
           (reject-clause (format nil "defrobot ~(~A~)" name) clause expected)))
    (let ((map (parse-place environment position angle #'reject)))
      (make-body :name name :map (map-name map)
                 :x (double (first position)) :y (double (second position))
                 :angle (double angle)
                 :cameras (loop for camera in cameras collect (parse-camera camera #'reject))
                 :hands (loop for hand in hands collect (parse-amount hand #'reject))
                 :bins (loop for bin in bins collect (parse-amount bin #'reject))))))

(addition define-robot)
(defun define-robot (name environment position angle &key cameras hands bins)
  "Do as DEFROBOT does, with values: ENVIRONMENT is a map or its name, POSITION a list (x y),
CAMERAS a list of lists (fov resolution). Return the robot."
  (check-robot-name (format nil "defrobot ~(~A~)" name) name)
  (check-robot-variable name)
  (let* ((body (make-body-from name environment position angle cameras hands bins))
         (robot (settle body)))
    (register *robots* name body :variable t :value robot)
    robot))

(defun check-robot-name (definition name)
  (unless (and name (symbolp name)) (reject-clause definition name "a symbol as the robot's name"))
  (unless (variable-name-p name)
    (reject-clause definition name
                   (format nil "a symbol that can be a variable, as a robot is the value of one, ~
                                and ~A belongs to ~A. Call it my-~(~A~), or shadow the symbol in ~
                                your package: (:shadow #:~(~A~))"
                           name (package-name (symbol-package name)) name name))))

(defun check-robot-variable (name)
  "Signal MALFORMED-DEFINITION if the variable NAME is in use for something else than robots."
  (when (and (null (definition-to-replace name *robots*))
             (variable-in-use-p name))
    (reject-clause (format nil "defrobot ~(~A~)" name) name
                   (format nil "a name whose variable is free; ~A has the value ~S"
                           name (symbol-value name)))))

(defun check-robot-form (definition name start options)
  (flet ((reject (clause expected) (reject-clause definition clause expected)))
    (check-robot-name definition name)
    (unless (and (proper-list-p start) (= (length start) 3)
                 (proper-list-p (second start)) (= (length (second start)) 2))
      (reject start "(environment (x y) angle)"))
    (check-options definition options '(:cameras :hands :bins))
    (loop for (key value) on options by #'cddr
          do (unless (proper-list-p value) (reject (list key value) "a list after the keyword")))))

(defun value-form (definition form clause expected)
  "Return a form for the value of FORM, which stands in CLAUSE; that it has none is DEFINITION's."
  (if (constantp form)
      form
      `(call-for-value (lambda () ,form) ,definition ',clause ,expected)))

(defun robot-forms (definition name start options lisp-environment)
  "Return the forms that DEFROBOT expands to."
  (destructuring-bind (environment (x y) angle) start
    (destructuring-bind (&key cameras hands bins) options
      (flet ((number-of (form clause)
               (value-form definition form clause "a form that has a value")))
        `((define-robot ',name
            ,(value-form definition (map-form environment lisp-environment) start
                         "a map, its name, or a form whose value is one")
            (list ,(number-of x (second start)) ,(number-of y (second start)))
            ,(number-of angle start)
            :cameras (list ,@(loop for camera in cameras
                                   collect (if (proper-list-p camera)
                                               `(list ,@(loop for form in camera
                                                              collect (number-of form camera)))
                                               (number-of camera camera))))
            :hands (list ,@(loop for hand in hands collect (number-of hand hands)))
            :bins (list ,@(loop for bin in bins collect (number-of bin bins)))))))))

(public defrobot)
(defmacro defrobot (&whole form name start &rest options &environment environment)
  "Define a robot: (defrobot NAME (ENVIRONMENT (X Y) ANGLE) [:cameras ((FOV RESOLUTION) ...)]
[:hands (STRENGTH ...)] [:bins (CAPACITY ...)]). NAME becomes a special variable bound to the
robot, which stands in the resident world of the map ENVIRONMENT (its variable or name) at (X,Y),
in metres, heading ANGLE, in radians. Numbers are evaluated. A robot that was called NAME before
takes no more commands. Signals MALFORMED-DEFINITION (manual 5.2)."
  (let ((definition (format nil "defrobot ~(~A~)" name)))
    (expand-definition form
                       (lambda ()
                         (check-robot-form definition name start options)
                         (values (robot-forms definition name start options environment)
                                 (variable-forms name))))))
