;;;; facts.lisp -- what people want to know of an experiment.

(in-package :ars-magna.experiment)

(define-facts (experiment experiment)
  "Robots" (listed (experiment-robots experiment))
  "Varies" (listed (factor-names experiment))
  "Conditions" (length (experiment-conditions experiment))
  "Trials of each" (experiment-trials experiment)
  "Ends at tick" (experiment-limit experiment)
  "Measures" (listed (mapcar #'first (experiment-measures experiment)))
  "Each tick" (listed (mapcar #'first (experiment-series experiment))))
