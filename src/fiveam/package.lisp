;;;; package.lisp -- checks for FiveAM that hold plans to their rates: the one door to FiveAM.

(ars-magna.host:define-package :ars-magna.fiveam
  (:nicknames :ars-fiveam)
  (:documentation "Checks for suites of tests written with FiveAM, which hold plans, programs and
experiments to their rates of success. Use it beside FIVEAM.")
  (:use :cl :ars-magna.host :ars-magna.basics :ars-magna.definitions :ars-magna.copying)
  (:import-from :fiveam #:pass #:fail)
  (:import-from :ars-magna.statistics #:rate-verdict #:exact-interval)
  (:import-from :ars-magna.run #:variables-among)
  (:import-from :ars-magna.experiment
                #:experiment-from #:find-experiment #:experiment-name #:experiment-conditions
                #:experiment-trials #:experiment-limit #:experiment-package #:doubt-nested-run
                #:find-condition #:condition-name
                #:run-guarded #:replay-trial #:call-in-silence #:call-by-workers #:form-in-package
                #:result-trial #:result-seed #:result-outcome #:result-reason #:result-error))
