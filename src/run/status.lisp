;;;; status.lisp -- the state of a robot as data, as the prompt's STATUS shows it.

(in-package :ars-magna.run)

(export '(designator-status resolve-robot))

;;; The result is plain data: numbers, symbols, strings and lists of these. Things and places are
;;; strings, as they print. Property lists can get more entries in the future.

(defun view-without-effect (camera)
  "Return the current view of CAMERA, then restore the dice and the last view (reading 201)."
  (let* ((dice (robot-dice (part-robot camera) :looking))
         (state (dice-state dice))
         (last-view (camera-last-view camera))
         (tick (camera-last-view-tick camera)))
    (unwind-protect (take-view camera)
      (setf (dice-state dice) state
            (camera-last-view camera) last-view
            (camera-last-view-tick camera) tick))))

(defun container-name (part)
  (and (part-location part) (location-name (part-location part))))

(defun kind-specific-slots (part)
  (set-difference (kind-slots (kind-of part))
                  (kind-slots (find 'part (all-kinds) :key #'kind-name))))

(defgeneric part-status (part)
  (:documentation "Return the plist of PART for STATUS. For a part of a user's kind, it contains the
slots with the roles :STATE and :MEMORY."))

(defmethod part-status ((part part))
  (list :name (princ-to-string part)
        :slots (loop for slot in (reverse (kind-specific-slots part))
                     when (member (kind-slot-role slot) '(:state :memory))
                       collect (list (kind-slot-name slot)
                                     (funcall (kind-slot-reader slot) part)))))

(defmethod part-status ((camera camera))
  (let ((designator (camera-tracks camera)))
    (list :number (camera-index camera)
          :view (view-without-effect camera)
          :asked-tick (and (camera-last-view camera) (camera-last-view-tick camera))
          :tracks (and designator (designator-number designator))
          :angle (camera-angle camera)
          :field-of-view (camera-field-of-view camera)
          :resolution (camera-resolution camera)
          :inside (container-name camera))))

(defmethod part-status ((hand hand))
  (list :number (hand-index hand)
        :strength (hand-strength hand)
        :holds (and (hand-holding hand) (princ-to-string (hand-holding hand)))
        :inside (container-name hand)))

(defmethod part-status ((bin storage-bin))
  (list :number (storage-bin-index bin)
        :closed (storage-bin-closed-p bin)
        :capacity (storage-bin-capacity bin)
        :room (remaining-capacity bin)
        :contents (mapcar #'princ-to-string (storage-bin-contents bin))))

(defun designator-status (designator)
  "Return the property list that describes DESIGNATOR in the value of STATUS."
  (let ((data (designator-data designator)))
    (list :number (designator-number designator)
          :type (designator-type designator)
          :of (if (listp (first data)) :object :place)
          :distance (designator-distance designator)
          :angle (designator-angle designator)
          :data data)))

;;; Commands in progress, and who issued them.

(defun resource-part-name (resource)
  (if (robot-p resource) nil (princ-to-string resource)))

(defun command-in-progress-status (resource)
  "Return a list of one plist about the command in progress on RESOURCE and who issued it; or NIL."
  (multiple-value-bind (name asker) (under-way resource)
    (when name (list (list :part (resource-part-name resource) :command name :for asker)))))

(defun interrupted-status (resource)
  "Return a list of one plist, which describes the last interruption on RESOURCE; or NIL."
  (let ((interruption (last-interruption resource)))
    (when interruption
      (destructuring-bind (what asker by by-asker tick) interruption
        (list (list :part (resource-part-name resource) :command what :for asker
                    :by by :by-for by-asker :tick tick))))))

;;; All of it.

(defun robot-status (robot)
  "Return the value of STATUS for ROBOT. The world is between ticks."
  (let ((resources (cons robot (robot-parts robot))))
    (append
     (list :robot (robot-name robot)
           :map (map-name (world-map (robot-world robot)))
           :tick (world-tick (robot-world robot))
           :position (multiple-value-list (robot-position robot))
           :last-move (multiple-value-list (robot-last-move robot))
           :estimated-last-move (multiple-value-list (robot-last-move-estimate robot))
           :angle (robot-angle robot)
           :speed (robot-speed robot)
           :turn-angle (robot-turn-angle robot))
     (loop for (key reader) in *part-vectors*
           append (list key (map 'list #'part-status (funcall reader robot))))
     (list :place (robot-last-place robot)
           :thinking (simulation-thinking (robot-simulation robot)))
     (let ((unpaid (robot-unpaid-thinking robot)))
       (and (plusp unpaid) (list :unpaid-thinking unpaid)))
     (list :live (live-p (robot-simulation robot))
           :under-way (mapcan #'command-in-progress-status resources)
           :interrupted (mapcan #'interrupted-status resources)
           :failed (last-failure robot)
           :designators (mapcar #'designator-status (live-designators robot)))
     (let ((variables (shown-run-variables (robot-simulation robot))))
       (and variables (list :variables variables))))))

(defun default-robot (simulation)
  "Return the robot of SIMULATION that the prompt commands, else its first robot, or NIL."
  (let ((robots (simulation-robots simulation)))
    ;; After the run, the prompt commands no robot.
    (if (and (rest robots) (not (simulation-over simulation)))
        (or (find (funcall *default-robot-function*) robots) (first robots))
        (first robots))))

(defun resolve-robot (robot operator)
  "Return the robot that ROBOT means: a robot, the name of a robot, or NIL for the robot that the
prompt commands, else the first robot of the current simulation. Errors name OPERATOR."
  (if robot
      (find-robot robot)
      (or (default-robot (current-simulation))
          (reject-use "~(~A~): there is no robot in ~A." operator
                      (simulation-name (current-simulation))))))

(addition status)
(defun status (&optional robot)
  "Return the state of ROBOT, which the prompt command STATUS prints, as a plist of plain data.
ROBOT is a robot or its name, by default the robot that the prompt commands, or else the first of
the current simulation. The properties:
- :ROBOT, :MAP, :TICK
- :POSITION, :LAST-MOVE and :ESTIMATED-LAST-MOVE, lists (x y) in metres
- :ANGLE in radians, :SPEED in metres and :TURN-ANGLE in radians a tick
- :CAMERAS, :HANDS, :BINS and :SENSORS, a property list for each part
- :PLACE, the place type that the robot sensed last, or NIL
- :THINKING, the thinking mode; :LIVE, true in a live run
- :UNPAID-THINKING, only if it is not 0: the value of ROBOT-UNPAID-THINKING
- :UNDER-WAY, a list of property lists: the commands in progress on the robot and its parts, and who
  issued them
- :INTERRUPTED, a list of property lists: the commands interrupted last, and which commands
  interrupted them
- :FAILED, the value of LAST-FAILURE
- :DESIGNATORS, a list of property lists, one for each designator
- :VARIABLES, if the run has used run variables: a property list with :NAME and :VALUE for each
Nothing in the run changes. Signals UNKNOWN-NAME, and MISUSE if there is no robot."
  (let ((robot (resolve-robot robot 'status)))
    (ask robot (lambda () (robot-status robot)))))

(defun commands-in-progress-text (status)
  (format nil "~{~A~^; ~}"
          (loop for entry in (getf status :under-way)
                collect (destructuring-bind (&key part command for) entry
                          (format nil "~@[~A: ~]~(~A~), for ~A" part command for)))))

(defmethod facts ((robot robot))
  (let ((status (robot-status robot)))
    (known-facts
     "Stands in" (format nil "~(~A~) at (~{~,2F~^,~}), heading ~,2F, tick ~D" (getf status :map)
                         (getf status :position) (getf status :angle) (getf status :tick))
     "Carries out" (and (getf status :under-way) (commands-in-progress-text status))
     "Holds" (comma-separated (remove nil (loop for hand in (getf status :hands)
                                           collect (getf hand :holds))))
     "Carries in its bins" (comma-separated (loop for bin in (getf status :bins)
                                             append (getf bin :contents)))
     "Designators" (comma-separated (loop for designator in (getf status :designators)
                                     collect (getf designator :number)))
     "Failed last" (getf (getf status :failed) :text))))
