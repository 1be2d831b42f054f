;;;; holding.lisp -- whether data have something in them.

(in-package :ars-magna.copying)

(export '(holds-p closed-over))

;;; For messages that name where something was found. What belongs to a run, such as tasks and
;;; robots, is not looked into: from there one gets everywhere.

(defun contents-of (object)
  (typecase object
    (cons (list (car object) (cdr object)))
    (hash-table (loop for key being the hash-keys of object using (hash-value value)
                      collect key collect value))
    (array (if (eq t (array-element-type object))
               (loop for index below (array-total-size object)
                     collect (row-major-aref object index))
               '()))
    (function (if (closure-p object) (closure-values object) '()))
    (structure-object (if (eq :copy (manner-way (manner object)))
                          (loop for (index) in (reference-slots object)
                                collect (instance-slot object index))
                          '()))
    (standard-object (loop for slot in (instance-slot-names (class-of object))
                           when (slot-boundp object slot) collect (slot-value object slot)))
    (t (if (value-cell-p object) (list (cell-value object)) '()))))

(defun holds-p (object value)
  "True if VALUE is OBJECT, or in it: in a list, array, table, closure, structure or instance."
  (let ((seen (make-hash-table :test 'eq)) (work (list object)))
    (loop while work
          do (let ((each (pop work)))
               (when (eq each value) (return t))
               (unless (or (typep each '(or symbol number character)) (gethash each seen))
                 (setf (gethash each seen) t
                       work (append (contents-of each) work)))))))

(defun closed-over (function)
  "Return a list of what FUNCTION, if it is a closure, has closed over: of variables, their values."
  (when (closure-p function)
    (loop for value in (closure-values function)
          collect (if (and (value-cell-p value) (not (exit-cell-p value)))
                      (cell-value value)
                      value))))
