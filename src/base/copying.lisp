;;;; copying.lisp -- objects of a run, copied into another that goes on by itself.

(in-package :ars-magna.base)

;;; A copy has a table from what has been copied to what it was copied to: two objects that refer
;;; to the same one do so in the copy. What has no kind, such as maps, commands and functions, is
;;; shared. The :LINKs of a copy are as those of a new object.

(defun make-copy-table ()
  "Return a table for COPY-RUNNING in which nothing has been copied."
  (make-hash-table :test 'eq))

(defgeneric copy-running (value table)
  (:documentation
   "Return VALUE as another run is to have it. TABLE has what was copied so far, by what it was
copied from. Objects of a kind, and lists, vectors and tables of them, are copied; the rest is
shared.")
  (:method (value table) (declare (ignore table)) value)
  (:method ((value cons) table) (copy-list-running value table))
  (:method ((value dice) table) (copied value table (copy-dice value)))
  (:method ((value string) table) (declare (ignore table)) value)
  (:method ((value vector) table) (copy-vector-running value table))
  (:method ((value hash-table) table) (copy-table-running value table))
  (:method ((value structure-object) table)
    (if (kind-of value)
        (or (gethash value table) (copy-by-kind value table))
        value)))

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

(defun copy-list-running (list table)
  "Return a copy of LIST, perhaps dotted; LIST itself if nothing in it is copied."
  (let ((changed nil) (copies '()) (tail list))
    (loop while (consp tail)
          do (let* ((old (pop tail)) (new (copy-running old table)))
               (unless (eq old new) (setf changed t))
               (push new copies)))
    (let ((end (copy-running tail table)))
      (if (and (not changed) (eq end tail))
          list
          (nreconc copies end)))))

(defun copy-vector-running (vector table)
  (or (gethash vector table)
      (let ((copy (if (array-has-fill-pointer-p vector)
                      (make-array (array-dimension vector 0)
                                  :adjustable t :fill-pointer (fill-pointer vector)
                                  :element-type (array-element-type vector)
                                  :initial-contents (whole-vector vector))
                      (copy-seq vector))))
        (copied vector table copy)
        (when (eq t (array-element-type vector))
          (dotimes (i (length copy))
            (setf (aref copy i) (copy-running (aref copy i) table))))
        copy)))

(defun whole-vector (vector)
  "Return what is in VECTOR, also behind its fill pointer, as a list."
  (loop for i below (array-dimension vector 0) collect (aref vector i)))

(defun copy-table-running (hash-table table)
  (let ((copy (make-hash-table :test (hash-table-test hash-table))))
    (maphash (lambda (key value)
               (setf (gethash (copy-running key table) copy) (copy-running value table)))
             hash-table)
    copy))
