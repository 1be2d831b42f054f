;;;; package.lisp -- the command-line face: the prompt Robot> and its commands.

(ars-magna.host:define-package :ars-magna.cli
  (:documentation "The arguments of ./cli/ars-magna, the prompt and its lines. No other package
ends the Lisp process. See the manual, 3.7, A and E.")
  (:use :cl :ars-magna.host :ars-magna.basics :ars-magna.definitions :ars-magna.copying
        :ars-magna.world :ars-magna.time :ars-magna.robot :ars-magna.run :ars-magna.command
        :ars-magna.display)
  (:shadowing-import-from :ars-magna.world #:map)
  (:import-from :trivial-gray-streams
                #:fundamental-character-output-stream #:fundamental-character-input-stream
                #:stream-line-column #:stream-write-char #:stream-write-string
                #:stream-force-output #:stream-finish-output
                #:stream-read-char #:stream-read-line #:stream-unread-char
                #:stream-read-char-no-hang #:stream-listen #:stream-clear-input)
  (:import-from :ars-magna.rpl
                #:task-p #:task-name #:task-parent #:task-serial #:task-state #:task-result
                #:task-over-p #:plan-failure #:failure-class #:failure-data
                #:report-failure #:*plan-end-hooks* #:plan-deadlocked-p
                #:stop-plan
                #:find-procedure #:all-procedures #:called-procedures #:procedure-name
                #:procedure-lambda-list #:print-tasks #:task-numbered
                #:task-label #:all-tasks #:step-task #:start-trace #:stop-trace
                #:plan-break-p #:why)
  (:import-from :ars-magna.rpl.tasks
                #:task-label #:task-client #:calling-task #:robot-name-of-client
                #:call-handling-trouble #:arguments-misfit-text #:lambda-list-shape
                #:lambda-list-text
                #:waiting-parts #:text-of-waits #:advice-on-endless-waits)
  (:import-from :ars-magna.rpl-robot #:rpl-runner #:waits-for-message-p
                #:plan-ending-p #:begin-plan #:end-plan #:plans #:print-plans
                #:call-with-plans-in-use #:*commanded-robot-hook* #:note-robot-commanded)
  (:import-from :ars-magna.rpl-robot #:*trace-plans* #:all-fluent-variables
                #:fluent-of-robot #:robot-name-of-plan)
  (:import-from :ars-magna.rpl.fluents
                #:fluent-p #:known-pulse-p #:vector-variable-kind #:known-fluent-variable-p
                #:peek-fluent #:peek-pulses)
  (:import-from :ars-magna.plots
                #:time-series #:make-time-series #:time-series-index #:add-sample
                #:cut-time-series #:last-sample
                #:collect-time-charts #:time-charts-svg #:save-chart #:value-and-unit-text)
  (:import-from :ars-magna.rpl.language #:all-constructs)
  (:import-from :ars-magna.nisp #:readtable-name)
  (:import-from :ars-magna.geometry #:pt-x #:pt-y)
  (:import-from :ars-magna.floors #:import-map #:export-map)
  (:import-from :ars-magna.ways #:nearest-free-point)
  (:import-from :ars-worlds #:robot-go-to)
  (:import-from :ars-magna.rpl-pictures #:save-plan-timeline)
  (:import-from :ars-magna.experiment
                #:find-experiment #:all-experiments #:experiment-name #:experiment-documentation
                #:experiment-conditions #:experiment-trials #:experiment-limit #:experiment-file
                #:find-condition #:condition-name #:trial-seed
                #:number-from-text #:ensure-store-directory
                #:rerun-trial #:trial-prompt-line #:*replayed-trial-line* #:call-until-error
                #:call-outside-trial #:await-real-time
                #:prepare-condition #:row-of-trial #:row-differences
                #:result-outcome #:result-reason #:result-ticks #:result-error #:measure-values
                #:print-failures
                #:run-experiment #:current-slow-trial-text #:merge-results #:processors
                #:freeze-file-digests
                #:results-directory #:print-results #:save-result-pictures #:read-results
                #:call-with-page-width
                #:compare-conditions #:compare-levels #:compare-results #:save-comparison-picture
                #:shard-directory #:directories-with-rows #:count-rows #:shard-has-trials-p
                #:missing-shards #:check-same-code
                #:testbed #:find-testbed #:all-testbeds #:testbed-name #:testbed-agents
                #:testbed-knobs #:testbed-score #:run-testbed #:save-testbed-pages
                #:write-testbed-list #:agent-p #:agent-arguments-text #:testbed-measures
                #:testbed-seeds
                #:write-agents-order #:count-broken-trials
                #:broken-agents #:first-broken-trial #:testbed-robots #:parameter-of-variable
                #:settings-text #:testbed-p #:testbed-experiment #:testbed-documentation
                #:experiment-measures)
  (:export #:fundamental-character-output-stream #:fundamental-character-input-stream
           #:stream-line-column #:stream-write-char #:stream-write-string #:stream-read-char))
