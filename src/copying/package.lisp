;;;; package.lisp -- the layer of copying: the state of objects, copied, digested, written down.

(ars-magna.host:define-package :ars-magna.copying
  (:documentation "Copies and digests of objects, by the roles of their slots.")
  (:use :cl :ars-magna.host :ars-magna.basics :ars-magna.definitions))
