;;;; package.lisp -- what runs plans: tasks, how they go on, wait and end, and who runs next.

(defpackage :ars-magna.rpl.tasks
  (:documentation "Plans are cooperative tasks of one thread. A task runs nodes, a plan's
expressions, as a chain of frames on the heap; a runner lets tasks react. Knows neither the text of
plans nor a simulator.")
  (:use :cl :ars-magna.base :ars-magna.rpl.fluents)
  ;; timer
  (:export #:cancel-timer #:set-timer #:timer #:timer-client)
  ;; failure
  (:export #:composite-failure #:composite-failures #:fail #:failure-cause #:failure-class
           #:failure-data #:failure-form #:failure-matches-p #:failure-passed-on-by
           #:failure-plan-backtrace
           #:failure-subject #:failure-suppressed #:failure-task-path #:failure-text
           #:failure-tick #:lisp-failure #:lisp-failure-backtrace #:lisp-failure-condition
           #:make-failure #:plan-failure #:write-failure)
  ;; task
  (:export #:current-form #:form-text #:whole-form-text #:forms-under-way
           #:frame-runs #:frame #:frame-counter #:frame-data #:frame-environment
           #:frame-node #:frame-state #:frame-up #:make-frame #:make-task #:node #:node-form
           #:task #:task-awaiting #:task-blocked #:task-children #:task-cleaning #:task-form
           #:task-frame #:task-index #:task-label #:task-level #:task-name #:task-newest-child
           #:task-over-p #:task-p #:task-parent #:task-path #:task-result #:task-runner
           #:task-serial #:task-signal #:task-state #:task-status-fluent #:task-timer #:task-top
           #:evaporating-p #:part-of-p #:under-way-p #:frame-p #:node-names #:task-since
           #:task-doomed #:task-node #:task-uncounted-p #:task-older)
  ;; awaiting
  (:export #:awaited-text #:task-awaits)
  ;; trace
  (:export #:agent-text #:answer-p #:answer-error #:answer-issue #:issue-arguments #:issue-name
           #:issue-p #:issue-task #:trace-entry #:trace-entry-agent #:trace-entry-detail
           #:trace-entry-event #:trace-entry-form #:trace-entry-subject #:trace-entry-task
           #:trace-entry-tick #:trace-entry-value #:trace-so-far #:write-trace)
  ;; tracing
  (:export #:note-command #:note-event #:start-trace #:stop-trace #:with-answer #:call-with-answer)
  ;; runner
  (:export #:*runaway-limit* #:alone-p #:blocked-p #:current-task #:make-ready
           #:note-event #:plan-runner #:plan-runner-steps #:counted-steps
           #:plan-runner-tasks #:plan-runner-tick #:plan-time #:plan-trace #:runner-blocks
           #:runner-dice #:runner-lisps-dice #:runner-tick
           #:runner-ticks-per-second #:runner-timers #:runner-current #:runner-stepper
           #:runner-note #:runner-serial #:runner-alive #:client-forked-p #:hear-of-trouble
           #:note-seen
           #:runner-trace #:runner-client #:*plan-task-limit*)
  ;; words
  (:export #:note-word #:task-now)
  ;; charging
  (:export #:charge-steps #:charge-ticks #:count-steps #:exhaust-reaction
           #:runner-charged-p #:set-charges #:stand-no-longer
           #:stand-still #:standing-still-p)
  ;; machine
  (:export #:+nothing+ #:+parked+ #:bundle-p #:bundle-values #:call-leaf
           #:completion-p #:enter #:escape-p #:escape-target #:escape-value #:leaf-function
           #:leaf-p #:make-bundle #:make-completion #:make-escape #:make-leaf #:park
           #:required-slot #:single-value #:wake)
  ;; ending
  (:export #:complete #:complete-when-alone #:decide #:evaporate #:fail-or-escape #:note-status
           #:receive #:release-held #:status-word #:stop-waiting #:unwind #:withdraw)
  ;; shape
  (:export #:shape-of #:shape-fixed #:shape-keys #:shape-text #:keyword-slip #:misfit)
  ;; twins
  (:export #:note-twin #:has-twin-p #:twin-text #:end-text #:last-command #:last-pulse
           #:plan-function-p
           #:results-of-command #:pulse-of-command #:teller-of-code)
  ;; procedure
  (:export #:entry-for #:set-lambda-list #:declared-names #:declared-lambda-list
           #:reject-lisp-call #:all-procedures #:procedures-to-offer #:anonymous-procedure
           #:declare-procedure
           #:defined-p #:ensure-procedure #:enter-plan #:find-procedure #:install-procedure
           #:make-procedure #:procedure #:procedure-body #:procedure-entry
           #:check-arguments #:procedure-lambda-list #:procedure-name #:procedure-name-p
           #:procedure-p
           #:procedure-source)
  ;; blame
  (:export #:*failure-hook* #:failure-of #:plan-backtrace #:operator-called-p)
  ;; report
  (:export #:*plan-end-hooks* #:report-end #:report-failure #:missed-text
           #:*plan-start-hooks* #:blocker-of #:task-state-text #:write-task-line
           #:write-task-tree)
  ;; engine
  (:export #:advance-timers #:note-tick #:apply-next-batch #:close-runner #:tell-at-rest
           #:digest-runner
           #:idle-p #:make-plan-runner #:next-wake-time #:heard-from-outside-p
           #:plan-deadlocked-p #:post-batch
           #:needs-tick-p #:rest-in-tick #:post-call #:react #:react-to-all #:reseed-runner
           #:start-plan #:stop-plan)
  ;; blocking
  (:export #:block-task #:check-together #:make-heed #:suspend #:unblock-task #:wake-up)
  ;; circles
  (:export #:hinderers #:hindrance-text #:report-circle #:taken-from #:those-who-took-from)
  ;; care
  (:export #:leave-plan)
  ;; gate
  (:export #:gate #:gate-holds #:hold-back #:release-hold #:spawn-gated)
  ;; variables
  (:export #:*speaking-task* #:install-task-variable #:make-task-bindings #:task-variable
           #:task-variable-p)
  ;; places
  (:export #:find-task #:task-place #:task-source)
  ;; stillness
  (:export #:report-deadlock #:report-stillness #:+no-fluent+ #:warn-of-no-fluent #:doubt-awaited
           #:waiting-parts #:text-of-plans #:text-of-waits
           #:advice-on-stillness #:endless-advice #:fluents-awaited)
  ;; alone
  (:export #:run-plan-alone)
  ;; stepping
  (:export #:spawn))
