;;;; references.lisp -- what changes a world from outside, and how a journal names what it concerns.

(in-package :ars-magna.robot)

;;; A journal outlives its run, so robots, parts and things stand in it by name, index or serial
;;; number. Changes that programs make to a world pass through its simulation, which notes them.

(defmethod externalize ((robot robot)) (make-reference :robot (list (string (robot-name robot)))))
(defmethod externalize ((camera camera)) (part-reference :camera camera))
(defmethod externalize ((hand hand)) (part-reference :hand hand))
(defmethod externalize ((bin storage-bin)) (part-reference :bin bin))
(defmethod externalize ((thing thing))
  (if (thing-world thing) (make-reference :thing (list (thing-serial thing))) thing))
(defmethod externalize ((kicker kicker)) (kicker-name kicker))
(defmethod externalize ((world world)) (externalize (world-map world)))
(defmethod externalize ((map map)) (make-reference :map (list (string (map-name map)))))

(defun part-reference (kind part)
  (make-reference kind (list (string (robot-name (part-robot part))) (part-index part))))

(defun robot-in (simulation name)
  (or (find name (simulation-robots simulation) :key #'robot-name :test #'same-name-p)
      (reject-name "robot in this simulation" name
                   (mapcar #'robot-name (simulation-robots simulation)))))

(macrolet ((define-part-reference (kind reader)
             `(defmethod internalize-reference ((kind (eql ,kind)) arguments simulation)
                (destructuring-bind (name index) arguments
                  (,reader (robot-in simulation name) index)))))
  (define-part-reference :camera robot-camera)
  (define-part-reference :hand robot-hand)
  (define-part-reference :bin robot-storage-bin))

(defmethod internalize-reference ((kind (eql :robot)) arguments simulation)
  (robot-in simulation (first arguments)))

(defmethod internalize-reference ((kind (eql :thing)) arguments simulation)
  (find-thing (first arguments) (simulation-world simulation)))

(defmethod internalize-reference ((kind (eql :map)) arguments simulation)
  (declare (ignore simulation))
  (find-map (first arguments)))

;;; Changes to the world by programs go through its simulation.

(defun access-world (function world operation arguments)
  (let ((simulation (and world (world-simulation world))))
    (if simulation
        (change-from-outside simulation function (list* :world operation arguments))
        (funcall function))))

(setf *world-access* #'access-world)

(defmethod apply-entry ((operation (eql :world)) arguments simulation)
  (let ((*world* (simulation-world simulation)))
    (apply (first arguments) (rest arguments))))

(addition place-robot)
(defun place-robot (robot x y angle)
  "Put ROBOT at (X,Y) heading ANGLE at once, without error and ignoring obstacles: a change from
outside, as the prompt's POS and ANGLE make. Signals WRONG-ARGUMENT (manual E)."
  (check-argument place-robot x (realp x) "a number of metres")
  (check-argument place-robot y (realp y) "a number of metres")
  (check-argument place-robot angle (and (realp angle) (< -1d9 angle 1d9))
                  "an angle in radians, between -1e9 and 1e9")
  (let ((map (world-map (robot-world robot))))
    (unless (map-index map x y)
      (error 'wrong-argument :operator "pos" :name "position" :value (list x y)
                             :expected (format nil "a point of the map: 0 <= x < ~D, 0 <= y < ~D"
                                               (map-width map) (map-height map)))))
  (change-from-outside (robot-simulation robot)
                       (lambda () (set-robot-pose robot x y angle))
                       (list :place-robot robot x y angle))
  robot)

(defmethod apply-entry ((operation (eql :place-robot)) arguments simulation)
  (declare (ignore simulation))
  (apply #'set-robot-pose arguments))
