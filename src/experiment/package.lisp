;;;; package.lisp -- the experiment layer: trials by the thousand, and what they tell.

(defpackage :ars-magna.experiment
  (:documentation "Controlled experiments: conditions, trials, tables that can be repeated and gone
on with, on as many cores and machines as there are. Names cl-csv and lparallel.")
  (:use :cl :ars-magna.base :ars-magna.run)
  (:import-from :ars-magna.time #:current-simulation)
  (:import-from :ars-magna.robot #:find-blueprint #:all-blueprints #:blueprint-name #:blueprint-map)
  (:import-from :ars-magna.rpl.tasks
                #:procedure #:procedure-p #:procedure-source
                #:plan-failure #:failure-class #:failure-text
                #:lisp-failure #:lisp-failure-condition)
  (:import-from :ars-magna.rpl-robot #:*plan-limit*)
  (:import-from :ars-magna.statistics #:sequential-level #:wilson-interval)
  ;; defexperiment, experiment
  (:export #:defexperiment #:define-experiment #:find-experiment #:all-experiments
           #:experiment-p #:experiment-name #:experiment-conditions #:experiment-trials
           #:find-condition #:trial-values)
  ;; results
  (:export #:results-p #:results-samples #:results-directory #:results-factors #:results-measures
           #:read-results #:sample-p #:sample-experiment #:sample-condition #:sample-texts
           #:sample-trials #:sample-outcomes #:sample-reasons #:sample-ticks #:sample-errors
           #:sample-measure)
  ;; lines, running, merging, workers
  (:export #:damaged-table #:run-experiment #:merge-results #:processors)
  ;; fingerprint, shards
  (:export #:settle-fingerprints #:shard-directory #:directories-with-rows #:count-rows
           #:missing-shards))
