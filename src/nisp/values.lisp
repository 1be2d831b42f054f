;;;; values.lisp -- points and intervals as Nisp types (manual 3.2.1).

(in-package :ars-magna.nisp)

(define-nisp-type pt (x y) #'make-pt
  "A point or vector in the plane.")
(define-nisp-slot pt x pt-x (setf pt-x))
(define-nisp-slot pt y pt-y (setf pt-y))

(define-nisp-type interval (min max) #'make-interval
  "A number known to be between two others.")
(define-nisp-slot interval min interval-min (setf interval-min))
(define-nisp-slot interval max interval-max (setf interval-max))

(define-nisp-type pt-interval (a b) #'make-pt-interval
  "A box, by its two intervals or by two opposite corners.")
(define-nisp-slot pt-interval x pt-interval-x (setf pt-interval-x))
(define-nisp-slot pt-interval y pt-interval-y (setf pt-interval-y))
(define-nisp-slot pt-interval dx pt-interval-dx)
(define-nisp-slot pt-interval dy pt-interval-dy)
