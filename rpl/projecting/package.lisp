;;;; package.lisp -- plans that are tried in forks first.

(ars-magna.host:define-package :ars-magna.rpl-projecting
  (:documentation "Projects plans: runs them in forks of their run, or in a world that a robot
believes in, to estimate how they may end, and to choose the best.")
  (:use :cl :ars-magna.host :ars-magna.basics :ars-magna.definitions :ars-magna.copying
        :ars-magna.rpl.language :ars-magna.rpl-robot)
  (:import-from :ars-magna.statistics #:wilson-interval)
  (:import-from :ars-magna.world #:*world*)
  (:import-from :ars-magna.time #:*simulation* #:current-simulation #:with-seclusion)
  (:import-from :ars-magna.robot #:robot-name #:robot-p)
  (:import-from :ars-magna.run #:simulation-messages
                #:find-measure #:measured-number #:parse-measure #:summary-of-numbers #:summary-text
                #:*simulation-variables* #:simulation-tick #:simulation-seed #:simulation-robots
                #:simulation-participants #:simulation-journal #:simulation-world
                #:fork-simulation #:call-in-fork #:release-fork #:*fork-operator*)
  (:import-from :ars-magna.rpl
                #:*break-on-plan-failures* #:*runaway-limit* #:*step-plans* #:+parked+ #:enter
                #:environment
                #:awaited-text #:count-steps #:check-arguments #:failure-class
                #:find-procedure #:function-designator-p
                #:fluent-value #:whole-form-text #:frame #:frame-up #:lisp-failure
                #:lisp-failure-condition #:park
                #:task-bindings-p #:task-bindings-cells
                #:plan-failure #:counted-steps #:procedure #:procedure-name #:procedure-p
                #:runner-client #:agent-dice #:task-agent #:stop-trace #:task #:task-label #:task-p
                #:task-result #:task-runner #:task-state #:task-top #:all-tasks #:plan-runner-tasks
                #:value #:escape-p #:entity
                #:*default-interface* #:*realm* #:fork-realm)
  (:import-from :ars-magna.trails #:update-trails #:trails-to-ways #:save-picture-of-ways)
  (:import-from :ars-magna.display #:take-snapshot #:picture-kind))
