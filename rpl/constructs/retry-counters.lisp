;;;; retry-counters.lisp -- how often a handler may retry.

(in-package :ars-magna.rpl.constructs)

(define-construct with-retry-counters (counters &body body)
  "Run BODY in a plan with COUNTERS, each (name number), for DO-RETRY."
  (:in-lisp `(let ,counters ,@body)))

(define-construct do-retry (counter &body body)
  "In a handler: run BODY, most likely (retry), if COUNTER is positive, and count it down."
  (:in-lisp `(when (plusp ,counter)
               (decf ,counter)
               ,@body)))
