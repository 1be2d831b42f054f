;;;; package.lisp -- the base layer: what every other layer stands on.

(defpackage :ars-magna.base
  (:documentation "Conditions, dice, threads, messages and parameters. Names alexandria
and bordeaux-threads so that no other layer has to.")
  (:use :cl)
  (:import-from :alexandria
                #:clamp #:ensure-list #:once-only #:parse-body #:removef #:when-let #:if-let
                #:with-gensyms #:symbolicate #:make-keyword #:hash-table-values
                #:read-file-into-string #:starts-with-subseq #:ends-with #:define-constant)
  ;; alexandria
  (:export #:clamp #:ensure-list #:once-only #:parse-body #:removef #:when-let #:if-let
           #:with-gensyms #:symbolicate #:make-keyword #:hash-table-values
           #:read-file-into-string #:starts-with-subseq #:define-constant)
  ;; policy
  (:export #:*hot* #:double #:finite-p #:cell-index #:tick-count #:document-functions)
  ;; public
  (:export #:public #:addition #:addition-p #:public-symbols)
  ;; conditions
  (:export #:ars-magna-error #:wrong-argument #:check-argument #:malformed-definition
           #:malformed-definition-place
           #:definition-warning #:definition-warning-text #:warn-of-definition
           #:unknown-name #:plain-name #:misuse #:reject-use)
  ;; threads
  (:export #:make-lock #:with-lock #:make-semaphore #:signal-semaphore #:wait-on-semaphore
           #:start-thread #:join-thread #:thread-alive-p #:current-thread #:spread-specials)
  ;; dice
  (:export #:dice #:make-dice #:copy-dice #:dice-state #:roll #:roll-between #:roll-within
           #:roll-index #:roll-element #:roll-gaussian #:chance)
  ;; names
  (:export #:same-name-p #:name-string #:nearest-name #:resembles-p #:reject-name #:value-equal)
  ;; variables
  (:export #:variable-name-p #:variable-forms #:known-variable-p #:local-variable-p
           #:nested-p #:variable-name-trouble)
  ;; sources, definitions
  (:export #:source-here #:source-file #:part-in-file-p #:skip-comment #:current-source
           #:*definition* #:definition-again #:make-defining #:defining-form #:reject-clause
           #:call-with-definition #:expand-definition #:call-as-definition
           #:check-function-name #:other-definition-p #:in-file-p #:missing-name #:read-value
           #:clause-place #:skip-definition #:skip-clause #:read-again)
  ;; registry
  (:export #:registry #:define-registry #:registry-objects #:register #:seal-definitions
           #:lookup-entry #:from-this-file-p #:entry-name #:entry-object #:entry-source
           #:defined-names #:find-definition #:definition-to-replace #:variable-in-use-p
           #:*kept-variables* #:undefine #:take-back #:reinstate #:become
           #:with-own-definitions #:call-with-own-definitions)
  ;; messages
  (:export #:error-set #:warning-set #:message-set #:error-display #:flush-all-errors*
           #:*message-queue* #:make-message-queue #:message-queue #:message-queue-listener
           #:message #:message-kind #:message-items #:take-messages #:message-text
           #:write-message #:write-items #:out #:*message-limit*)
  ;; user code
  (:export #:call-user-code #:*break-on-user-error*)
  ;; parameters
  (:export #:parameter #:parameter-p #:parameter-name #:parameter-default #:parameter-unit
           #:parameter-kind #:parameter-group #:parameter-sentence #:parameter-value
           #:define-parameter
           #:all-parameters #:find-parameter #:call-with-parameters #:parameter-settings
           #:check-parameters #:parameter-values #:follow-parameters
           #:clean-simulation #:dirty-simulation #:*noise-before-cleaning*)
  ;; physics: the parameters of chapter 4
  (:export #:max-speed* #:max-turn-angle* #:min-turn-angle* #:braking* #:motion-noise*
           #:robot-turn-max-error* #:robot-align-error-prob* #:robot-move-delay*
           #:robot-turn-delay* #:robot-align-delay*
           #:camera-angle-max-error* #:scan-density* #:prob-lose-track*
           #:prob-lose-false-track* #:false-desig-drift-dist* #:false-desig-drift-ang*
           #:camera-insert-miss-prob* #:camera-insert-lose-desig-prob* #:camera-move-delay*
           #:camera-align-delay* #:camera-desig-delay*
           #:type-false-pos* #:type-false-neg* #:prob-stop* #:miss-thing-prob*
           #:miss-place-prob* #:false-thing-prob* #:pixel-error-range* #:pixel-outlier-prob*
           #:no-sensor-error* #:discrete-noise-factor* #:continuous-noise-factor*
           #:standard-match-threshold*
           #:prob-miss-grasp* #:prob-grasp-lose-desig* #:hand-insert-miss-prob*
           #:hand-insert-lose-desig-prob* #:hand-move-delay* #:hand-grasp-delay*
           #:bin-close-jam-prob* #:bin-delay* #:tick-quantum*)
  ;; digest
  (:export #:digest #:make-digest #:digest-add #:digest-value))
