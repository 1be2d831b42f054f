;;;; data.lisp -- values of any kind that are data, and a number for what they are.

(in-package :ars-magna.experiment)

(defconstant +deepest-data+ 50 "How deep data stand in data at most.")
(defconstant +largest-data+ 1000000 "How many parts data have at most.")

(defun data-p (value)
  "True if VALUE is made of numbers, names, characters, strings, paths, conses and arrays alone, and
is of a bounded size."
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
                 (t (return-from data-p nil)))))
      (visit value 0)
      t)))

(defun data-number (value)
  "Return a number for VALUE, which is data: for its text, with the packages of names."
  (call-in-peace (lambda () (text-checksum (prin1-to-string value)))
                 (find-package :keyword)))

(defun own-copy (value)
  "Return VALUE, or a copy of it if it is data that could be changed in place."
  (cond ((not (data-p value)) value)
        ((consp value) (copy-tree value))
        ((vectorp value) (copy-seq value))
        (t value)))
