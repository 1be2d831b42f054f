;;;; package.lisp -- fluents and networks of them.

(defpackage :ars-magna.rpl.lifted
  (:documentation "Lisp's operators as plans understand them, for ordinary code that wants them:
conditions read fluents by value, operators given a fluent return a network. Inside a plan the
operators of Common Lisp mean these without further ado.")
  (:use)
  (:export #:if #:when #:unless #:cond #:loop
           #:and #:or #:not #:null #:< #:> #:<= #:>= #:= #:+ #:- #:* #:/ #:eq #:eql #:equal))

(ars-magna.host:define-package :ars-magna.rpl.fluents
  (:documentation "Fluents, networks of fluents, and how a change reaches watchers. Knows no plan.")
  (:use :cl :ars-magna.host :ars-magna.basics :ars-magna.definitions :ars-magna.copying)
  (:local-nicknames (:lifted :ars-magna.rpl.lifted)))
