;;;; blueprint.lisp -- what DEFROBOT says of a robot, and the registry of that (manual 5.2).

(in-package :ars-magna.robot)

(export '(all-blueprints blueprint *robots* find-blueprint))

;;; A blueprint is fixed once DEFROBOT has read it; any number of robots can be made by it, each in
;;; a world of its own.

(define-record blueprint
  "What DEFROBOT said of a robot."
  (name nil symbol "the name of the robot" :export)
  (map nil symbol "the name of the map that the robot starts in" :export)
  (x 0d0 double-float "the x coordinate where the robot starts, in metres" :export)
  (y 0d0 double-float "the y coordinate where the robot starts, in metres" :export)
  (angle 0d0 double-float "the heading with which the robot starts, in radians" :export)
  (parts '() list "a list (kind initarg value ...) for each of its parts" :export))

(defmethod print-object ((blueprint blueprint) stream)
  (print-unreadable-object (blueprint stream :type t) (princ (blueprint-name blueprint) stream)))

(defmethod reference ((blueprint blueprint))
  (list :blueprint (name-string (blueprint-name blueprint))))

(define-registry robot "robot" :object-p blueprint-p :by-symbol t
  :finder find-blueprint :lister all-blueprints :internal t)

(define-shared blueprint)
