;;;; copying.lisp -- objects of a run, copied into another that goes on by itself.

(in-package :ars-magna.base)

;;; A copy has a table from what has been copied to what it was copied to: two objects that refer
;;; to the same one do so in the copy. Functions, and what has a reference but no kind, such as maps
;;; and commands, are shared. The :LINKs of a copy are as those of a new object.

(defun make-copy-table ()
  "Return a table for COPY-RUNNING in which nothing has been copied."
  (make-hash-table :test 'eq))

(defgeneric copy-running (value table)
  (:documentation
   "Return VALUE as another run is to have it. TABLE has what was copied so far, by what it was
copied from. Objects of a kind, structures of a user's, lists, arrays and tables are copied; the
rest is shared.")
  (:method (value table) (declare (ignore table)) value)
  (:method ((value cons) table) (copy-list-running value table))
  (:method ((value dice) table) (copied value table (copy-dice value)))
  (:method ((value array) table) (copy-array-running value table))
  (:method ((value hash-table) table) (copy-table-running value table))
  (:method ((value structure-object) table)
    (cond ((gethash value table))
          ((kind-of value) (copy-by-kind value table))
          ((reference value) value)
          (t (copy-structure-running value table)))))

(defun copied (value table copy)
  "Note in TABLE that VALUE was copied to COPY, unless it has been before. Return its copy."
  (or (gethash value table)
      (setf (gethash value table) copy)))

(defun copy-by-kind (object table)
  "Return a new copy of OBJECT, of a kind, for COPY-RUNNING."
  (let ((copy (copied object table (copy-structure object))))
    (dolist (slot (kind-slots (kind-of object)) copy)
      (let* ((old (slot-content slot object))
             (new (if (eq :link (kind-slot-role slot))
                      (funcall (kind-slot-initial slot))
                      (copy-running old table))))
        (unless (eql old new) (funcall (kind-slot-writer slot) new copy))))))

(defun copy-structure-running (object table)
  "Return a copy of OBJECT, a structure without a kind, and of what is in it."
  (let ((copy (copied object table (copy-structure object))))
    (dolist (slot (class-slot-names (class-of object)) copy)
      (let* ((old (slot-value object slot)) (new (copy-running old table)))
        (unless (eql old new) (setf (slot-value copy slot) new))))))

(defun copy-list-running (list table)
  "Return a copy of LIST, perhaps dotted or circular, and of what is in it."
  (or (gethash list table)
      (let* ((first (copied list table (cons nil nil))) (last first))
        (setf (car first) (copy-running (car list) table))
        (loop for tail = (cdr list) then (cdr tail)
              while (and (consp tail) (null (gethash tail table)))
              do (let ((new (copied tail table (cons nil nil))))
                   (setf (cdr last) new
                         last new
                         (car new) (copy-running (car tail) table)))
              finally (setf (cdr last) (copy-running tail table)))
        first)))

(defun copy-array-running (array table)
  "Return a copy of ARRAY, and of what is in it."
  (or (gethash array table)
      (let ((copy (copied array table (array-like array))))
        (dotimes (i (array-total-size array) copy)
          (setf (row-major-aref copy i) (copy-running (row-major-aref array i) table))))))

(defun array-like (array)
  "Return an array like ARRAY, for other things to be put into."
  (if (simple-array-p array)
      (make-array (array-dimensions array) :element-type (array-element-type array))
      (make-array (array-dimensions array)
                  :element-type (array-element-type array) :adjustable t
                  :fill-pointer (and (array-has-fill-pointer-p array) (fill-pointer array)))))

(defun simple-array-p (array)
  (typep array 'simple-array))

(defun copy-table-running (hash-table table)
  (or (gethash hash-table table)
      (let ((copy (copied hash-table table
                          (make-hash-table :test (hash-table-test hash-table)))))
        (maphash (lambda (key value)
                   (setf (gethash (copy-running key table) copy) (copy-running value table)))
                 hash-table)
        copy)))
