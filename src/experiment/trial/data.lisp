;;;; data.lisp -- values of any kind that are data, and a number for what they are.

(in-package :ars-magna.experiment)

(defconstant +deepest-data+ 50 "How deep data stand in data at most.")
(defconstant +largest-data+ 1000000 "How many parts data have at most.")

(defun plain-structure-p (value)
  "True if VALUE is of a user's DEFSTRUCT; not a fluent, thing or the like."
  (and (typep value 'structure-object)
       (null (kind-of value))
       (users-symbol-p (type-of value))))

(defun structure-values (structure)
  "Return what the slots of STRUCTURE hold, a list."
  (loop for slot in (class-slot-names (class-of structure))
        collect (slot-value structure slot)))

(defun table-entries (table)
  "Return lists (key value) of the hash TABLE."
  (loop for key being the hash-keys of table using (hash-value value)
        collect (list key value)))

;; What is in a weak table depends on when memory is tidied.
(defun lasting-table-p (value)
  (and (hash-table-p value) (not (weak-table-p value))))

(defun data-p (value)
  "True if VALUE is made of numbers, names, characters, strings, paths, conses, arrays, hash tables
and users' structures alone, and is of a bounded size."
  (let ((left +largest-data+))
    (labels ((visit (value depth)
               (when (or (> depth +deepest-data+) (minusp (decf left)))
                 (return-from data-p nil))
               (typecase value
                 ((or number symbol character string bit-vector pathname))
                 (cons (loop while (consp value)
                             do (visit (pop value) (1+ depth))
                                (when (minusp (decf left)) (return-from data-p nil)))
                       (visit value (1+ depth)))
                 (array (dotimes (index (array-total-size value))
                          (visit (row-major-aref value index) (1+ depth))))
                 ((satisfies lasting-table-p) (visit (table-entries value) (1+ depth)))
                 ((satisfies plain-structure-p) (visit (structure-values value) (1+ depth)))
                 (t (return-from data-p nil)))))
      (visit value 0)
      t)))

;;; Tables and structures are written as lists. All else is written as it is.

(defun written-table (table)
  "Return a list for the hash TABLE, the same whatever was entered first."
  (list* :table (hash-table-test table)
         (mapcar #'cdr (sort (loop for entry in (mapcar #'written (table-entries table))
                                   collect (cons (prin1-to-string entry) entry))
                             #'string< :key #'car))))

(defun written-array (array)
  "Return an array like ARRAY, with what is to be written of its elements."
  (let ((copy (make-array (array-dimensions array)
                          :fill-pointer (and (array-has-fill-pointer-p array)
                                             (fill-pointer array)))))
    (dotimes (index (array-total-size array) copy)
      (setf (row-major-aref copy index) (written (row-major-aref array index))))))

(defun written-list (list)
  (loop with rest = list
        while (consp rest)
        collect (written (pop rest)) into parts
        finally (return (nconc parts (written rest)))))

(defun written (value)
  "Return what is to be written of VALUE, which is data: lists in place of tables and structures."
  (typecase value
    (cons (written-list value))
    ((array t) (written-array value))
    (hash-table (written-table value))
    (structure-object (if (plain-structure-p value)
                          (list* :structure (type-of value) (written (structure-values value)))
                          value))
    (t value)))

(defun data-number (value)
  "Return a number for VALUE, which is data: for its text, with the packages of names."
  (call-in-peace (lambda ()
                   (text-checksum (prin1-to-string (if (data-p value) (written value) value))))
                 (find-package :keyword)))

(defun no-data-p (value)
  "True if VALUE is NIL or an empty hash table, as often stands where data are to be kept later."
  (or (null value) (and (hash-table-p value) (zerop (hash-table-count value)))))
