;;;; package.lisp -- reactive action packages (RAPs) on the plan language.

(ars:define-user-package :ars-rap
  (:documentation "Reactive action packages after Firby: tasks that repeat methods until their
success test holds, a memory of facts with rules, and an agenda of goals with priorities and
deadlines. Use this package together with ARS and NISP.")
  (:import-from :ars-magna.basics #:reject-argument #:reject-use #:value-equal
                #:text-as-typed #:abridged #:proper-list-p #:plain-datum-p #:define-record #:cut)
  (:import-from :ars-magna.definitions #:reject-clause #:definition-title #:define-registry
                #:register #:define-user-macro #:call-with-definition #:define-operator)
  (:import-from :ars-magna.run #:stored-run-variable #:update-run-variable
                #:check-run-variable-value #:copied-value
                #:world-of-current-run)
  (:import-from :ars-magna.rpl.language #:variable-of #:procedure-form #:check-plan-name
                #:define-expression #:define-plan-form
                #:next #:at-once #:value #:child #:how #:result #:environment #:memory
                #:block-code #:body-code #:plan-code #:value-lambda #:variable-scope
                #:single-value-scope #:note-expansion #:form-as-written)
  (:import-from :ars-magna.rpl.tasks #:failure-text #:write-failure #:report-failure
                #:node #:node-form #:frame
                #:frame-data #:frame-up #:frames-around #:task-frame
                #:failure-of #:current-form #:make-task #:spawn #:park #:park-again #:+parked+
                #:task-level #:end-with-value #:end-with-signal #:awaited-text #:traced-subject
                #:timer-client #:task-timer #:task-awaiting #:task-runner #:set-timer
                #:runner-timers #:plan-runner-tick #:make-ready #:note-event
                #:agent-note #:runner-agents #:task-agent #:task-index #:status-word #:all-tasks
                #:enter-plan #:*calling-task* #:agent-runner #:inside-plans-p
                #:note-from-outside #:current-task #:*leaves-offer-restarts*
                #:call-with-value-restarts)
  (:import-from :ars-magna.rpl.fluents #:post-entry)
  (:import-from :ars-magna.rpl-robot #:usable-interface #:interface-runner
                #:call-with-plans-in-use #:agent-driven)
  (:import-from :ars-magna.nisp #:matchvar-p #:matchvar-name)
  (:export #:memory-add #:memory-delete #:memory-set #:memory-holds-p #:memory-query #:memory-tick
           #:main-memory* #:dump-memory #:reset-memory #:define-memory-rule
           #:define-rap #:rap-failed #:rap-failed-name #:rap-failed-tries #:goal-priority*
           #:with-resources
           #:install-goal #:remove-goal #:set-goal-priority
           #:execute-goal #:process-goal-agenda #:work-on-agenda
           #:main-agenda* #:agenda-goals #:dump-agenda #:reset-agenda))
