;;;; package.lisp -- the statistics layer: numbers in, numbers out; it knows no experiment.

(ars-magna.host:define-package :ars-magna.statistics
  (:documentation "Intervals, tests and survival curves. What a user would call is marked; averages
and the like are for other layers only, since users have their own by those names.")
  (:use :cl :ars-magna.host :ars-magna.basics :ars-magna.definitions :ars-magna.copying))
