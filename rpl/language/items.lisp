;;;; items.lisp -- what a construct goes through, looked at once when that begins.

(in-package :ars-magna.rpl.language)

(export '(item-list))

(defun item-list (operator sequence)
  "Return the elements of SEQUENCE, which OPERATOR goes through, in a list. Signals WRONG-ARGUMENT
unless it is a vector or a list that ends."
  (unless (typep sequence '(and sequence (or (not list) (satisfies proper-list-p))))
    (reject-argument operator 'sequence sequence "a vector, or a list that ends"))
  (coerce sequence 'list))

(defun whole-list (operator list)
  "Return LIST, which OPERATOR goes through. Signals WRONG-ARGUMENT unless it is a list that ends."
  (unless (proper-list-p list)
    (reject-argument operator 'list list "a list that ends"))
  list)
