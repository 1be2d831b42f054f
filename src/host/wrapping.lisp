;;;; wrapping.lisp -- replacing a function of SBCL's or a library's by one that calls it.

(in-package :ars-magna.host)

(export '(wrap-function unwrap-function wrapped-p))

(defun wrap-function (name wrapper &optional (type 'ars-magna))
  "Call WRAPPER instead of the function NAME, which is not ours, with that function and its
arguments. A second wrapper of the same TYPE, a symbol, replaces the first."
  (internal (:sb-int #:encapsulate) name type wrapper))

(defun unwrap-function (name &optional (type 'ars-magna))
  "Undo WRAP-FUNCTION."
  (internal (:sb-int #:unencapsulate) name type))

(defun wrapped-p (name &optional (type 'ars-magna))
  "True if the function NAME has a wrapper of TYPE."
  (internal (:sb-int #:encapsulated-p) name type))
