;;;; package.lisp -- the statistics layer: functions of numbers, independent of experiments.

(ars-magna.host:define-package :ars-magna.statistics
  (:documentation "Intervals, tests and survival curves. Functions for users are marked.
Averages and the like are for other layers only, as users often define functions of those names.")
  (:use :cl :ars-magna.host :ars-magna.basics :ars-magna.definitions :ars-magna.copying))
