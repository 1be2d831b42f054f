;;;; wrapping.lisp -- doing more in a function of SBCL's than it does.

(in-package :ars-magna.base)

(defun wrap-function (name wrapper)
  "Let WRAPPER be called instead of SBCL's function NAME, with that and its arguments."
  (sb-int:encapsulate name 'ars-magna wrapper))
