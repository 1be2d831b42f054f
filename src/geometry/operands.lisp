;;;; operands.lisp -- what operations take, seen as bounds: a number is [x, x], a point a box.

(in-package :ars-magna.geometry)

;;; Every operation takes operands of one dimension: spans (numbers and intervals) or regions
;;; (points and point intervals). Mixing an element with an interval lifts the element, which
;;; costs nothing here: its lower and upper bounds are the same number (manual 3.2.1).

(deftype span ()
  "What has one dimension."
  '(or real interval))

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

(defmacro dispatch (operator operands expected &body clauses)
  "Evaluate the first of CLAUSES, ((TYPE...) FORM...), whose types the variables OPERANDS have.
If there is none, signal WRONG-ARGUMENT: OPERATOR takes what EXPECTED says in words."
  (flet ((test (types)
           `(and ,@(loop for operand in operands
                         for type in types
                         collect `(typep ,operand ',type)))))
    `(cond ,@(loop for (types . forms) in clauses
                   collect `(,(test types) ,@forms))
           (t ,@(loop for operand in operands
                      for place from 0
                      for types = (loop for (types) in clauses collect (nth place types))
                      collect `(check-argument ,operator ,operand
                                               (typep ,operand '(or ,@types)) ,expected))
              ;; Each could be right alone; then the last does not suit the others.
              (check-argument ,operator ,(first (last operands)) nil ,expected)))))
