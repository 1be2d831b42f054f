;;;; package.lisp -- from a plan's text to nodes, and what of Lisp plans understand.

(defpackage :ars-magna.rpl.language
  (:documentation "Reads the text of plans: Lisp's own operators, procedures, macros;
DEFINE-CONSTRUCT adds to it.")
  (:use :cl :ars-magna.base :ars-magna.rpl.fluents :ars-magna.rpl.tasks)
  (:import-from :ars-magna.nisp
                #:untyped-bindings #:untyped-lambda-list #:lambda-list-variables
                #:matchvar-p #:matchvar-name)
  ;; source
  (:export #:author #:misplaced #:misplaced-advice #:misplaced-container #:misplaced-form
           #:misplaced-suspension #:operator-in-p #:note-own-text #:note-expansion
           #:form-as-written)
  ;; names, items
  (:export #:check-variables #:plain-parameters #:item-list)
  ;; checking
  (:export #:warn-of-call #:doubt-own-form #:*advice-on-call* #:find-call #:fail-p
           #:may-return-p
           #:endless-whenever-p)
  ;; scope
  (:export #:inner-scope #:scope #:scope-blocks #:scope-retry #:single-scope #:variable-scope
           #:scope-environment #:scope-variables)
  ;; leaf
  (:export #:condition-lambda #:awaited-lambda #:value-lambda)
  ;; compiler
  (:export #:define-plan-form #:hoisted-code #:plan-code #:refuse-code #:suspends-p)
  ;; steps
  (:export #:binding-body-code #:body-code #:steps #:steps-parts)
  ;; leaving
  (:export #:block-code #:make-leave)
  ;; repeating
  (:export #:each-body-code #:give-way)
  ;; tags
  (:export #:start-branch #:tagged-scope #:tags-in #:task-status #:with-tags-code)
  ;; calling
  (:export #:*plan-depth-limit* #:name-without-quote-p #:check-quote)
  ;; applying
  (:export #:enter-application)
  ;; callers
  (:export #:called-procedures)
  ;; definitions
  (:export #:def-interp-macro #:def-interp-proc #:interp-lambda #:make-plan #:split-documentation
           #:variable-of)
  ;; replacing
  (:export #:replace-task-code #:restore-task-code #:task-code)
  ;; construct
  (:export #:all-constructs #:define-construct #:in-plans-only #:form #:scope #:build)
  ;; expression
  (:export #:define-expression #:node #:task #:frame #:value #:child #:how #:result
           #:environment #:memory #:next #:at-once #:in-state-p))
