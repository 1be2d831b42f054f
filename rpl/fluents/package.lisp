;;;; package.lisp -- fluents and networks of them.

(defpackage :ars-magna.rpl.lifted
  (:documentation "The operators of Lisp with the meaning that they have in plans, for use in
ordinary code. Conditions use the values of fluents, and operators with a fluent as argument return
a network. In a plan, the operators of Common Lisp have this meaning by themselves.")
  (:use)
  (:export #:if #:when #:unless #:cond #:loop
           #:and #:or #:not #:null #:< #:> #:<= #:>= #:= #:+ #:- #:* #:/ #:eq #:eql #:equal))

(ars-magna.host:define-package :ars-magna.rpl.fluents
  (:documentation "Fluents, networks of them, and how a change reaches watchers. Independent of
plans.")
  (:use :cl :ars-magna.host :ars-magna.basics :ars-magna.definitions :ars-magna.copying)
  (:local-nicknames (:lifted :ars-magna.rpl.lifted)))
