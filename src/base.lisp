;;;; base.lisp -- the package in which programs find what the lowest four layers have.

(uiop:define-package :ars-magna.base
  (:documentation "Names for programs that add kinds of objects, parameters or commands. The layers
of the simulator use the four packages of which this one consists.")
  (:use-reexport :ars-magna.host :ars-magna.basics :ars-magna.definitions :ars-magna.copying))
