;;;; package.lisp -- the statistics layer: functions of numbers, independent of experiments.

(ars-magna.host:define-package :ars-magna.statistics
  (:documentation "Intervals, tests and survival curves. Functions for users are marked ADDITION.
MEAN, MEDIAN and similar functions are for other layers only, as users often define these names.")
  (:use :cl :ars-magna.host :ars-magna.basics :ars-magna.definitions :ars-magna.copying))
