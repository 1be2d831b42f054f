;;;; operands.lisp -- what operations take, seen as bounds: a number is [x, x], a point a box.

(in-package :ars-magna.geometry)

;;; Every operation takes operands of one dimension: spans (numbers and intervals) or regions
;;; (points and point intervals). Mixing an element with an interval lifts the element, which
;;; costs nothing here: its lower and upper bounds are the same number (manual 3.2.1).

(deftype finite ()
  "The numbers that a double-float can stand for."
  '(and real (satisfies finite-p)))

(deftype span ()
  "What has one dimension."
  '(or finite interval))

(deftype region ()
  "What has two dimensions."
  '(or pt pt-interval))

(declaim (inline low high low-x high-x low-y high-y))

(defun low (span)
  (if (interval-p span) (%interval-min span) (double span)))

(defun high (span)
  (if (interval-p span) (%interval-max span) (double span)))

(defun low-x (region)
  (if (pt-p region) (%pt-x region) (%interval-min (%pt-interval-x region))))

(defun high-x (region)
  (if (pt-p region) (%pt-x region) (%interval-max (%pt-interval-x region))))

(defun low-y (region)
  (if (pt-p region) (%pt-y region) (%interval-min (%pt-interval-y region))))

(defun high-y (region)
  (if (pt-p region) (%pt-y region) (%interval-max (%pt-interval-y region))))

(defun reject-operand (operator name value expected)
  "Signal WRONG-ARGUMENT: OPERATOR takes, as its operand NAME, no VALUE but what EXPECTED says."
  (reject-argument operator name value
                   (if (and (realp value) (not (finite-p value))) +finite-text+ expected)))

(defmacro dispatch (operator operands expected &body clauses)
  "Evaluate the first of CLAUSES, ((TYPE...) FORM...), whose types the variables OPERANDS have.
If there is none, or the result is too large, signal WRONG-ARGUMENT: OPERATOR takes what EXPECTED
says in words."
  (flet ((test (types)
           `(and ,@(loop for operand in operands
                         for type in types
                         collect `(typep ,operand ',type))))
         (refuse (operand)
           `(reject-operand ',operator ',operand ,operand ,expected)))
    `(within-floats (,operator ,(first (last operands)))
       (cond ,@(loop for (types . forms) in clauses
                     collect `(,(test types) ,@forms))
             ,@(loop for operand in operands
                     for place from 0
                     for types = (loop for (types) in clauses collect (nth place types))
                     collect `((not (typep ,operand '(or ,@types))) ,(refuse operand)))
             ;; Each could be right alone; then the last does not suit the others.
             (t ,(refuse (first (last operands))))))))
