;;;; package.lisp -- where plans meet a robot: the interface of the manual's appendix C.

(defpackage :ars-magna.rpl-robot
  (:documentation "The rpl- commands, accessors and fluents, and running plans on a simulation.")
  (:use :cl :ars-magna.base :ars-magna.robot :ars-magna.command)
  (:import-from :ars-magna.world
                #:world-map #:*world* #:remaining-capacity #:world-has-kickers-p
                #:some-kicker #:kicker-test #:kicker-body
                #:warn-once
                #:said-p #:note-looked-after)
  (:import-from :ars-magna.time
                #:*simulation* #:resource-event #:seconds-now #:current-simulation #:asking #:live-p
                #:grab-resource #:timeline-real-p #:thinking-charged-p #:thinking-budget
                #:timeline-tick #:check-not-secluded #:check-not-over
                #:wake-owner #:begin-moment #:timeline-inbox #:agenda-pending #:*hog-seconds*
                #:hog-seconds)
  (:import-from :ars-magna.run
                #:simulation-tick #:add-observer #:remove-observer #:run-ticks #:call-as-owner
                #:robot-meant #:simulation-over #:doubt-wait
                #:simulation-seed #:simulation-plans-dice-p #:simulation-agenda #:simulation-thread
                #:simulation-timeline #:simulation-robots #:simulation-observers
                #:simulation-world #:simulation-messages #:robot-simulation
                #:*simulation-variables* #:*simulator-hooks* #:add-participant
                #:remove-participant #:participant-after-tick #:participant-after-ticks
                #:participant-origin
                #:participant-busy-p #:participant-at-work-p #:participant-reseed
                #:participant-digest #:participant-end #:participant-clock-stopped
                #:participant-copy #:participant-at-rest #:check-forkable
                #:call-as-participant-makes-way #:participant-unfinished
                #:participant-cut-off #:participant-around-p
                #:fork-simulation #:refuse-fork
                #:participant-place #:simulation-participants #:fork-p #:note-environment
                #:environment-of #:*rewind-hooks* #:*rewound-end-hooks*
                #:counterpart-here #:counterpart #:latest #:let-fork-be-kept #:note-doing
                #:simulation-past #:simulation-journal #:remark #:unremark)
  (:import-from :ars-magna.rpl
                #:create-fluent #:create-fluent-vector #:declare-fluent-variable #:declare-pulse
                #:fluent-value #:fluent-name
                #:set-value #:pulse
                #:apply-settings #:looked-at-p #:forget-looks
                #:*home-in-use* #:*runner* #:post-call #:react-to-all
                #:exhaust-reaction #:close-runner #:tell-at-rest #:advance-timers #:note-tick
                #:next-wake-time #:heard-from-outside-p #:idle-p #:set-charges
                #:make-plan-runner #:start-plan #:rest-in-tick #:stop-plan #:plan-runner
                #:plan-runner-tasks #:plan-runner-steps #:plan-runner-tick
                #:runner-note #:fail #:current-task #:task #:task-p
                #:task-over-p #:task-state #:task-result #:task-top #:task-parent #:task-path
                #:task-label #:runner-serial #:task-serial #:task-form #:task-children
                #:task-cleaning #:form-text
                #:plan-deadlocked-p #:report-deadlock #:report-stillness #:task-doomed
                #:waiting-parts #:failure-text #:missed-text #:lisp-failure
                #:text-of-plans #:advice-on-stillness #:fluents-awaited
                #:fluent-text #:note-twin #:has-twin-p #:twin-text #:pulse-of-command
                #:last-command #:last-pulse #:endless-advice
                #:+no-fluent+ #:robots-fluent-p #:plan-backtrace #:operator-called-p
                #:task-awaiting #:task-since
                #:report-end #:runner-lisps-dice #:reseed-runner #:digest-runner
                #:print-tasks #:find-procedure
                #:plan-trace #:write-trace #:valve #:make-valve #:valve-losers #:note-command
                #:with-answer #:*runner-in-use* #:*still* #:*step-plans* #:*plan-start-hooks*
                #:start-trace
                #:task-runner #:leave-plan #:runner-client #:client-forked-p
                #:hear-of-trouble #:note-seen #:*realm*
                #:give-back-all #:+root+
                #:realm-sources #:leave-realm #:source-realm #:at-home #:entity #:here
                #:task-numbered #:task-with #:blocked-p #:failure-of #:complete
                #:part-of-p #:frame-node #:frame-up #:node-form #:current-form
                #:task-level #:evaporating-p #:reasons #:decide #:withdraw #:task-frame
                #:entity-realm #:entity-like
                #:*on-outside-change* #:note-word #:task-now #:*advice-on-call* #:advice-on-goal)
  ;; fluents
  (:export #:robot-stopped* #:robot-movement-error* #:robot-angle-diff* #:robot-arrived-at*
           #:robot-place-input* #:robot-place* #:camera-input* #:camera-views*
           #:camera-designators* #:camera-error* #:camera-tracking* #:camera-tracking-error*
           #:camera-moved* #:camera-movement-error* #:hand-moved* #:hand-error* #:hand-lost*
           #:hand-inside* #:hand-grasping* #:hand-input* #:storage-bin-moved*
           #:storage-bin-error* #:storage-bin-jammer*)
  (:export #:define-fluents #:define-outcome #:all-fluent-variables)
  ;; interface, accessors
  (:export #:rpl-init-robot #:rpl-robot #:rpl-robot-valve #:rpl-robot-part #:*trace-plans*
           #:rpl-robot-speed #:rpl-robot-turn-angle #:rpl-robot-num-cameras #:rpl-robot-num-hands
           #:rpl-robot-num-bins #:rpl-camera-field-of-view #:rpl-camera-resolution
           #:rpl-camera-angle #:rpl-camera-last-view #:rpl-hand-strength
           #:rpl-storage-bin-capacity #:rpl-storage-bin-real-capacity #:rpl-storage-bin-closed?
           #:rpl-designator-data #:rpl-new-odometer #:rpl-grab-robot #:rpl-grab-camera
           #:rpl-grab-hand #:rpl-grab-bin)
  ;; commands
  (:export #:rpl-robot-set-speed #:rpl-robot-set-turn-angle #:rpl-robot-turn
           #:rpl-robot-about-face #:rpl-robot-turn-left #:rpl-robot-turn-right
           #:rpl-robot-turn-corner #:rpl-robot-align-place #:rpl-robot-go-forward
           #:rpl-robot-go-distance #:rpl-robot-goto-wall #:rpl-robot-follow-wall
           #:rpl-robot-goto-designator
           #:rpl-robot-stop #:rpl-robot-place #:rpl-camera-turn #:rpl-camera-align-place
           #:rpl-camera-align-robot #:rpl-camera-view #:rpl-camera-get-object-designator
           #:rpl-camera-get-all-object-designators #:rpl-camera-get-place-designator
           #:rpl-camera-get-all-place-designators #:rpl-camera-track #:rpl-camera-untrack
           #:rpl-camera-insert #:rpl-camera-remove #:rpl-hand-insert #:rpl-hand-insert-bin
           #:rpl-hand-remove #:rpl-hand-grasp-desig #:rpl-hand-ungrasp #:rpl-hand-grasp-check
           #:rpl-hand-track #:rpl-storage-bin-open #:rpl-storage-bin-close)
  ;; running
  (:export #:run-plan #:begin-plan #:end-plan #:plans #:*plan-limit* #:*plan-command-limit*
           #:rpl-runner)
  ;; interface, wishes and runs, for rooms above
  (:export #:*interface* #:interface-p #:interface-robot #:interface-simulation #:interface-runner
           #:interface-wishes #:holding-p #:call-with-plans #:wish #:wish-task #:wish-interface
           #:serve-wish #:add-wish #:forget-wish #:grant-wish #:wishes-in-tick #:fork-at-rest
           #:unwanted-wish-p #:call-apart #:ensure-interface #:*robot-to-drive* #:begin-in
           #:note-robot-commanded
           #:pass-until #:how-over)
  ;; seeing
  (:export #:plan-ending-p #:call-with-plans-in-use #:print-plans #:step-plan))
