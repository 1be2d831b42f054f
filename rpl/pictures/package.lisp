;;;; package.lisp -- pictures of plans.

(defpackage :ars-magna.rpl-pictures
  (:documentation "Pictures of plans that run or have run: joins the plan language with the
canvas.")
  (:use :cl :ars-magna.base :ars-magna.canvas)
  (:import-from :ars-magna.rpl
                #:bar #:bar-call-p #:bar-commands #:bar-depth #:bar-end #:bar-failure #:bar-form
                #:bar-label #:bar-name
                #:bar-outcome #:bar-parts #:bar-serial #:bar-spans #:bar-start #:bars
                #:span-end #:span-error #:span-kind #:span-start #:span-text
                #:plan-trace #:plan-runner-tick #:runner-to-see)
  (:import-from :ars-magna.rpl-robot #:call-with-plans-in-use)
  (:import-from :ars-magna.display #:picture-kind #:save-svg)
  ;; saving
  (:export #:save-plan-timeline))
