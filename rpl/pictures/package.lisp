;;;; package.lisp -- pictures of plans.

(ars-magna.host:define-package :ars-magna.rpl-pictures
  (:documentation "Pictures of plans that run or have run, on a canvas.")
  (:use :cl :ars-magna.host :ars-magna.basics :ars-magna.definitions :ars-magna.copying
        :ars-magna.canvas)
  (:import-from :ars-magna.rpl
                #:bar #:bar-call-p #:bar-commands #:bar-depth #:bar-end #:bar-failure #:bar-form
                #:bar-label #:bar-name #:bar-owner #:whole-form-text
                #:bar-outcome #:bar-parts #:bar-serial #:bar-spans #:bar-start #:bars
                #:span-end #:span-error #:span-kind #:span-start #:span-text
                #:plan-trace #:plan-runner-tick #:runner-to-show
                #:image-of-tasks #:task-image #:task-image-serial #:task-image-depth
                #:task-image-look #:task-image-state #:task-image-name #:task-image-form
                #:task-image-calls
                #:task-image-awaits #:task-image-since #:task-image-parts
                #:task-image-folded-p #:tree-image-tick #:tree-image-rows #:tree-image-plans
                #:tree-image-tasks)
  (:import-from :ars-magna.rpl-robot #:call-with-plans-in-use)
  (:import-from :ars-magna.command #:failure-code-p #:error-code-meaning)
  (:import-from :ars-magna.display #:picture-kind #:save-svg #:wrap-text-to-width))
