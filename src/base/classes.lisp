;;;; classes.lisp -- what classes are made of: the one door to closer-mop.

(in-package :ars-magna.base)

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

(defun method-function (method)
  "Return the function that METHOD has by the protocol: one around its code, perhaps."
  (closer-mop:method-function method))

(defun class-ancestors (class)
  "Return a list of CLASS and those it inherits from, those that are more special first."
  (closer-mop:class-precedence-list (closer-mop:ensure-finalized class)))

(defun class-slot-names (class)
  "Return the names, symbols, of the slots of objects of CLASS."
  (mapcar #'closer-mop:slot-definition-name (closer-mop:class-slots class)))
