;;;; ars.lisp -- the packages ARS and NISP: every name that the manual has, and our additions.

(in-package :ars-magna.faces)

;;; What they export is marked where it is defined, by PUBLIC and ADDITION. The system ARS-MAGNA
;;; marks more than its core: see src/all.lisp.

(export-marked-names)

(define-user-package :ars-user
  (:documentation "The package to work in. It uses Common Lisp, ARS and NISP; XLIB is a nickname of
the simulator's canvas package. Definitions in this package belong to the user."))

;;; What is defined from here on is the users'.
(lock-packages)
