;;;; instances.lisp -- the slots of structures and conditions by number: the quick way through them.

(in-package :ars-magna.host)

(export '(reference-slots layout-of layout-number instance-slot copy-condition))

;;; Layouts were called wrappers in SBCL 2.2.

(defun immediate-type-p (type)
  "True if what is of TYPE is never altered, and refers to nothing."
  (subtypep type '(or number symbol string character package)))

(declaim (inline layout-of layout-number instance-slot (setf instance-slot)))
(defun layout-of (object)
  "Return what is the same object for all structures that have their slots in the same places."
  (internal (:sb-kernel #:%instance-wrapper #:%instance-layout) object))

(defun layout-number (layout)
  "Return a number that LAYOUT has, and few others."
  (internal (:sb-kernel #:wrapper-clos-hash #:layout-clos-hash) layout))

(defun instance-slot (object index)
  "Return what is in the slot number INDEX of the structure or condition OBJECT. Can be set."
  (internal (:sb-kernel #:%instance-ref) object index))

(defun (setf instance-slot) (value object index)
  (setf (internal (:sb-kernel #:%instance-ref) object index) value))

(defun reference-slots (object)
  "Return a list (index . name) for each slot of the structure OBJECT that may refer to something."
  (loop for slot in (internal (:sb-kernel #:dd-slots)
                              (internal (:sb-kernel #:wrapper-info #:layout-info)
                                        (layout-of object)))
        when (and (eq t (internal (:sb-kernel #:dsd-raw-type) slot))
                  (not (immediate-type-p (internal (:sb-kernel #:dsd-type) slot))))
          collect (cons (internal (:sb-kernel #:dsd-index) slot)
                        (internal (:sb-kernel #:dsd-name) slot))))

(defun copy-condition (condition)
  "Return a new condition like CONDITION, and a list of the numbers of its slots."
  (let* ((length (internal (:sb-kernel #:%instance-length) condition))
         (copy (internal (:sb-kernel #:%make-instance) length))
         (indices (loop for index from (internal-value :sb-vm #:instance-data-start) below length
                        collect index)))
    (setf (internal (:sb-kernel #:%instance-wrapper #:%instance-layout) copy) (layout-of condition))
    (dolist (index indices)
      (setf (instance-slot copy index) (instance-slot condition index)))
    (values copy indices)))
