;;;; package.lisp -- from a plan's text to nodes, and the Lisp that plans understand.

(ars-magna.host:define-package :ars-magna.rpl.language
  (:documentation "The compiler for plans: Lisp's operators in plans, plan procedures, macros for
plans, and DEFINE-CONSTRUCT.")
  (:use :cl :ars-magna.host :ars-magna.basics :ars-magna.definitions :ars-magna.copying
        :ars-magna.rpl.fluents :ars-magna.rpl.tasks)
  (:import-from :ars-magna.nisp
                #:untyped-bindings #:untyped-lambda-list #:lambda-list-variables
                #:matchvar-p #:matchvar-name)
  (:local-nicknames (:lifted :ars-magna.rpl.lifted))
  (:export #:node #:task #:frame))
