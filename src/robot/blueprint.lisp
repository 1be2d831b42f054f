;;;; blueprint.lisp -- what DEFROBOT says of a robot, and the registry of that (manual 5.2).

(in-package :ars-magna.robot)

(export '(all-blueprints blueprint-x blueprint-y blueprint blueprint-name blueprint-map
          blueprint-angle blueprint-cameras blueprint-hands blueprint-bins blueprint-parts
          *robots* find-blueprint))

;;; A blueprint is fixed once DEFROBOT has read it; any number of robots can be made by it, each in
;;; a world of its own.

(defstruct (blueprint (:copier nil))
  "What DEFROBOT said of a robot."
  (name nil :type symbol :read-only t)
  (map nil :type symbol :read-only t)
  (x 0d0 :type double-float :read-only t)
  (y 0d0 :type double-float :read-only t)
  (angle 0d0 :type double-float :read-only t)
  (cameras '() :type list :read-only t)
  (hands '() :type list :read-only t)
  (bins '() :type list :read-only t)
  ;; Of other kinds: lists (kind initarg value ...).
  (parts '() :type list :read-only t))

(document-functions
  blueprint-name "Return the name of the robot."
  blueprint-map "Return the name of the map that the robot starts in."
  blueprint-x "Return the x coordinate where the robot starts, in metres."
  blueprint-y "Return the y coordinate where the robot starts, in metres."
  blueprint-angle "Return the heading with which the robot starts, in radians."
  blueprint-cameras "Return a list (field-of-view resolution) for each of its cameras."
  blueprint-hands "Return the strength of each of its hands, in a list."
  blueprint-bins "Return the capacity of each of its bins, in a list."
  blueprint-parts "Return a list (kind initarg value ...) for each part of a kind of one's own.")

(defmethod print-object ((blueprint blueprint) stream)
  (print-unreadable-object (blueprint stream :type t) (princ (blueprint-name blueprint) stream)))

(defmethod reference ((blueprint blueprint))
  (list :blueprint (name-string (blueprint-name blueprint))))

(define-registry robot "robot" :object-p blueprint-p :by-symbol t
  :finder find-blueprint :lister all-blueprints :internal t)

(define-shared blueprint)
