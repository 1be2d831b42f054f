;;;; package.lisp -- the base layer: what every other layer stands on.

(defpackage :ars-magna.base
  (:documentation "Conditions, dice, threads, messages and parameters. Names alexandria,
bordeaux-threads, closer-mop and SBCL's documented packages so that no other layer has to.")
  (:use :cl :ars-magna.host)
  (:import-from :alexandria
                #:clamp #:ensure-list #:once-only #:parse-body #:removef #:when-let #:if-let
                #:with-gensyms #:symbolicate #:make-keyword #:hash-table-values
                #:read-file-into-string #:starts-with-subseq #:ends-with
                #:ends-with-subseq #:define-constant #:proper-list-p
                #:parse-ordinary-lambda-list #:simple-style-warning)
  ;; alexandria
  (:export #:clamp #:ensure-list #:once-only #:parse-body #:removef #:when-let #:if-let
           #:with-gensyms #:symbolicate #:make-keyword #:hash-table-values
           #:read-file-into-string #:starts-with-subseq #:define-constant #:proper-list-p
           #:parse-ordinary-lambda-list)
  ;; policy
  (:export #:*hot* #:compiler-note #:declaim-final #:double #:heap-bytes #:make-room #:room-p
           #:cell-index #:surely #:tick-count #:document-functions
           #:document-restarts #:all-restarts #:restart-documentation)
  ;; public
  (:export #:public #:addition #:settable #:settable-p #:addition-p #:public-symbols #:*marking-p*)
  ;; floats, globals
  (:export #:finite-p #:positive-infinity-p #:double-to-bits #:bits-to-double
           #:global-value #:define-global
           #:define-table-test)
  ;; numbers
  (:export #:+largest+ #:+largest-quantity+ #:within-reason-p #:quantity-p #:amount-p
           #:probability-p #:tick-span-p #:whole-p)
  ;; atomic
  (:export #:atomic-count #:compare-and-swap #:swap-if #:atomic-push #:atomic-incf #:atomic-decf
           #:memory-barrier)
  ;; classes, code, packages
  (:export #:define-function-class #:generic-name #:class-ancestors #:class-slot-names
           #:class-slot-types #:weak-table-p
           #:code-references #:method-code #:methods-on-class
           #:lambda-list-of #:callable-with-p #:function-file #:files-besides-functions
           #:call-as-from-file #:date-of-file
           #:package-locked-p #:lock-package #:unlock-package #:lock-violation #:locked-symbol
           #:copy-nicknames)
  ;; text
  (:export #:blank-p #:one-line #:cut #:visible #:obeyed-p)
  ;; printing
  (:export #:call-printing-plainly #:printing-plainly #:printing-words)
  ;; files, file-text, kinds-of-files, processes
  (:export #:base-directory #:native-name #:native-path #:native-path-of-directory
           #:path-called #:existing-path
           #:missing-directory #:many-files-p
           #:replace-file #:plain-file-p #:check-unprotected #:dangling-link-p #:name-in-directory
           #:file-size
           #:unusable-file-text #:shown-name
           #:+illegible+ #:encoded #:decoded #:file-text
           #:illegible-file-line #:illegible-file #:cut-file
           #:call-with-file-lock #:make-directories #:make-new-directory
           #:host-name #:process-number #:note-kind-of-file #:file-advice
           #:foreign-file-p #:check-not-foreign
           #:copy-permissions #:temporary-file-prefix #:remove-abandoned-files
           #:environment-value #:real-microseconds #:date-and-time #:run-command #:run-attached
           #:run-filter)
  ;; writing
  (:export #:call-replacing-file #:write-file-anew #:unwritten-reason)
  ;; environments
  (:export #:variable-kind #:local-variable-p #:known-variable-p #:special-variable-p
           #:local-function-p #:known-function-p #:macro-expander
           #:function-arguments #:lisps-own-p
           #:extended-environment #:evaluate-form #:form-behind-comma #:walk-form
           #:bound-in-walk-p #:expand-in-walk)
  ;; undefined
  (:export #:undefined-name #:still-undefined-p)
  ;; compiling
  (:export #:show-lambda-list #:nested-p #:keep-place #:in-source-p #:call-at-place #:at-end-of-unit
           #:call-as-unit)
  ;; wrapping
  (:export #:wrap-function)
  ;; abridging
  (:export #:abridged #:safe-text #:unqualified-text #:text-as-typed #:+more+)
  ;; conditions
  (:export #:ars-magna-error #:wrong-argument #:check-argument #:reject-argument
           #:malformed-definition #:malformed-definition-expected
           #:malformed-definition-place #:malformed-definition-clause
           #:definition-warning #:definition-warning-text #:warn-of-definition #:doubt-definition
           #:unknown-name #:reject-name #:plain-name #:misuse #:reject-use
           #:outlived #:reject-outlived)
  ;; exits
  (:export #:call-refusing-exits #:refuse-exits #:call-allowing-exits)
  ;; threads
  (:export #:make-lock #:with-lock #:call-if-free #:make-weak #:weak-value #:weak-pointer-p
           #:make-semaphore #:signal-semaphore #:wait-on-semaphore
           #:wait-a-while #:wait-patiently #:call-when-free
           #:*leaving-p* #:call-when-leaving
           #:start-thread #:own-thread-p #:join-thread #:interrupt-thread
           #:thread-alive-p
           #:current-thread #:users-thread-p #:yield-thread #:thread-name #:spread-specials)
  ;; finishing
  (:export #:in-any-case #:call-opening #:call-each)
  ;; elsewhere
  (:export #:call-telling-names #:bound-elsewhere-text #:run-elsewhere-text)
  ;; front-ends
  (:export #:*front-end* #:serve-while-waiting #:hook-of-front-end #:ask-how-to-go-on
           #:input-of-programs)
  ;; limits, debuggers
  (:export #:time-limit #:let-callers-handle #:call-with-limit
           #:deferring-interrupts #:allowing-interrupts
           #:call-holding-interrupts #:call-open-to-interrupts #:protecting-strictly #:held-off-p
           #:regain-room #:debugger-p #:foreign-hook #:answering-debugger #:calls-under-way
           #:debugger-hook #:common-debugger-hook #:disabled-hook-p
           #:*editor-gone-p*
           #:with-debugger-hook #:yield-foreground)
  ;; inquiries
  (:export #:debugger-asking #:end-inquiries #:*inquiry-hooks* #:*debugger-refused-p*)
  ;; lisp-errors
  (:export #:note-error-code #:note-dispatch-character #:variable-slip #:value-behind
           #:*function-meant*
           #:ours-called)
  ;; tests-in-code
  (:export #:*test-doubt* #:map-calls #:map-comparisons #:code-doubt)
  ;; telling
  (:export #:format-briefly #:report-briefly #:own-text #:our-text #:report-anyhow
           #:of-lines-typed-p
           #:reading-trouble #:text-of-condition #:one-line-text #:point-in-text #:hundredths
           #:editors-output)
  ;; breaking-lines
  (:export #:wrapped-text)
  ;; ordering
  (:export #:name-before-p)
  ;; trigonometry, exponentials
  (:export #:sine #:cosine #:arctangent #:exponential #:logarithm #:%logarithm #:power)
  ;; dice, random
  (:export #:dice #:make-dice #:copy-dice #:dice-state #:roll #:roll-between #:roll-within
           #:roll-index #:roll-element #:roll-gaussian #:chance #:call-with-lisps-dice
           #:*lisps-dice* #:seeded-lisps-dice #:reseed-lisps-dice #:call-with-own-lisps-dice
           #:rolling #:lisps-dice-numbers #:lisps-dice-numbers-p #:lisps-dice-of-numbers
           #:dice-rolled #:roll-back #:unheard-of-number #:tick-dice #:make-tick-dice
           #:begin-tick-dice #:*tick-dice*)
  ;; names
  (:export #:same-name-p #:nearest-name #:resembles-p #:value-equal)
  ;; keywords
  (:export #:define-with-keywords)
  ;; variables
  (:export #:users-symbol-p #:variable-name-p #:variable-forms #:variable-name-trouble)
  ;; sources, definitions
  (:export #:source-here #:source-file #:count-in-file #:part-in-file-p
           #:skip-comment #:current-source
           #:*definition* #:definition-again #:make-defining #:defining-form #:reject-clause
           #:call-with-definition #:expand-definition #:forms-or-rejection #:title
           #:call-as-definition
           #:check-function-name #:other-definition-p #:in-file-p #:missing-name #:read-value
           #:clause-place #:line-of-clause #:skip-definition #:skip-clause #:read-again)
  ;; facts
  (:export #:facts #:known-facts #:define-facts #:slots-to-show #:listed #:fact-text)
  ;; places-in-text
  (:export #:reading-place)
  ;; markup
  (:export #:write-json-string #:write-xml-text #:*entities*)
  ;; csv
  (:export #:csv-number-p #:csv-line #:csv-texts #:broken-line #:broken-line-text)
  ;; user-macros
  (:export #:define-user-macro #:advice-on-use #:strange-keyword #:test-advice #:body-advice
           #:user-macro-form #:call-blaming-form #:variable-after)
  ;; registry
  (:export #:registry #:define-registry #:registry-objects #:register
           #:*definition-listener* #:seal-definitions #:lookup-entry #:from-this-file-p
           #:entry-name #:entry-object #:entry-source #:entry-digest #:registry-entries #:users-p
           #:names-to-offer
           #:current-form-digest #:form-digest #:file-digest #:text-checksum #:name-string
           #:defined-names #:find-definition #:all-definitions #:definition-to-replace
           #:variable-in-use-p
           #:entries-meant
           #:*kept-variables* #:undefine #:take-back #:reinstate #:become
           #:with-own-definitions #:call-with-own-definitions)
  ;; messages
  (:export #:error-policy #:error-set #:warning-set #:warn-at-once #:warn-notably #:message-set
           #:error-display #:flush-all-errors*
           #:*message-queue* #:make-message-queue #:message-queue
           #:copy-message-queue #:message-queue-read-p #:message-queue-listener
           #:message-queue-error-policy
           #:message #:message-kind #:message-items #:message-asker
           #:message-robot #:message-told-p #:*robot-told-of* #:message-run
           #:*run-that-reports* #:*told-of*
           #:take-messages #:queue-message
           #:message-text #:phrase
           #:write-message #:write-items #:out #:*message-limit*)
  ;; troubles
  (:export #:user-code-error #:user-code-error-cause #:trouble-set
           #:errors-in #:forget-errors
           #:take-unsignalled #:show-unseen #:make-message #:*echo-output*
           #:drop-unsignalled #:skip-unseen #:signal-trouble
           #:message-cause #:message-queue-unsignalled)
  ;; askers
  (:export #:*asker* #:asker-note #:asker-forked-p #:*goes-on-in-forks-p* #:goes-on-in-forks-p
           #:note-of-asker #:note-text)
  ;; user code
  (:export #:call-user-code #:*break-on-user-error* #:*user-error-hooks*
           #:note-waiting #:report-break #:continue-inside
           #:user-calls #:make-user-calls #:user-calls-origin #:user-calls-count #:*user-calls*
           #:user-calls-waiting-p #:user-calls-place
           #:as-users-code #:abort-user-code #:*spoilt-by-leaving-p* #:brief-text #:text-of-origin
           #:recurring-code #:recurring-remedy
           #:report-user-error)
  ;; parameters
  (:export #:parameter #:parameter-p #:parameter-name #:parameter-symbol #:parameter-default
           #:parameter-clean #:parameter-type #:parameter-unit #:parameter-kind #:parameter-group
           #:parameter-sentence #:parameter-value #:check-parameter-value #:describe-type
           #:define-parameter
           #:all-parameters #:find-parameter #:call-with-parameters #:parameter-settings
           #:check-parameters #:call-with-parameter-values #:parameter-values #:digest-parameters
           #:follow-parameters
           #:changed-parameters
           #:clean-simulation #:dirty-simulation #:*noise-before-cleaning*)
  ;; physics: the parameters of chapter 4, and chance
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
           #:bin-close-jam-prob* #:bin-delay* #:tick-quantum*
           #:ticks-for #:noise-of-step #:per-tick-drift
           #:per-tick-probability)
  ;; digest
  (:export #:digest #:make-digest #:digest-add #:digest-word #:text-word #:digest-value)
  ;; kinds, define-kind, digesting, copying
  (:export #:define-kind #:*object-kinds* #:kind-p #:kind-of #:kind-called #:kind-name
           #:kind-slots #:all-kinds #:find-kind-name
           #:kind-slot-name #:kind-slot-role #:kind-slot-type #:kind-slot-text #:kind-slot-part-p
           #:kind-slot-reader
           #:kind-slot-writer #:object-slots #:reset #:reference #:digest-state #:digest-mention
           #:kind-slot-shared-p #:given)
  (:export #:copier #:with-copier #:closure-p #:copier-environment #:copier-variable
           #:copier-option #:copier-objects #:copying #:forked #:note-copy #:settled
           #:put-right-later #:copy-plan-value #:copy-values #:define-shared
           #:define-shared-slots #:copy-slots #:cannot-fork-value #:cannot-fork-place #:share-value
           #:leave-out-value #:make-no-fork #:holds-p #:reference-slots #:instance-slot
           #:cannot-fork #:closure-values #:same-code-p #:environment-p #:environment-values)
  ;; fields
  (:export #:field-name #:field-kept-p #:field-reader #:field-writer #:field-initial
           #:fields-of-type #:blank-object #:note-lasting #:lasting-name #:lasting-function)
  ;; contradictions
  (:export #:contradiction #:contradict #:must-hold #:proper-list-of-p)
  ;; argument-types, operators
  (:export #:define-argument-type #:argument-type-text #:argument-of-type-p #:find-argument-type
           #:argument-type-like #:trouble-with
           #:perhaps-degrees-p #:degrees-advice
           #:check-of-type #:operator-name #:operator-function #:operator-types
           #:define-operator #:find-operator #:check-operands))
