;;;; package.lisp -- the experiment layer: thousands of trials, and statistics of their results.

(ars-magna.host:define-package :ars-magna.experiment
  (:documentation "Controlled experiments: conditions, trials, and tables that can be repeated and
resumed, on all processors and on many machines. Names lparallel.")
  (:use :cl :ars-magna.host :ars-magna.basics :ars-magna.definitions :ars-magna.copying
        :ars-magna.statistics :ars-magna.run)
  (:import-from :ars-magna.plots
                #:rounded-number-text #:line-chart #:survival-chart #:difference-chart
                #:measure-chart
                #:save-chart #:decimal-exponent #:decimal-text #:strip-trailing-zeros)
  (:import-from :ars-magna.trails #:update-trails #:trails-to-ways #:save-picture-of-ways)
  (:import-from :ars-magna.display
                #:take-snapshot #:snapshot-robots #:picture-kind #:keep-history
                #:save-picture
                #:open-display #:*display-opener* #:group-by)
  (:import-from :ars-magna.time #:current-simulation #:timeline-custody #:answer-questions
                #:leave-question #:timeline-phase
                #:seconds-now #:check-rate #:thinking-mode-p #:thinking-modes-text)
  (:import-from :ars-magna.world #:thing)
  (:import-from :ars-magna.robot #:robot #:find-blueprint #:all-blueprints #:blueprint-name
                #:blueprint-map)
  (:import-from :ars-magna.rpl.tasks
                #:find-procedure #:procedure #:procedure-p #:procedure-name #:procedure-source
                #:procedure-lambda-list
                #:task-p #:task-over-p #:task-state #:task-result #:task-label
                #:plan-failure #:failure-class #:failure-text
                #:lisp-failure #:lisp-failure-condition)
  (:import-from :ars-magna.rpl.fluents #:*realm* #:fork-realm #:fluent-p #:fluent-text)
  (:import-from :ars-magna.rpl-robot #:*on-plan-failure* #:*plan-limit*
                #:*trace-plans* #:stranded-plan-text #:begin-plan))
