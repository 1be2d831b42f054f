;;;; package.lisp -- checks of success rates for FiveAM; the only folder that uses FiveAM.

(ars-magna.host:define-package :ars-magna.fiveam
  (:nicknames :ars-fiveam)
  (:documentation "Checks of success rates of plans, programs and experiments, for test suites
written with FiveAM. Use this package together with FIVEAM.")
  (:use :cl :ars-magna.host :ars-magna.basics :ars-magna.definitions :ars-magna.copying)
  (:import-from :fiveam #:pass #:fail)
  (:import-from :ars-magna.statistics #:rate-verdict #:exact-interval #:share-as-double)
  (:import-from :ars-magna.run #:names-in-robots #:literal-robots-form #:robots-expression-p)
  (:import-from :ars-magna.experiment
                #:experiment-from-options #:find-experiment #:experiment-name
                #:experiment-conditions
                #:experiment-trials #:experiment-limit #:experiment-package #:warn-of-nested-run
                #:find-condition #:condition-name
                #:run-trial-in-worker #:replay-trial #:call-without-output #:call-by-workers
                #:form-text-in-package
                #:result-trial #:result-seed #:result-outcome #:result-reason #:result-error))
