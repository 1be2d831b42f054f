;;;; package.lisp -- the statistics layer: numbers in, numbers out; it knows no experiment.

(defpackage :ars-magna.statistics
  (:documentation "Intervals, tests and survival curves. What a user would call is marked; averages
and the like are for other layers only, since users have their own by those names.")
  (:use :cl :ars-magna.base)
  ;; samples
  (:export #:mean #:variance #:deviation #:median #:quantile)
  ;; proportions
  (:export #:wilson-interval #:exact-interval)
  ;; means
  (:export #:student-interval #:mean-difference-interval #:median-interval)
  ;; bootstrap
  (:export #:bootstrap-interval)
  ;; pairs
  (:export #:mcnemar-test #:paired-proportion-interval)
  ;; permutation
  (:export #:permutation-test)
  ;; several
  (:export #:holm-adjusted)
  ;; survival
  (:export #:survival-curve #:median-survival #:log-rank-test)
  ;; sequential
  (:export #:sequential-level #:rate-evidence #:rate-verdict)
  ;; sobol, designs
  (:export #:+most-dimensions+ #:design-points))
