;;;; package.lisp -- what the plan language has beyond Lisp: a file for each idea.

(defpackage :ars-magna.rpl.constructs
  (:documentation "The constructs of RPL (manual, appendices C and D). Each is one form, DEFINE-CONSTRUCT.")
  (:use :cl :ars-magna.base :ars-magna.rpl.fluents :ars-magna.rpl.tasks
        :ars-magna.rpl.language)
  ;; whenever
  (:export #:whenever)
  ;; handling
  (:export #:do-retry #:handle-failure #:retry #:with-failure-handling #:with-retry-counters)
  ;; trying
  (:export #:try-each-in-order #:try-in-order #:try-one)
  ;; protecting
  (:export #:evap-protect)
  ;; parallel
  (:export #:par #:par-loop #:pursue #:try-all)
  ;; policy
  (:export #:with-policy)
  ;; blocking
  (:export #:with-task-blocked)
  ;; ordering
  (:export #:partial-order #:plan)
  ;; valve
  (:export #:make-valve #:valve #:valve-name #:valve-owner #:valve-p #:valve-requests))
