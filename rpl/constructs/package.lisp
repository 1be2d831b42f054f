;;;; package.lisp -- what the plan language has beyond Lisp: a file for each idea.

(defpackage :ars-magna.rpl.constructs
  (:documentation "The constructs of RPL (manual, appendices C and D). Each is one form,
DEFINE-CONSTRUCT, which also exports its name.")
  (:use :cl :ars-magna.base :ars-magna.rpl.fluents :ars-magna.rpl.tasks
        :ars-magna.rpl.language)
  ;; retry-counters
  (:export #:get-counter #:reset-counter)
  ;; named-policies
  (:export #:all-policies #:define-policy #:failed-policy #:find-policy #:make-policy
           #:policy-check-condition-met #:policy-failure #:policy-get #:policy-init-failed
           #:policy-lambda-list #:policy-name #:policy-p #:policy-setf)
  ;; goals, achieving
  (:export #:advice-on-goal #:all-goals #:def-goal #:failed-goal #:failed-goal-operator
           #:find-goal #:goal-failure
           #:goal-not-achieved #:goal-operator #:goal-p #:goal-pattern #:goals-under-way
           #:unknown-goal #:unknown-goal-known)
  ;; at-location
  (:export #:location-lost #:lost-attempts #:lost-place)
  ;; valve
  (:export #:claim-p #:claim-valves #:make-valve #:valve #:valve-losers #:valve-name #:valve-owner
           #:valve-p #:valve-requests)
  ;; task-variables
  (:export #:define-task-variable)
  ;; deadline
  (:export #:deadline-missed #:deadline-missed-ticks))
