;;;; package.lisp -- what runs plans: tasks, how they go on, wait and end, and who runs next.

(defpackage :ars-magna.rpl.tasks
  (:documentation "Plans are cooperative tasks of one thread. A task runs nodes, a plan's expressions, as a chain of
frames on the heap; a runner lets tasks react. Knows neither the text of plans nor a simulator.")
  (:use :cl :ars-magna.base :ars-magna.rpl.fluents)
  ;; timer
  (:export #:cancel-timer #:set-timer #:timer #:timer-client)
  ;; failure
  (:export #:composite-failure #:composite-failures #:fail #:failure-cause #:failure-class
           #:failure-data #:failure-form #:failure-matches-p #:failure-plan-backtrace
           #:failure-subject #:failure-suppressed #:failure-task-path #:failure-text
           #:failure-tick #:lisp-failure #:lisp-failure-backtrace #:lisp-failure-condition
           #:make-failure #:plan-failure)
  ;; task
  (:export #:current-form #:frame #:frame-node #:frame-p #:frame-counter #:frame-data #:frame-environment #:frame-up
           #:make-frame #:make-task #:node #:node-form #:node-names #:form-text #:task #:task-since #:task-doomed #:task-node #:task-awaiting #:task-blocked
           #:task-children #:task-cleaning #:task-form #:task-frame #:task-index #:task-label
           #:task-level #:task-name #:task-newest-child #:task-over-p #:task-p #:task-parent
           #:task-path #:task-result #:task-runner #:task-serial #:task-signal #:task-state
           #:task-status-fluent #:task-timer)
  ;; trace
  (:export #:agent-text #:answer-p #:answer-error #:answer-issue #:issue-arguments #:issue-name #:issue-p #:issue-task
           #:trace-entry #:trace-entry-agent #:trace-entry-detail #:trace-entry-event #:trace-entry-form
           #:trace-entry-subject #:trace-entry-task #:trace-entry-tick #:trace-entry-value
           #:write-trace)
  ;; tracing
  (:export #:note-command #:note-event #:start-trace #:with-answer)
  ;; runner
  (:export #:*runaway-limit* #:*runner* #:alone-p #:current-task #:make-ready
           #:plan-runner #:plan-runner-steps #:plan-runner-tasks #:plan-runner-tick #:plan-time
           #:plan-trace #:runner-blocks #:runner-current #:runner-dice #:runner-stepper #:runner-tick #:runner-trace #:runner-ticks-per-second
           #:runner-timers)
  ;; machine
  (:export #:+nothing+ #:+parked+ #:awaited-text #:bundle-p #:bundle-values #:completion-p
           #:define-node #:required-slot #:enter #:escape-p #:escape-target #:escape-value #:leaf-function
           #:leaf-p #:make-bundle #:make-completion #:make-escape #:make-leaf #:park
           #:single-value #:wake)
  ;; ending
  (:export #:complete #:complete-when-alone #:decide #:evaporate #:fail-or-escape #:note-status
           #:receive #:release-held #:stop-waiting #:unwind #:withdraw)
  ;; procedure
  (:export #:ensure-procedure #:make-procedure #:all-procedures #:anonymous-procedure #:declare-procedure #:defined-p #:enter-plan
           #:find-procedure #:install-procedure #:procedure #:procedure-body #:procedure-entry
           #:procedure-lambda-list #:procedure-name #:procedure-name-p #:procedure-p)
  ;; blame
  (:export #:*failure-hook* #:failure-of #:plan-backtrace)
  ;; report
  (:export #:*plan-end-hooks* #:*plan-start-hooks* #:blocker-of #:report-deadlock #:report-failure #:task-awaits
           #:task-state-text #:write-task-line #:write-task-tree)
  ;; engine
  (:export #:advance-timers #:apply-next-batch #:digest-runner #:idle-p #:make-plan-runner
           #:next-wake-time #:plan-deadlocked-p #:post-batch #:post-call #:react #:reseed-runner
           #:start-plan #:stop-plan)
  ;; alone
  (:export #:run-plan-alone)
  ;; stepping
  (:export #:spawn))
