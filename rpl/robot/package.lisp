;;;; package.lisp -- plans that drive a robot: the interface of the manual's appendix C.

(ars-magna.host:define-package :ars-magna.rpl-robot
  (:documentation "The rpl- commands, accessors and fluents, and running plans on a simulation.")
  (:use :cl :ars-magna.host :ars-magna.basics :ars-magna.definitions :ars-magna.copying
        :ars-magna.robot :ars-magna.command :ars-magna.rpl.language)
  (:import-from :ars-magna.world
                #:world-map #:*world* #:remaining-capacity #:world-has-kickers-p
                #:some-kicker-p #:kicker-test #:kicker-body
                #:warn-once #:world-robots
                #:warning-given-p #:record-progress-checked)
  (:import-from :ars-magna.time
                #:*simulation* #:resource-event #:seconds-now #:current-simulation #:asking
                #:ask-later #:live-p #:call-when-free-answering #:*urgent-p*
                #:grab-resource #:timeline-real-p #:thinking-charged-p #:thinking-budget
                #:timeline-tick #:check-not-secluded #:check-not-over
                #:wake-owner #:record-code-moment #:timeline-inbox #:agenda-pending #:*hog-seconds*
                #:agenda-salt                 #:sorted-by-turn
                #:hog-seconds)
  (:import-from :ars-magna.run
                #:simulation-tick #:simulation-name #:add-observer #:remove-observer #:run-ticks
                #:call-with-thread-bindings
                #:resolve-robot #:simulation-over #:check-wait-while-paused
                #:simulation-seed #:simulation-plans-dice-p #:simulation-agenda #:simulation-thread
                #:simulation-timeline #:simulation-robots #:simulation-observers
                #:simulation-world #:simulation-messages #:robot-simulation
                #:*simulation-variables* #:*simulator-hooks* #:add-participant
                #:remove-participant #:participant-after-tick #:participant-after-ticks
                #:participant-origin #:participant-robot
                #:participant-busy-p #:participant-at-work-p #:participant-reseed
                #:participant-digest #:participant-end #:participant-clock-stopped
                #:participant-copy #:participant-at-rest #:check-forkable
                #:call-as-participant-makes-way #:participant-unfinished
                #:participant-cut-off #:participant-around-p
                #:fork-simulation #:refuse-fork
                #:participant-place #:simulation-participants #:fork-p #:store-environment
                #:environment-of #:*rewind-hooks* #:*rewound-end-hooks*
                #:counterpart-in-current-run #:latest-successor
                #:fork-postponed-p #:await-postponed-fork
                #:record-outside-act
                #:simulation-past #:simulation-journal #:add-remark #:remove-remark)
  (:import-from :ars-magna.rpl
                #:create-fluent #:create-fluent-vector #:declare-fluent-variable
                #:fluent-value #:fluent-name
                #:set-value #:pulse
                #:apply-settings #:was-read-p #:forget-reading
                #:*default-interface* #:default-home #:note-outside-change #:*runner* #:post-entry
                #:react-to-all
                #:exhaust-reaction #:close-runner #:notify-at-rest #:advance-timers #:note-tick
                #:next-wake-time #:outside-request-p #:runner-idle-p #:set-charges #:ticks-to-think
                #:make-plan-runner #:start-plan #:skip-idle-tick #:stop-plan #:plan-runner
                #:plan-runner-tasks #:runner-steps #:plan-runner-tick
                #:agent-note #:runner-agent #:fail #:current-task #:task #:task-p
                #:task-over-p #:task-state #:task-result #:task-top #:task-parent #:task-path
                #:task-label #:runner-serial #:task-serial #:task-form #:task-children
                #:task-cleaning #:form-text
                #:plan-deadlocked-p #:report-deadlock #:warn-of-outside-waits #:task-ending-p
                #:waiting-parts #:failure-text #:misspelt-handler-text #:lisp-failure
                #:waiting-plans-text #:advice-on-endless-waits #:fluents-awaited
                #:fluent-text #:note-plan-function #:has-plan-function-p #:plan-call-text
                #:pulse-of-command #:last-command #:last-pulse-tick #:endless-advice
                #:advice-on-event
                #:+no-fluent+ #:robot-fluent-p #:note-changed-by-commands
                #:plan-backtrace #:operator-called-p
                #:task-awaiting
                #:report-end #:agent-lisps-dice #:reseed-agent #:digest-runner
                #:print-tasks #:find-procedure #:procedure-name
                #:plan-trace #:valve #:make-valve #:valve-losers #:note-command
                #:with-answer #:runner-in-use #:task-agent #:task-client #:agent-client #:agent-p
                #:make-agent #:add-agent #:remove-agent #:agents-in-order #:slices-spent
                #:end-tasks-at-once
                #:calling-task #:*calling-task* #:task-variable #:procedure-p
                #:shape-keys #:lambda-list-shape #:procedure-lambda-list #:make-task-bindings
                #:enter #:frame-up #:*step-plans* #:*plan-start-hooks*
                #:start-trace
                #:task-runner #:leave-plan #:runner-client #:client-in-copied-run-p
                #:call-with-client-still #:owner-text #:robot-name-of-client
                #:note-plan-trouble #:note-plans-shown #:*realm*
                #:copy-back-values #:+root+
                #:realm-sources #:drop-realm-references #:source-realm #:with-owned-home #:entity
                #:entity-here
                #:all-tasks #:task-numbered #:task-whose-variable-holds #:blocked-p #:failure-of
                #:end-with-value
                #:part-of-p #:lineage #:frame-chain #:frame-node #:node-form #:current-form
                #:task-level #:evaporating-p #:reasons #:end-with-signal #:remove-waiting-task
                #:task-frame #:task-name
                #:trace-entry-event #:trace-entry-subject
                #:issue-name #:issue-robot #:issue-end-tick #:issue-description #:asker-description
                #:twin-here
                #:note-outside-call #:current-counterpart #:advice-on-call #:advice-on-goal))
