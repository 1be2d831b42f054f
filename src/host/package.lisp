;;;; package.lisp -- the host layer: everything of SBCL that its manual does not document.

(defpackage :ars-magna.host
  (:documentation "What the simulator needs of SBCL beyond its documented packages, one idea per
file. No other folder names such parts of SBCL.")
  (:use :cl)
  ;; versions
  (:export #:untried-host-text)
  ;; wrapping
  (:export #:wrap-function #:unwrap-function #:wrapped-p)
  ;; floats
  (:export #:double-high-bits #:double-bits #:make-double #:make-single)
  ;; reports
  (:export #:*report-addition*)
  ;; memory
  (:export #:octets-before-garbage #:scrub-stack #:dynamic-usage #:collections)
  ;; stacks
  (:export #:restore-stack)
  ;; interrupts
  (:export #:deferring-interrupts #:allowing-interrupts #:waiting #:held-off-p #:protecting-strictly
           #:call-allowing-interrupts #:call-holding-interrupts
           #:call-open-to-interrupts #:with-deadline #:deadline-passed)
  ;; instances
  (:export #:reference-slots #:layout-of #:layout-number #:instance-slot #:copy-condition)
  ;; closures, interpreter
  (:export #:closure-p #:closure-values #:copy-closure #:replace-closure-values
           #:cell-p #:cell-value #:exit-cell-p #:make-cell
           #:environment-p #:environment-values #:fixed-slot-p)
  ;; code
  (:export #:code-constants #:constant-meant #:method-code #:declared-lambda-list
           #:same-code-p
           #:structure-reader-p
           #:source-at)
  ;; environments
  (:export #:function-arguments #:form-behind-comma #:user-type-p #:walk-expressions
           #:bound-in-walk-p #:variables-of-walk)
  ;; compiler
  (:export #:show-lambda-list #:nested-p #:place-of #:set-place #:call-with-current-place
           #:positions-of-forms #:edited-file #:error-context #:call-with-error-context
           #:call-as-compiler #:call-as-other-file #:wrap-compilation-units #:wrap-unit-summaries
           #:context-original-form)
  ;; reading
  (:export #:form-start #:line-reached #:encapsulated-condition)
  ;; random-state
  (:export #:words #:words-of-state #:fill-words #:wrap-renewal)
  ;; debugger
  (:export #:calls-under-way #:disabled-hook-p #:take-foreground #:yield-foreground)
  ;; streams
  (:export #:octet-input #:text-output #:descriptor-stream #:input-within-p)
  ;; signals
  (:export #:user-interrupt #:signal-user-interrupt #:call-on-interrupt #:call-on-continuing
           #:die-of-interrupts
           #:die-of-termination)
  ;; terminal
  (:export #:rows-and-columns #:char-width))
