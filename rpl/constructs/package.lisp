;;;; package.lisp -- what the plan language has beyond Lisp: a file for each idea.

(defpackage :ars-magna.rpl.constructs
  (:documentation "The constructs of RPL (manual, appendices C and D). Each is one form,
DEFINE-CONSTRUCT, which also exports its name.")
  (:use :cl :ars-magna.base :ars-magna.rpl.fluents :ars-magna.rpl.tasks
        :ars-magna.rpl.language)
  ;; valve
  (:export #:claim-p #:claim-valves #:make-valve #:valve #:valve-losers #:valve-name #:valve-owner
           #:valve-p #:valve-requests)
  ;; task-variables
  (:export #:define-task-variable)
  ;; deadline
  (:export #:deadline-missed #:deadline-missed-ticks))
