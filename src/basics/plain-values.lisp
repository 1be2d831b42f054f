;;;; plain-values.lisp -- plain data: what journals, messages and run variables can contain.

(in-package :ars-magna.basics)

(export '(plain-datum-p plain-data-limits-text))

(defconstant +longest-plain-datum+ 10000
  "The most elements, characters and levels of nesting together in plain data.")
(defconstant +deepest-plain-datum+ 50 "The deepest nesting of lists and vectors in plain data.")
(defconstant +longest-plain-integer+ 3000 "The most bits of an integer in plain data.")

(defun plain-atom-p (atom)
  "True if ATOM is a number, symbol or character that a journal can contain."
  (typecase atom
    (integer (<= (integer-length atom) +longest-plain-integer+))
    (ratio (and (plain-atom-p (numerator atom)) (plain-atom-p (denominator atom))))
    (float (finite-p atom))
    (symbol (and (symbol-package atom) (not (search "::" (package-name (symbol-package atom))))))
    (character t)))

(defun plain-datum-p (datum &optional (also (constantly nil)))
  "True if DATUM is plain data: numbers, symbols, characters, strings, and proper lists and simple
vectors of these, of limited size; and objects for which the function ALSO returns true."
  (let ((left +longest-plain-datum+))
    (labels ((charge (count)
               (when (minusp (decf left count)) (return-from plain-datum-p nil)))
             (check (datum depth)
               (when (> depth +deepest-plain-datum+) (return-from plain-datum-p nil))
               (typecase datum
                 (null)
                 (cons (loop while (consp datum)
                             do (charge 1)
                                (check (pop datum) (1+ depth)))
                  (when datum (return-from plain-datum-p nil)))
                 (string (charge (length datum)))
                 (simple-vector (charge (length datum))
                  (loop for element across datum do (check element (1+ depth))))
                 (t (unless (or (plain-atom-p datum) (funcall also datum))
                      (return-from plain-datum-p nil))))))
      (check datum 1)
      t)))

(defun plain-data-limits-text ()
  "Return a text about the limits of plain data."
  (format nil "at most ~D elements and characters, nested at most ~D deep, lists without a ~
               dotted tail, simple vectors, finite numbers, symbols with a package"
          +longest-plain-datum+ +deepest-plain-datum+))
