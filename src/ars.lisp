;;;; ars.lisp -- the packages ARS and NISP: every name that the manual has, and our additions.

(in-package :ars-magna.faces)

;;; What they export is marked where it is defined, by PUBLIC and ADDITION.

(define-face :ars
  "The simulator as the manual describes it. It shadows CL:EQUAL and CL:MAP by extensions.")

(define-face :nisp
  "The Nisp dialect, which shadows CL:LET, CL:LOOP and CL:IF by extensions, and the plan language.")

(define-user-package :ars-user
  (:documentation "The package to work in: Common Lisp, ARS and NISP; XLIB is our canvas. What is
defined in it is the user's."))

;;; What is defined from here on is the users'.
(seal-definitions)
(lock-packages)
