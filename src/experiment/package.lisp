;;;; package.lisp -- the experiment layer: trials by the thousand, and what they tell.

(defpackage :ars-magna.experiment
  (:documentation "Controlled experiments: conditions, trials, tables that can be repeated and gone
on with, on as many cores and machines as there are. Names lparallel.")
  (:use :cl :ars-magna.base :ars-magna.statistics :ars-magna.run)
  (:import-from :ars-magna.plots
                #:figure-text #:line-chart #:survival-chart #:difference-chart #:measure-chart
                #:save-chart #:power-of-ten)
  (:import-from :ars-magna.trails #:note-places #:ways-along #:save-bundle)
  (:import-from :ars-magna.display
                #:take-snapshot #:snapshot-robots #:picture-kind #:keep-history
                #:open-display #:*display-opener*)
  (:import-from :ars-magna.world #:map-width #:map-height #:world-dice-set)
  (:import-from :ars-magna.time #:current-simulation #:timeline-custody #:answer-questions
                #:custody-questions #:timeline-phase
                #:seconds-now #:check-rate #:thinking-mode-p #:thinking-modes-text)
  (:import-from :ars-magna.robot
                #:robot-x #:robot-y #:find-blueprint #:all-blueprints #:blueprint-name
                #:blueprint-map)
  (:import-from :ars-magna.rpl.tasks
                #:find-procedure #:procedure #:procedure-p #:procedure-name #:procedure-source
                #:task-p #:task-over-p #:task-state #:task-result #:task-label
                #:plan-failure #:failure-class #:failure-text
                #:lisp-failure #:lisp-failure-condition)
  (:import-from :ars-magna.rpl.fluents #:*realm* #:fork-realm #:fluent-p #:fluent-text)
  (:import-from :ars-magna.rpl-robot #:*plan-limit* #:*trace-plans* #:stranded-plan-text)
  ;; defexperiment, experiment
  (:export #:defexperiment #:define-experiment #:find-experiment #:all-experiments
           #:experiment-p #:experiment-name #:experiment-conditions #:experiment-trials
           #:experiment-from #:experiment-package #:experiment-limit #:find-condition #:trial-values
           #:condition-name #:condition-parameters #:doubt-nested-run)
  ;; trial, outcome, workers, description, origin, values
  (:export #:run-trial #:run-guarded #:call-in-silence #:call-by-workers #:form-text
           #:experiment-file #:number-in
           #:result-trial #:result-seed #:result-outcome #:result-reason #:result-ticks
           #:result-digest #:result-error)
  ;; results
  (:export #:results-p #:results-samples #:results-directory #:results-factors #:results-measures
           #:read-results #:sample-p #:sample-experiment #:sample-condition #:sample-texts
           #:sample-trials #:sample-outcomes #:sample-reasons #:sample-ticks #:sample-errors
           #:sample-measure)
  ;; differences, contrasts, verdicts, comparison-table, comparing, comparing-versions,
  ;; comparison-picture
  (:export #:paired-difference-p #:paired-measure #:paired-trials #:paired-first #:paired-second
           #:paired-estimate #:paired-low #:paired-high #:paired-p #:paired-adjusted-p
           #:paired-table
           #:contrast-p #:contrast-first #:contrast-second #:contrast-where #:contrast-trials
           #:contrast-same #:contrast-differences
           #:comparison-p #:comparison-contrasts #:comparison-overall #:comparison-changes
           #:comparison-verdicts #:print-comparison
           #:compare-conditions #:compare-levels #:compare-results #:save-comparison-picture)
  ;; lines, progress, running, merging, workers
  (:export #:damaged-table #:ensure-store-directory #:run-experiment #:merge-results #:processors
           #:trial-under-way)
  ;; replaying
  (:export #:trial-words #:*trial-replayed*)
  ;; fingerprint, shards
  (:export #:settle-fingerprints #:shard-directory #:directories-with-rows #:count-rows
           #:trials-in-shard-p #:missing-shards #:check-same-code)
  ;; estimates, summary, report
  (:export #:estimate-p #:estimate-name #:estimate-kind #:estimate-count #:estimate-value
           #:estimate-low #:estimate-high #:estimate-left-out #:estimate-texts
           #:summary-p #:summary-condition #:summary-texts #:summary-trials #:summary-failures
           #:summary-limits #:summary-errors #:summary-confidence #:summary-success #:summary-ticks
           #:summary-measures #:summary-reasons #:summarize-results #:print-results
           #:call-on-page)
  ;; pictures, ways-picture
  (:export #:save-result-pictures #:save-ways-picture)
  ;; aside, replaying, failures
  (:export #:run-again #:call-until-error #:call-aside #:await-time #:replay-trial
           #:row-of-trial #:row-differences #:prepare-condition #:measured
           #:trial-series #:trial-failures #:print-failures)
  ;; what the prompt shows
  (:export #:experiment-documentation #:trial-seed))
