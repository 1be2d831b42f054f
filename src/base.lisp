;;;; base.lisp -- the package in which programs find what the lowest four layers have.

(uiop:define-package :ars-magna.base
  (:documentation "Names for programs that add kinds of objects, parameters or commands. It exports
all names of the four lowest packages. The simulator's own layers use those packages.")
  (:use-reexport :ars-magna.host :ars-magna.basics :ars-magna.definitions :ars-magna.copying))
