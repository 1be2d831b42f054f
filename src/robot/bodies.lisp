;;;; bodies.lisp -- several robots in a world: full names, bodies, dice, and whose turn it is.

(in-package :ars-magna.robot)

(export '(robot-full-name robot-label name-label find-robot-named robots-meant arrange-robots
          robots-in-order sorted-by-full-name robot-at occupant-text turn-salt))

;;; A robot alone in its world uses the world's dice and has no body, as in the manual. From two
;;; robots on, each robot has its own dice, keyed by its full name, and a body, unless the world's
;;; robots are ghosts. So another robot changes nobody's noise, and the order in which robots are
;;; defined or listed has no effect.

(addition robot-full-name)
(defun robot-full-name (robot)
  "Return the full name of ROBOT, a string: package and name, such as \"MY-PACKAGE::SCOUT\"."
  (qualified-name (robot-name robot)))

(defun name-label (name names)
  "Return the symbol NAME as a string: with its package if a symbol in NAMES differs only in its
package, else without."
  (if (some (lambda (other) (and (not (eq name other)) (same-name-p name other))) names)
      (qualified-name name)
      (symbol-name name)))

(defun robot-label (robot)
  "Return the name of ROBOT as a string: the full name if another robot in the world has a name that
differs only in its package, else the name without package."
  (let ((robots (and (robot-world robot) (world-robots (robot-world robot)))))
    (name-label (robot-name robot) (and (rest robots) (mapcar #'robot-name robots)))))

(defun robots-meant (name robots &key (key #'robot-name))
  "Return a list of those of ROBOTS that NAME can mean: the one with the symbol or the full name
NAME; if there is none, all with the name without package. KEY returns the symbol that names an
element of ROBOTS."
  (flet ((matching (test)
           (remove-if-not (lambda (robot) (funcall test name (funcall key robot))) robots)))
    (or (and (symbolp name) (matching #'eq))
        (and (stringp name)
             (search "::" name)
             (matching (lambda (name symbol) (string-equal name (qualified-name symbol)))))
        (matching #'same-name-p))))

(defun find-robot-named (name robots)
  "Return the robot of ROBOTS with NAME, or NIL. NAME is a symbol, or a string: a full name or one
without package. A name without package means the first robot with this name."
  (first (robots-meant name robots)))

(defun sorted-by-full-name (robots)
  "Return a list of ROBOTS, sorted by their full names."
  (flet ((named (robot) (cons (robot-full-name robot) robot)))
    (mapcar #'cdr (sort (mapcar #'named robots) #'string< :key #'car))))

(defun robots-in-order (world)
  "Return a list of the robots in WORLD, sorted by their full names. Any thread may call this
function. Do not alter the list."
  (if (world-dice-names world)
      (world-roster world)
      (world-robots world)))

(defmethod parts-to-digest ((world world) (parts list))
  (if (and (rest parts) (robot-p (first parts)))
      (robots-in-order world)
      parts))

;;; Dice.

(declaim (inline dice-at robot-dice))
(defun dice-at (world base purpose)
  "Return the dice for PURPOSE of the robot in WORLD whose ROBOT-DICE-BASE is BASE."
  (declare (type world world) (type (unsigned-byte 32) base))
  (the dice (svref (world-dice-set world) (+ base (dice-index purpose)))))

(addition robot-dice)
(defun robot-dice (robot purpose)
  "Return the dice of ROBOT for PURPOSE: :motion, :odometry, :place, :looking, :tracking, :handling
or :manipulations. They are the world's dice if ROBOT is alone in its world; see WORLD-DICE."
  (dice-at (robot-world robot) (robot-dice-base robot) purpose))

(defun arrange-dice (world robots)
  "Give each of ROBOTS, which are sorted, its own dice in WORLD if there are several."
  (let ((names (mapcar #'robot-full-name robots)) (several-p (rest robots)))
    (unless (equal (and several-p names) (world-dice-names world))
      (give-dice world (and several-p names)))
    (loop for robot in robots
          for name in names
          for base from (length +dice-purposes+) by (length +dice-purposes+)
          do (setf (robot-dice-base robot) (if several-p base 0)
                   (robot-key robot) (ldb (byte 62 0) (text-hash name))))))

;;; Bodies.

(defun body-label (body)
  "Return the name of the robot of BODY as a string, also after BODY was removed."
  (if (body-robot body)
      (robot-label (body-robot body))
      (symbol-name (thing-name body))))

(defmethod reference ((body body))
  (list :body (body-label body)))

(defmethod print-object ((body body) stream)
  (print-named body stream (body-label body)
               (concatenate 'string "BODY " (body-label body))))

(defun give-body (robot)
  (setf (robot-body robot)
        (make-body robot (robot-name robot) (blueprint-attributes (robot-blueprint robot))
                   (robot-world robot) (robot-x robot) (robot-y robot))))

;; Without a body, the attributes are those of the robot's definition.
(defmethod attribute-holder (operator (robot robot))
  (declare (ignore operator))
  (let ((body (robot-body robot)))
    (values body
            (if body
                (thing-attributes body)
                (blueprint-attributes (robot-blueprint robot))))))

(defun take-body (robot)
  "Remove the body of ROBOT, if it has one."
  (let ((body (shiftf (robot-body robot) nil)))
    (when body (remove-body body))))

(defun arrange-robots (world)
  "The robots of WORLD have changed. Give them dice and bodies if there are several, else take both
away. Call this function whenever robots have joined or left WORLD, and after a reset."
  (let* ((several-p (rest (world-robots world)))
         (robots (sorted-by-full-name (world-robots world))))
    (setf (world-roster world) robots)
    (arrange-dice world robots)
    (when (and (world-timeline world) (not several-p))
      (setf (agenda-salt (timeline-agenda (world-timeline world))) nil))
    (if (and several-p (not (world-ghosts-p world)))
        (dolist (robot robots) (unless (robot-body robot) (give-body robot)))
        (mapc #'take-body robots))))

(defun robot-at (world x y)
  "Return a robot with a body in the cell of WORLD that holds the point (X,Y), or NIL."
  (let ((index (map-index (world-map world) x y)))
    (when index
      (do-cell-bodies (body index world) (return-from robot-at (body-robot body))))))

(defun occupant-text (world x y &optional robot)
  "If another robot than ROBOT has its body in the cell of (X,Y) in WORLD, return a text that says
so; else NIL."
  (let ((other (robot-at world x y)))
    (when (and other (not (eq other robot)))
      (format nil "~A is in the cell of ~A" (robot-label other) (point-text x y)))))

;; The position is that of the robot.
(defmethod digest-state :after ((robot robot) digest)
  (let ((body (robot-body robot)))
    (when body (digest-add digest (thing-attributes body)))))

;;; Whose turn it is. Within a tick, robots act in an order that is drawn anew in each tick.

(defmethod resource-key ((robot robot)) (robot-key robot))
(defmethod resource-key ((part part)) (robot-key (part-robot part)))
(defmethod resource-key ((resource inner-resource))
  (robot-key (inner-resource-robot resource)))

(defun turn-salt (world tick)
  "Return a number that determines the order of the robots of WORLD in TICK."
  (mixed-word (world-seed world) tick))
