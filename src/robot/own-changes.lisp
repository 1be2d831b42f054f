;;;; own-changes.lisp -- what programs do to a robot besides commanding it (manual 3.2.2, E).

(in-package :ars-magna.robot)

;;; Odometers and where the robot stands belong to its world. So programs change them by way of the
;;; world's owner, whose journal notes what they did.

(addition make-odometer)
(defun make-odometer (robot name)
  "Return a new odometer of ROBOT called NAME, a symbol. Another of that name is destroyed: it
no longer changes (manual 3.2.2)."
  (check-argument make-odometer robot (robot-p robot) (argument-type-text 'robot robot))
  (check-argument make-odometer name (and name (symbolp name)) "a symbol")
  (changing ((robot-world robot) make-odometer robot name)
    (add-odometer robot name)))

(define-operator 'make-odometer '(robot name) #'make-odometer)

(defun reset-by-program (odometer part)
  "Reset PART of ODOMETER because a program says so. Return ODOMETER. One that has been destroyed is
no part of the robot any more."
  (let ((robot (odometer-robot odometer)) (name (odometer-name odometer)))
    (if (eq odometer (robot-odometer robot name))
        (changing ((robot-world robot) reset-odometer robot name part)
          (reset-reading odometer part))
        (reset-reading odometer part)))
  odometer)

(defun reset-named-odometer (robot name part)
  "Reset PART, :POS or :ANG, of the odometer of ROBOT called NAME, if there is one."
  (let ((odometer (robot-odometer robot name)))
    (when odometer (reset-by-program odometer part))))

(define-argument-type 'odometer-part (lambda (value) (member value '(:pos :ang))) ":pos or :ang")
(define-operator 'reset-odometer '(robot name odometer-part) #'reset-named-odometer)

(public reset-odometer-pos)
(defun reset-odometer-pos (odometer)
  "Let ODOMETER count its position from here. Return ODOMETER (manual 3.2.2)."
  (check-odometer odometer 'reset-odometer-pos)
  (reset-by-program odometer :pos))

(public reset-odometer-ang)
(defun reset-odometer-ang (odometer)
  "Let ODOMETER count its angle from the present heading. Return ODOMETER (manual 3.2.2)."
  (check-odometer odometer 'reset-odometer-ang)
  (reset-by-program odometer :ang))

(public reset-odometer)
(defun reset-odometer (odometer)
  "Let ODOMETER count position and angle from here. Return ODOMETER (manual 3.2.2)."
  (check-odometer odometer 'reset-odometer)
  (reset-odometer-ang (reset-odometer-pos odometer)))

(addition place-robot)
(defun place-robot (robot x y angle)
  "Put ROBOT at (X,Y) heading ANGLE at once, without error and ignoring obstacles: a change from
outside, as the prompt's POS and ANGLE make. That it is inside a wall then is a warning among the
messages. Signals WRONG-ARGUMENT (manual E). See reading 114."
  (check-argument place-robot robot (robot-p robot) (argument-type-text 'robot robot))
  (check-of-type 'place-robot 'x x 'number)
  (check-of-type 'place-robot 'y y 'number)
  (check-of-type 'place-robot 'angle angle 'angle)
  (doubt-angle 'place-robot (robot-world robot) angle)
  (let ((map (world-map (robot-world robot))))
    (unless (map-index map x y)
      (reject-argument "pos" "position" (list x y)
                       (format nil "a point of the map: 0 <= x < ~D, 0 <= y < ~D"
                               (map-width map) (map-height map)))))
  (changing ((robot-world robot) place-robot robot x y angle)
    (set-robot-pose robot x y angle)
    (tell-if-in-wall (princ-to-string (robot-name robot)) (robot-world robot) x y))
  robot)

(define-operator 'place-robot '(robot number number angle) #'place-robot)
