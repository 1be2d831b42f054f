;;;; counterparts.lisp -- what an object of a run is in a fork of that.

(in-package :ars-magna.run)

(export '(counterpart-here))

(defgeneric counterpart-here (object)
  (:documentation "Return what OBJECT, of another run, is in the current simulation, a fork of that
run; or NIL. Signals WRONG-ARGUMENT for what has no counterpart.")
  (:method (object)
    (reject-argument 'counterpart "object" object
                     (one-line "a robot, a part of one, a thing, a designator, an odometer, a
task, a fluent or a valve"))))

(defmethod counterpart-here ((robot robot))
  (find (robot-name robot) (simulation-robots *simulation*) :key #'robot-name :test #'eq))

(defmethod counterpart-here ((part part))
  (let ((robot (counterpart-here (part-robot part))))
    (and robot (robot-part robot (type-of part) (part-index part)))))

(defmethod counterpart-here ((odometer odometer))
  (let ((robot (counterpart-here (odometer-robot odometer))))
    (and robot (robot-odometer robot (odometer-name odometer)))))

(defmethod counterpart-here ((designator designator))
  (let ((robot (counterpart-here (designator-robot designator))))
    (and robot (serial-designator robot (designator-serial designator)))))

(defmethod counterpart-here ((thing thing))
  (find-thing (thing-serial thing) *world*))

(addition counterpart)
(defun counterpart (object &optional (fork (current-simulation)))
  "Return what OBJECT, of a run, is in FORK, a fork of that or a fork of its fork; or the run that
goes on since it was rewound, by default the current one. OBJECT may be a robot, a part of one, a
thing, a designator, an odometer, a task, a fluent or a valve. NIL if FORK does not have it: a thing
that is destroyed there, a designator that is invalid, a task that is over. Signals WRONG-ARGUMENT."
  (check-argument counterpart fork
                  (and (simulation-p fork) (or (fork-p fork) (simulation-line fork)))
                  "a fork, as FORK-SIMULATION returns, or a run that was rewound")
  (call-inside (latest fork) (lambda () (counterpart-here object))))
