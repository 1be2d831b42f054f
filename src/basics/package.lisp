;;;; package.lisp -- the lowest layer of our own: what every other layer stands on.

(ars-magna.host:define-package :ars-magna.basics
  (:documentation "Marks of public names; conditions, names, numbers, dice and texts.")
  (:use :cl :ars-magna.host))
