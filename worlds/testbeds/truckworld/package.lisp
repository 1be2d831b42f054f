;;;; package.lisp -- the package of Truckworld.

(ars:define-user-package :ars-testbeds.trucks
  (:documentation "Truckworld: a truck delivers parcels along roads, in weather, with clumsy arms.")
  ;; What an extension of the simulator uses: worlds/how-to/extend.
  (:import-from :ars-magna.command #:define-command #:fail-with #:go-on #:end-operation
                #:operation-resource #:operation-arguments #:operation-subject)
  (:import-from :ars-magna.robot #:drive-tick #:set-robot-angle)
  (:import-from :ars-magna.rpl-robot #:define-fluents #:define-outcome)
  (:import-from :ars-magna.base #:define-argument-type #:check-argument #:reject-use)
  (:import-from :ars-magna.experiment #:check-new-game)
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
           #:work #:choose-by-time #:time-cost
           #:road-length #:cost-between #:next-place #:beliefs #:last-scan #:found-blocked-p))
