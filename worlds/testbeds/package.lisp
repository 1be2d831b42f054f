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
