;;;; wrapping.lisp -- doing more in a function of SBCL's, or a library's, than it does.

(in-package :ars-magna.base)

(defun wrap-function (name wrapper)
  "Let WRAPPER be called instead of the function NAME, which is not ours, with that and its
arguments."
  (sb-int:encapsulate name 'ars-magna wrapper))
