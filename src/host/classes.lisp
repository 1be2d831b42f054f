;;;; classes.lisp -- classes and slots; slots by number. The only file that uses closer-mop.

(in-package :ars-magna.host)

(export '(define-generic-function-class generic-name class-and-ancestors class-slot-names
           methods-on-class
          methods-of-generic class-slot-types per-instance-slot-names reference-slots layout-of
          layout-hash instance-slot copy-condition))

(defmacro define-generic-function-class (name documentation)
  "Define NAME, a class of generic functions, with DOCUMENTATION."
  `(defclass ,name (standard-generic-function)
     ()
     (:metaclass closer-mop:funcallable-standard-class)
     (:documentation ,documentation)))

(defun generic-name (function)
  "Return the name of the generic function FUNCTION: a symbol or (SETF symbol)."
  (closer-mop:generic-function-name function))

(defun methods-of-generic (function)
  "Return a list of the methods of the generic function FUNCTION."
  (closer-mop:generic-function-methods function))

(defun methods-on-class (name)
  "Return a list of all methods that specialize on the class NAME; NIL if there is none."
  (let ((class (find-class name nil)))
    (and class (closer-mop:specializer-direct-methods class))))

(defun class-and-ancestors (class)
  "Return a list of CLASS and its superclasses, the most specific first."
  (closer-mop:class-precedence-list (closer-mop:ensure-finalized class)))

(defun class-slot-names (class)
  "Return a list of the names, symbols, of the slots of CLASS."
  (mapcar #'closer-mop:slot-definition-name (closer-mop:class-slots class)))

(defun class-slot-types (class)
  "Return a list (name type) for each slot of objects of CLASS."
  (mapcar (lambda (slot)
            (list (closer-mop:slot-definition-name slot) (closer-mop:slot-definition-type slot)))
          (closer-mop:class-slots class)))

(defun per-instance-slot-names (class)
  "Return the names of the slots of CLASS that are not shared by its instances."
  (mapcar #'closer-mop:slot-definition-name
          (remove :instance (closer-mop:class-slots class)
                  :key #'closer-mop:slot-definition-allocation :test-not #'eq)))

;;;; The slots of structures and conditions by number

;;; Layouts were called wrappers in SBCL 2.2.

(declaim (inline layout-of layout-hash instance-slot (setf instance-slot)))
(defun layout-of (object)
  "Return the layout of the structure OBJECT. All structures of a type have the same layout."
  (internal (:sb-kernel #:%instance-wrapper #:%instance-layout) object))

(defun layout-hash (layout)
  "Return a hash number of LAYOUT. Few other layouts have the same number."
  (internal (:sb-kernel #:wrapper-clos-hash #:layout-clos-hash) layout))

(defun instance-slot (object index)
  "Return the value of slot number INDEX of OBJECT, a structure or condition. Can be set."
  (internal (:sb-kernel #:%instance-ref) object index))

(defun (setf instance-slot) (value object index)
  (setf (internal (:sb-kernel #:%instance-ref) object index) value))

(defun reference-slots (object)
  "Return a list (index . name) for each slot of the structure OBJECT that can hold a reference."
  (loop for slot in (internal (:sb-kernel #:dd-slots)
                              (internal (:sb-kernel #:wrapper-info #:layout-info)
                                        (layout-of object)))
        when (and (eq t (internal (:sb-kernel #:dsd-raw-type) slot))
                  (not (subtypep (internal (:sb-kernel #:dsd-type) slot)
                                 '(or number symbol string character package))))
          collect (cons (internal (:sb-kernel #:dsd-index) slot)
                        (internal (:sb-kernel #:dsd-name) slot))))

(defun copy-condition (condition)
  "Return a copy of CONDITION, and a list of the numbers of its slots."
  (let* ((length (internal (:sb-kernel #:%instance-length) condition))
         (copy (internal (:sb-kernel #:%make-instance) length))
         (indices (loop for index from (internal-value :sb-vm #:instance-data-start) below length
                        collect index)))
    (setf (internal (:sb-kernel #:%instance-wrapper #:%instance-layout) copy) (layout-of condition))
    (dolist (index indices)
      (setf (instance-slot copy index) (instance-slot condition index)))
    (values copy indices)))
