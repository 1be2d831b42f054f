;;;; instances.lisp -- the slots of structures and conditions by number: the quick way through them.

(in-package :ars-magna.base)

(defun immediate-type-p (type)
  "True if what is of TYPE is never altered, and refers to nothing."
  (subtypep type '(or number symbol string character package)))

(defun reference-slots (object)
  "Return a list (index . name) for each slot of the structure OBJECT that may refer to something."
  (loop for slot in (sb-kernel:dd-slots
                     (sb-kernel:wrapper-info (sb-kernel:%instance-wrapper object)))
        when (and (eq t (sb-kernel:dsd-raw-type slot))
                  (not (immediate-type-p (sb-kernel:dsd-type slot))))
          collect (cons (sb-kernel:dsd-index slot) (sb-kernel:dsd-name slot))))

(declaim (inline layout-of layout-number instance-slot (setf instance-slot)))
(defun layout-of (object)
  "Return what is the same object for all structures that have their slots in the same places."
  (sb-kernel:%instance-wrapper object))

(defun layout-number (layout)
  "Return a number that LAYOUT has, and few others."
  (sb-kernel:wrapper-clos-hash layout))

(defun instance-slot (object index)
  "Return what is in the slot number INDEX of the structure or condition OBJECT. Can be set."
  (sb-kernel:%instance-ref object index))

(defun (setf instance-slot) (value object index)
  (setf (sb-kernel:%instance-ref object index) value))

(defun copy-condition (condition)
  "Return a new condition like CONDITION, and a list of the numbers of its slots."
  (let* ((length (sb-kernel:%instance-length condition))
         (copy (sb-kernel:%make-instance length))
         (indices (loop for index from sb-vm:instance-data-start below length collect index)))
    (setf (sb-kernel:%instance-wrapper copy) (sb-kernel:%instance-wrapper condition))
    (dolist (index indices)
      (setf (instance-slot copy index) (instance-slot condition index)))
    (values copy indices)))
