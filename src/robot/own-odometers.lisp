;;;; own-odometers.lisp -- what programs do to a robot's odometers (manual 3.2.2).

(in-package :ars-magna.robot)

;;; Odometers belong to the robot's state. So programs change them by way of its simulation, whose
;;; journal notes what they did.

(addition make-odometer)
(defun make-odometer (robot name)
  "Return a new odometer of ROBOT called NAME, a symbol. Another of that name is destroyed: it
no longer changes (manual 3.2.2)."
  (check-argument make-odometer robot (robot-p robot) "a robot")
  (check-argument make-odometer name (and name (symbolp name)) "a symbol")
  (change-from-outside (robot-simulation robot)
                       (lambda () (add-odometer robot name))
                       (list :make-odometer robot name)))

(defmethod apply-entry ((operation (eql :make-odometer)) arguments simulation)
  (declare (ignore simulation))
  (apply #'make-odometer arguments))

(defun reset-by-program (odometer part)
  "Reset PART of ODOMETER because a program says so. Return ODOMETER. One that has been destroyed is
no part of the robot any more."
  (let ((robot (odometer-robot odometer)) (name (odometer-name odometer)))
    (flet ((reset () (reset-reading odometer part)))
      (if (eq odometer (robot-odometer robot name))
          (change-from-outside (robot-simulation robot) #'reset
                               (list :reset-odometer robot name part))
          (reset))))
  odometer)

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

(defmethod apply-entry ((operation (eql :reset-odometer)) arguments simulation)
  (declare (ignore simulation))
  (destructuring-bind (robot name part) arguments
    (let ((odometer (robot-odometer robot name)))
      (when odometer (reset-by-program odometer part)))))
