;;;; package.lisp -- the plan language: fluents, tasks, constructs and their scheduler.

(defpackage :ars-magna.rpl.lifted
  (:documentation "Lisp's operators as plans understand them, for ordinary code that wants them:
conditions read fluents by value, operators given a fluent return a network. Inside a plan the
operators of Common Lisp mean these without further ado.")
  (:use)
  (:export #:if #:when #:unless #:cond #:loop
           #:and #:or #:not #:< #:> #:<= #:>= #:= #:+ #:- #:* #:/ #:eq #:eql #:equal))

(defpackage :ars-magna.rpl
  (:documentation "RPL (manual, appendices C and D): plans are cooperative tasks of one thread.
Fluents hold what varies, tasks wait for fluents, a runner lets them react. Knows no simulator.")
  (:use :cl :ars-magna.base)
  (:import-from :ars-magna.nisp
                #:untyped-bindings #:untyped-lambda-list #:lambda-list-variables
                #:matchvar-p #:matchvar-name)
  (:local-nicknames (:lifted :ars-magna.rpl.lifted))
  ;; fluents and networks
  (:export #:fluent #:fluent-p #:fluent-name #:create-fluent #:create-fluent-vector #:state
           #:fluent-value #:fl-funcall #:fl-apply)
  ;; propagation
  (:export #:set-value #:pulse #:apply-settings)
  ;; failures
  (:export #:plan-failure #:composite-failure #:lisp-failure #:fail
           #:failure-class #:failure-data #:failure-form #:failure-task-path #:failure-tick
           #:failure-cause #:failure-suppressed #:failure-plan-backtrace
           #:composite-failures #:lisp-failure-condition #:lisp-failure-backtrace)
  ;; tasks
  (:export #:task #:task-p #:task-name #:task-state #:task-serial #:task-parent #:task-children
           #:task-form #:task-awaits #:task-result #:task-status #:task-over-p #:task-path
           #:evaporate)
  ;; valves
  (:export #:valve #:valve-p #:make-valve #:valve-name #:valve-owner)
  ;; compile-time errors
  (:export #:misplaced-suspension #:misplaced-form #:misplaced-container #:misplaced-advice)
  ;; defining plans
  (:export #:def-interp-proc #:def-interp-macro #:interp-lambda #:make-plan #:call-plan
           #:procedure #:procedure-p #:find-procedure #:all-procedures #:procedure-name
           #:procedure-lambda-list)
  ;; constructs
  (:export #:seq #:par #:pursue #:try-all #:try-in-order #:try-one #:try-each-in-order #:par-loop
           #:with-policy #:whenever #:wait-for #:wait-time #:n-times #:partial-order #:plan
           #:with-tags #:with-task-blocked #:with-valve #:evap-protect
           #:handle-failure #:with-failure-handling #:retry #:with-retry-counters #:do-retry)
  ;; trace and reports
  (:export #:plan-trace #:write-trace #:trace-entry #:trace-entry-tick #:trace-entry-event
           #:trace-entry-task #:trace-entry-form #:trace-entry-detail
           #:print-tasks #:report-deadlock #:report-failure #:*plan-end-hooks*)
  ;; the engine
  (:export #:plan-runner #:make-plan-runner #:*runner* #:*runaway-limit* #:current-task #:plan-time
           #:plan-runner-tick #:plan-runner-tasks #:plan-runner-steps
           #:start-plan #:react #:post-batch #:post-call #:apply-next-batch #:advance-timers
           #:reseed-runner #:digest-runner #:next-wake-time #:idle-p #:plan-deadlocked-p
           #:stop-plan #:run-plan-alone))
