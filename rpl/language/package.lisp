;;;; package.lisp -- from a plan's text to nodes, and what of Lisp plans understand.

(defpackage :ars-magna.rpl.language
  (:documentation "Reads the text of plans: Lisp's own operators, procedures, macros; DEFINE-CONSTRUCT adds to it.")
  (:use :cl :ars-magna.base :ars-magna.rpl.fluents :ars-magna.rpl.tasks)
  (:import-from :ars-magna.nisp
                #:untyped-bindings #:untyped-lambda-list #:lambda-list-variables
                #:matchvar-p #:matchvar-name)
  ;; source
  (:export #:misplaced #:misplaced-advice #:misplaced-container #:misplaced-form
           #:misplaced-suspension #:note-own-text)
  ;; scope
  (:export #:inner-scope #:scope #:scope-retry #:single-scope #:variable-scope)
  ;; leaf
  (:export #:value-lambda)
  ;; compiler
  (:export #:binding-body-code #:body-code #:define-plan-form #:hoisted-code #:plan-code
           #:suspends-p)
  ;; steps
  (:export #:seq #:steps #:steps-parts)
  ;; leaving
  (:export #:block-code #:make-leave)
  ;; branching
  (:export #:branch)
  ;; repeating
  (:export #:each-code #:n-times)
  ;; tags
  (:export #:start-branch #:tags-in #:task-status #:with-tags #:with-tags-code)
  ;; calling
  (:export #:call-plan)
  ;; definitions
  (:export #:def-interp-macro #:def-interp-proc #:interp-lambda #:make-plan)
  ;; construct
  (:export #:define-construct #:in-plans-only #:form #:build #:node #:frame #:value #:child #:how
           #:result #:environment #:memory #:next))
