;;;; package.lisp -- the base layer: what every other layer stands on.

(ars-magna.host:define-package :ars-magna.base
  (:documentation "Conditions, dice, threads, messages and parameters. Names alexandria,
bordeaux-threads, closer-mop and SBCL's documented packages so that no other layer has to.")
  (:use :cl :ars-magna.host)
  (:import-from :alexandria
                #:clamp #:ensure-list #:once-only #:parse-body #:removef
                #:with-gensyms #:symbolicate #:make-keyword #:hash-table-values
                #:read-file-into-string #:starts-with-subseq #:ends-with
                #:ends-with-subseq #:define-constant #:proper-list-p
                #:parse-ordinary-lambda-list #:simple-style-warning)
  (:export #:clamp #:ensure-list #:once-only #:parse-body #:removef #:with-gensyms #:symbolicate
           #:make-keyword #:hash-table-values #:read-file-into-string #:starts-with-subseq
           #:define-constant #:proper-list-p #:parse-ordinary-lambda-list #:method-code
           #:function-arguments #:form-behind-comma #:bound-in-walk-p #:show-lambda-list
           #:nested-p #:wrap-function #:deferring-interrupts #:allowing-interrupts
           #:call-holding-interrupts #:call-open-to-interrupts #:protecting-strictly #:held-off-p
           #:calls-under-way #:disabled-hook-p #:yield-foreground #:closure-p #:reference-slots
           #:instance-slot #:closure-values #:same-code-p #:environment-p #:environment-values))
