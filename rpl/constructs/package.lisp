;;;; package.lisp -- what the plan language has beyond Lisp: a file for each idea.

(defpackage :ars-magna.rpl.constructs
  (:documentation "The constructs of RPL (manual, appendices C and D). Each is one form, DEFINE-CONSTRUCT.")
  (:use :cl :ars-magna.base :ars-magna.rpl.fluents :ars-magna.rpl.tasks
        :ars-magna.rpl.language)
  ;; whenever
  (:export #:whenever)
  ;; handling
  (:export #:handle-failure #:retry #:with-failure-handling)
  ;; counting
  (:export #:do-retry #:get-counter #:reset-counter #:with-retry-counters)
  ;; named-policies
  (:export #:all-policies #:define-policy #:failed-policy #:find-policy #:make-policy
           #:policy-check-condition-met #:policy-failure #:policy-get #:policy-init-failed #:policy-lambda-list #:policy-name
           #:policy-p #:policy-setf)
  ;; goals, achieving
  (:export #:all-goals #:def-goal #:failed-goal #:failed-goal-operator #:find-goal #:goal-failure
           #:goal-not-achieved #:goal-operator #:goal-p #:goal-pattern #:goals-under-way
           #:unknown-goal #:unknown-goal-known)
  ;; at-location
  (:export #:location-lost #:lost-attempts #:lost-place)
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
  (:export #:make-valve #:valve #:valve-name #:valve-owner #:valve-p))
