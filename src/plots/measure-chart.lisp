;;;; measure-chart.lisp -- to come.

(in-package :ars-magna.plots)
