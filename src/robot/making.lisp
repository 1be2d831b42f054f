;;;; making.lisp -- robots are made from their blueprints, reset, and retired (manual 5.2).

(in-package :ars-magna.robot)

(export '(blueprint-robot make-robot add-robot remove-robot *robot-hooks* robot-start-pose
          blueprint-start start-problem-text check-not-retired retire-robot call-run-enders
          ensure-resident-robot restore-definition take-definition-back
          current-resident-world-p))

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

(defun robot-of-current-run (name)
  "Return the robot of the current run that NAME means, or NIL. Signals MISUSE if NAME can mean
several robots."
  (let ((robots (and *world*
                     (typep name '(or symbol string))
                     (robots-meant name (world-robots *world*)))))
    (when (rest robots)
      (reject-use "~A could be ~{~A~^ or ~}. Give the full name."
                  name (mapcar #'robot-full-name robots)))
    (first robots)))

(defun exact-name-p (name blueprint)
  "True if NAME is the symbol that names BLUEPRINT, or the full name of this symbol."
  (or (eq name (blueprint-name blueprint))
      (and (stringp name) (string-equal name (qualified-name (blueprint-name blueprint))))))

(addition find-robot)
(defun find-robot (name &optional (errorp t))
  "Return the robot named NAME, a symbol or string: the value of the variable of this name, or the
robot of this name in the current simulation. If NAME is a robot, return it. If there is no robot,
signal UNKNOWN-NAME, or return NIL if ERRORP is NIL."
  (if (robot-p name)
      name
      (let ((blueprint (find-blueprint name nil)))
        (cond ((and blueprint (exact-name-p name blueprint)) (blueprint-robot blueprint))
              ((robot-of-current-run name))
              (blueprint (blueprint-robot blueprint))
              (t (find-blueprint name errorp))))))

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

(defun blueprint-start (blueprint)
  "Return the list (x y angle) of BLUEPRINT."
  (list (blueprint-x blueprint) (blueprint-y blueprint) (blueprint-angle blueprint)))

(defun robot-start-pose (robot)
  "Return a list (x y angle): where ROBOT starts, in metres and radians."
  (or (robot-start robot) (blueprint-start (robot-blueprint robot))))

(defun check-start (blueprint map &optional (start (blueprint-start blueprint)))
  (let ((trouble (start-problem-text map (first start) (second start))))
    (when trouble
      (reject-use "~(~A~) no longer fits into ~(~A~): ~A. Define the robot again."
                  (blueprint-name blueprint) (map-name map) trouble))))

(defun make-robot (blueprint world &key (name (blueprint-name blueprint)) start)
  "Make a robot from BLUEPRINT in WORLD and return it. START, a list (x y angle), and NAME are given
if the robot has another start or name than BLUEPRINT says. Signals MISUSE if its start is in a wall
or outside the map (reading 215)."
  (check-start blueprint (world-map world) (or start (blueprint-start blueprint)))
  (let ((robot (%make-robot :name name :blueprint blueprint :world world :start start)))
    (ensure-timeline world)
    (setf (robot-mind robot) (make-mind :robot robot)
          (robot-radio robot) (make-radio :robot robot)
          (robot-parts robot) (make-parts robot (blueprint-parts blueprint)))
    (put-at-start robot)
    (setf (world-robots world) (append (world-robots world) (list robot)))
    robot))

(defun put-at-start (robot)
  (apply #'set-robot-pose robot (robot-start-pose robot))
  (add-odometer robot 'main))

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
  ;; Other threads may add and remove functions meanwhile.
  (loop for enders = (robot-enders robot)
        until (swap-if-eq (robot-enders robot) enders '())
        finally (call-each #'funcall enders)))

(defun check-not-retired (resource operator)
  "Signal MISUSE if the robot of RESOURCE, a robot or part, is retired."
  (let* ((robot (if (robot-p resource) resource (part-robot resource)))
         (newest (and (robot-retired robot) (find-robot (robot-name robot) nil))))
    (when (robot-retired robot)
      (reject-finished-run "~(~A~): the run of this ~(~A~) is over: ~A.~@[ Command the robot that ~
                            the variable ~(~A~) holds now.~]"
                           operator (robot-name robot) (robot-retired robot)
                           (and newest (null (robot-retired newest)) (robot-name robot))))))

(define-event *robot-hooks*
  "Functions called when a robot has joined or left a world whose run may have begun, and when its
definition has been registered, with :JOINED, :LEFT or :DEFINED, and the robot.")

(defun end-waiting-requests (robot)
  "Perform the requests to ROBOT, which is retired, that wait for the next tick: they end with
:INTERRUPT. Otherwise the journal would have them after ROBOT has left."
  (let ((timeline (timeline-of robot)) (resources (robot-resources robot)))
    (dolist (request (reverse (timeline-inbox timeline)))
      (when (and (intersection resources (rest (request-journal-entry request)))
                 (withdraw-request request timeline))
        (perform request timeline)))))

(defun leave-things-behind (robot)
  "Leave what the hands and bins of ROBOT hold where ROBOT is."
  (permitting-changes ((robot-world robot))
    (loop for hand across (robot-hands robot)
          do (dolist (thing (copy-list (hand-contents hand))) (set-down hand thing)))
    (loop for bin across (robot-bins robot)
          do (dolist (thing (copy-list (storage-bin-contents bin)))
               (move-thing thing (robot-x robot) (robot-y robot))))))

(defun remove-robot (robot reason)
  "Retire ROBOT for REASON, end what it does, and take it from its world. What it holds stays."
  (let ((world (robot-world robot)))
    (deferring-interrupts
      (in-any-case
        (retire-robot robot reason)
        (call-run-enders robot)
        (end-waiting-requests robot)
        (interrupt-resources (timeline-of robot) (robot-resources robot))
        (leave-things-behind robot)
        (take-body robot)
        (setf (world-robots world) (remove robot (world-robots world)))
        (arrange-robots world)
        ;; It may still be looked at.
        (setf (robot-dice-base robot) 0)
        (call-listeners *robot-hooks* :left robot)))))

(defun remove-robots-named (name reason &optional except)
  "Remove the robots called NAME from all resident worlds except the world EXCEPT, for REASON."
  (dolist (world (remove except (remove nil (mapcar #'map-resident (all-maps)))))
    (dolist (robot (remove name (world-robots world) :key #'robot-name :test-not #'eq))
      (asking ((ensure-timeline world)) (remove-robot robot reason)))))

(defun add-robot (blueprint world &rest options &key name start)
  "Make a robot as MAKE-ROBOT does in WORLD, whose run may have begun. Return the robot."
  (declare (ignore name start))
  (let ((robot (apply #'make-robot blueprint world options)))
    (arrange-robots world)
    (call-listeners *robot-hooks* :joined robot)
    robot))

(defun find-robot-from-blueprint (blueprint world)
  (find-if (lambda (robot)
             (and (eq blueprint (robot-blueprint robot)) (null (robot-retired robot))))
           (world-robots world)))

;; When a file is loaded again, it defines the robot in the way anew, too.
(defun loaded-again-together-p (name other)
  (and (defined-in-this-file-p name *robots*) (defined-in-this-file-p other *robots*)))

(defun robot-in-the-way (blueprint world)
  "Return a robot that is in the cell of WORLD where BLUEPRINT starts and will stay there, or NIL."
  (flet ((cell (x y) (map-index (world-map world) x y)))
    (find-if (lambda (robot)
               (and (= (cell (robot-x robot) (robot-y robot))
                       (cell (blueprint-x blueprint) (blueprint-y blueprint)))
                    (not (eq (robot-name robot) (blueprint-name blueprint)))
                    (not (loaded-again-together-p (blueprint-name blueprint)
                                                  (robot-name robot)))))
             (world-robots world))))

(defun under-way-or-live-p (world)
  "True if ticks of WORLD have passed or pass by themselves."
  (or (plusp (world-tick world))
      (and (world-timeline world) (timeline-thread (world-timeline world)))))

(defun check-start-free (blueprint world)
  "Signal MISUSE if the run of WORLD has begun and another robot is where BLUEPRINT starts."
  (let ((other (and (under-way-or-live-p world)
                    (not (world-ghosts-p world))
                    (robot-in-the-way blueprint world))))
    (when other
      (reject-use "defrobot ~(~A~): the run of ~(~A~) is at tick ~D, and ~A is in the cell of ~A. ~
                   Choose another position, or drive ~A away first."
                  (blueprint-name blueprint) (map-name (world-map world)) (world-tick world)
                  (robot-label other)
                  (point-text (blueprint-x blueprint) (blueprint-y blueprint))
                  (robot-label other)))))

(defun ensure-robot-in (world blueprint)
  "Return the robot in WORLD that was made from BLUEPRINT, or make it. Remove other robots of the
same name. The calling thread must own WORLD."
  (or (find-robot-from-blueprint blueprint world)
      (progn
        (check-start-free blueprint world)
        (dolist (robot (world-robots world))
          (when (eq (robot-name robot) (blueprint-name blueprint))
            (remove-robot robot "it has been defined anew")))
        (add-robot blueprint world))))

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
        (check-start-free blueprint world)
        (remove-robots-named (blueprint-name blueprint) "it has been defined anew" world))
      (asking ((ensure-timeline world))
        (when (current-resident-world-p world) (setf robot (ensure-robot-in world blueprint))))
      (when robot (return robot)))))

(defmethod undo-definition ((blueprint blueprint))
  (remove-robots-named (blueprint-name blueprint) "its definition has been taken back"))

(defun restore-definition (robot)
  "Restore the definition from which ROBOT was made, if it has been undefined or replaced. Return
true if so."
  (let ((entry (blueprint-entry (robot-blueprint robot))))
    (when (and entry (restore-entry entry *robots*))
      (remove-robots-named (robot-name robot) "its definition has been restored by a rewind"
                           (robot-world robot))
      t)))

(defun take-definition-back (robot)
  "Remove the definition from which ROBOT, a retired robot, was made, if it still holds. Return true
if so."
  (let* ((entry (blueprint-entry (robot-blueprint robot)))
         (variable (and entry (entry-variable entry))))
    (when (and entry (remove-entry entry *robots*))
      (when (and variable (eq robot (ignore-errors (global-value variable))))
        (forget-value variable))
      t)))

(defun put-robot-back (robot)
  "Add ROBOT, which is in no world, to its world again: in the order in which robots were defined."
  (let ((world (robot-world robot)))
    (setf (world-robots world)
          (sort (copy-list (adjoin robot (world-robots world))) #'<
                :key (lambda (each)
                       (or (position (robot-name each) (all-blueprints) :key #'blueprint-name)
                           -1))))
    (arrange-robots world)
    (call-listeners *robot-hooks* :joined robot)))

(defun robot-in-resident-world (robot)
  "If another world than that of ROBOT is resident in its map, as after a rewind, return the robot
of the same name there, or NIL."
  (let ((world (map-resident (world-map (robot-world robot)))))
    (and world
         (not (eq world (robot-world robot)))
         (find (robot-name robot) (world-robots world) :key #'robot-name))))

(defmethod redo-definition ((blueprint blueprint))
  (let* ((robot (blueprint-robot blueprint))
         (successor (and (robot-p robot) (robot-in-resident-world robot))))
    (cond (successor (setf (global-value (robot-name robot)) successor))
          ((robot-p robot)
           (setf (robot-retired robot) nil)
           (unless (member robot (world-robots (robot-world robot)))
             (put-robot-back robot)))))
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
