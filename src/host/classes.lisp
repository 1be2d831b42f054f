;;;; classes.lisp -- what classes are made of: the one door to closer-mop.

(in-package :ars-magna.host)

(export '(define-function-class generic-name class-ancestors class-slot-names methods-on-class
          methods-of-generic class-slot-types instance-slot-names))

(defmacro define-function-class (name documentation)
  "Define the class NAME, of generic functions, with DOCUMENTATION."
  `(defclass ,name (standard-generic-function)
     ()
     (:metaclass closer-mop:funcallable-standard-class)
     (:documentation ,documentation)))

(defun generic-name (function)
  "Return the name of the generic FUNCTION, a symbol or (SETF symbol)."
  (closer-mop:generic-function-name function))

(defun methods-of-generic (function)
  "Return a list of the methods of the generic FUNCTION."
  (closer-mop:generic-function-methods function))

(defun methods-on-class (name)
  "Return a list of the methods, of whatever generic functions, that are for objects of the class
called NAME, if there is one."
  (let ((class (find-class name nil)))
    (and class (closer-mop:specializer-direct-methods class))))

(defun class-ancestors (class)
  "Return a list of CLASS and those it inherits from, those that are more special first."
  (closer-mop:class-precedence-list (closer-mop:ensure-finalized class)))

(defun class-slot-names (class)
  "Return the names, symbols, of the slots of objects of CLASS."
  (mapcar #'closer-mop:slot-definition-name (closer-mop:class-slots class)))

(defun class-slot-types (class)
  "Return a list (name type) for each slot of objects of CLASS."
  (mapcar (lambda (slot)
            (list (closer-mop:slot-definition-name slot) (closer-mop:slot-definition-type slot)))
          (closer-mop:class-slots class)))

(defun instance-slot-names (class)
  "Return the names of the slots that each object of CLASS has to itself."
  (mapcar #'closer-mop:slot-definition-name
          (remove :instance (closer-mop:class-slots class)
                  :key #'closer-mop:slot-definition-allocation :test-not #'eq)))
