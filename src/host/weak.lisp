;;;; weak.lisp -- knowing of something without keeping it from being forgotten.

(in-package :ars-magna.host)

(export '(make-weak weak-value))

(defun make-weak (object)
  "Return what leads to OBJECT as long as anything else does."
  (sb-ext:make-weak-pointer object))

(defun weak-value (weak)
  "Return the object that WEAK, which MAKE-WEAK has returned, leads to, or NIL if it is gone."
  (values (sb-ext:weak-pointer-value weak)))
