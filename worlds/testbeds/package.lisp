;;;; package.lisp -- the package of the shipped testbeds.

(ars:define-user-package :ars-testbeds
  (:documentation "Testbeds: worlds with rules, knobs, scores and agents, written as you would write
  your own.")
  ;; Tileworld with holes only. Agents are named in the testbed.
  (:export #:tileworld #:tiler #:dynamism* #:planning-time* #:holes* #:directions*
           #:effectiveness #:filled
           #:open-holes #:hole-score #:steps-to #:game-over-p #:plan-move #:step-towards
           #:spend-steps #:play-holes))

(ars:define-user-package :ars-testbeds.tiles
  (:documentation "Tileworld with tiles to push, holes of several cells, and obstacles.")
  (:export #:tileworld-tiles #:pusher #:share #:filled #:bound
           #:hole-interval* #:hole-life* #:hole-cells* #:score-spread* #:soft-bounds*
           #:tile-interval* #:tile-life* #:obstacle-interval* #:obstacle-life*
           #:deliberation-time* #:steps*
           #:holes #:hole-id #:hole-cells #:hole-worth #:tiles #:obstacles #:utility #:find-hole
           #:plan-push #:way-to-fill #:push-to #:spend-steps #:game-over-p #:play))

(ars:define-user-package :ars-testbeds.wind
  (:documentation "NASA Tileworld: tiles of several cells, a robot that carries them, and wind.")
  (:export #:tileworld-wind #:carrier #:in-place #:blown #:bound
           #:gust-interval* #:gust-strength* #:tile-count* #:tile-cells* #:game-steps*
           #:tiles #:tile-thing #:tile-target #:tile-in-place-p #:held-tile #:step-to
           #:grasp-tile #:put-down #:rest-a-step #:game-over-p #:play))

(ars:define-user-package :ars-testbeds.trucks
  (:documentation "Truckworld: a truck delivers parcels along roads, in weather, with clumsy arms.")
  ;; What an extension of the simulator uses: worlds/how-to/extend.
  (:import-from :ars-magna.command #:define-command #:fail-with #:go-on #:end-operation
                #:operation-resource #:operation-arguments #:operation-subject)
  (:import-from :ars-magna.robot #:drive-tick #:set-robot-angle)
  (:import-from :ars-magna.rpl-robot #:define-fluents #:define-outcome)
  (:import-from :ars-magna.base #:define-argument-type)
  (:import-from :ars-rap #:define-rap #:define-memory-rule #:rap-failed #:memory-add
                #:memory-delete #:memory-set #:memory-query #:install-goal #:remove-goal
                #:agenda-goals #:work-on-agenda)
  (:export #:truckworld #:truck #:country #:play
           #:worth-delivered #:delivered #:dropped #:fuel-used #:bound
           #:game-time* #:parcel-interval* #:deadline-time* #:rain-share* #:slip-prob*
           #:arm-strength* #:clumsiness* #:scan-noise* #:tank-size* #:block-interval*
           #:fire-interval* #:handling-time* #:scan-time* #:atomic*
           #:move-truck #:load-parcel #:unload-parcel #:scan-place #:refuel-truck #:spend-time
           #:rpl-move-truck #:rpl-load-parcel #:rpl-unload-parcel #:rpl-scan-place
           #:rpl-refuel-truck #:rpl-spend-time #:truck-moved* #:truck-error* #:arm-moved*
           #:arm-error* #:scan-ended* #:scan-reports*
           #:here #:depots #:pumps #:neighbours #:find-road #:raining-p #:wetness #:fuel #:cargo
           #:game-over-p #:road-speed #:road-fuel #:slip-chance #:drop-chance #:miss-chance
           #:work #:choose-by-time #:time-cost))
