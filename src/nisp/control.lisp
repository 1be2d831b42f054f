;;;; control.lisp -- Nisp's IF and LOOP, assignment, vectors, and doing nothing.

(in-package :ars-magna.nisp)

;;; From here on IF and LOOP mean ours in this package; both expand to Common Lisp's at once.

(eval-when (:compile-toplevel :load-toplevel :execute)
  (defun doubt-test (operator test)
    "Warn if TEST, of OPERATOR in Lisp code, is not what is meant."
    (cl:let ((doubt (test-doubt test)))
      (when doubt (doubt-definition "~(~A~): ~A" operator doubt)))))

(public if)
(defmacro if (test then &rest else)
  "Evaluate THEN if TEST is true, otherwise the forms ELSE, of which there may be any number
(manual, Figure D.5; reading 40)."
  (doubt-test 'if test)
  `(cl:if ,test ,then ,@(cl:if (rest else) `((progn ,@else)) else)))

(eval-when (:compile-toplevel :load-toplevel :execute)
  (defun loop-keyword (forms)
    "Return :UNTIL or :WHILE if FORMS, of a loop, begin with that word."
    (and (symbolp (first forms))
         (find (first forms) '(:until :while) :test #'string=))))

(public loop)
(defmacro loop (&rest forms)
  "Evaluate the body forms again and again: (loop UNTIL test body...) until the test is true
before a round, (loop WHILE test body...) while it is. Other FORMS mean what they mean to CL:LOOP
(manual, Figure D.3)."
  (cl:let ((keyword (loop-keyword forms)))
    (when keyword (doubt-test 'loop (second forms)))
    ;; What follows the test is no keyword of Lisp's LOOP.
    (if (and keyword (consp (third forms)))
        `(cl:loop ,keyword ,(second forms) :do (progn ,@(cddr forms)))
        `(cl:loop ,@forms))))

(public !=)
(defmacro != (place value &rest more)
  "Set PLACE to VALUE, and so on through MORE pairs: SETF (manual 3.1; reading 14)."
  `(setf ,place ,value ,@more))

(public nop)
(defun nop ()
  "Do nothing, but let other threads run meanwhile. Return nothing (manual, Figure D.3)."
  (yield-thread)
  (values))

;;; Vectors.

(defun check-vref (vector index)
  (check-argument vref vector (typep vector 'sequence) "a vector or a list")
  (check-argument vref index (and (integerp index) (< -1 index (length vector)))
                  (format nil "the index of one of ~D elements, from 0" (length vector))))

(public vref)
(settable vref)
(defun vref (vector index)
  "Return the element of VECTOR (a vector or a list) at INDEX, counted from 0. Can be set
(manual 3.1.3)."
  (check-vref vector index)
  (elt vector index))

(defun (setf vref) (value vector index)
  (check-vref vector index)
  (setf (elt vector index) value))
