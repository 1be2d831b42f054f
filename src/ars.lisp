;;;; ars.lisp -- the packages ARS and NISP: every name that the manual has, and our additions.

(in-package :ars-magna.faces)

;;; What they export is marked where it is defined, by PUBLIC and ADDITION. The system ARS-MAGNA
;;; marks more than its core: see src/all.lisp.

(fill-faces)

(define-user-package :ars-user
  (:documentation "The package to work in: Common Lisp, ARS and NISP; XLIB is our canvas. What is
defined in it is the user's."))

;;; What is defined from here on is the users'.
(lock-packages)
