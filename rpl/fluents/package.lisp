;;;; package.lisp -- quantities that vary in time, and networks of them.

(defpackage :ars-magna.rpl.lifted
  (:documentation "Lisp's operators as plans understand them, for ordinary code that wants them:
conditions read fluents by value, operators given a fluent return a network. Inside a plan the
operators of Common Lisp mean these without further ado.")
  (:use)
  (:export #:if #:when #:unless #:cond #:loop
           #:and #:or #:not #:null #:< #:> #:<= #:>= #:= #:+ #:- #:* #:/ #:eq #:eql #:equal))

(defpackage :ars-magna.rpl.fluents
  (:documentation "Fluents, networks of fluents, and how a change reaches those who watch. Knows
no plan.")
  (:use :cl :ars-magna.base)
  (:local-nicknames (:lifted :ars-magna.rpl.lifted))
  ;; fluent
  (:export #:create-fluent #:create-fluent-vector #:fluent #:fluent-name #:fluent-p #:fluent-pulses
           #:make-watcher #:state #:watcher #:watcher-client #:watcher-wake #:watcher-pending
           #:watcher-fluent #:watcher-p #:define-membership)
  ;; network
  (:export #:base-fluents #:depends-p #:looked-at-p #:forget-looks
           #:fluent-watchers #:fl-apply #:fl-funcall #:fluent-text
           #:fluent-value #:operand-value #:one-fluent #:truth-value #:unwatch #:watch)
  ;; realm
  (:export #:*realm* #:+root+ #:fork-realm #:leave-realm #:realm-sources #:source-realm
           #:entity #:entity-realm #:entity-like #:here #:fresh-twin #:foreign-p #:home-forked-p
           #:next-token)
  ;; home
  (:export #:*runner* #:*home-in-use* #:*on-outside-change* #:home #:home-closed-p #:home-born
           #:home-on-post
           #:home-attended-p #:home-on-change #:home-wrapper #:home-backlog #:at-home
           #:call-at-home #:in-use-p #:post #:next-entry #:posted-p)
  ;; known
  (:export #:declare-fluent-variable #:declare-pulse #:known-pulse-p #:known-fluent-variable-p
           #:known-vector-variable-p #:robots-fluent-p)
  ;; propagation
  (:export #:apply-settings #:give-back-all #:repair-fluents #:pulse #:set-value)
  ;; views
  (:export #:fl-pulsed #:fl-value-changed #:misses-nothing-p)
  ;; operators
  (:export #:lifting #:lifting-and #:lifting-or))
