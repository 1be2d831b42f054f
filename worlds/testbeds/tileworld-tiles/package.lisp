;;;; package.lisp -- the package of Tileworld with tiles.

(ars:define-user-package :ars-testbeds.tiles
  (:documentation "Tileworld with tiles to push, holes of several cells, and obstacles.")
  (:import-from :ars-magna.base #:reject-argument)
  (:import-from :ars-magna.experiment #:check-new-game)
  (:export #:tileworld-tiles #:pusher #:share #:filled #:bound
           #:hole-interval* #:hole-life* #:hole-cells* #:score-spread* #:soft-bounds*
           #:tile-interval* #:tile-life* #:obstacle-interval* #:obstacle-life*
           #:deliberation-time* #:steps*
           #:holes #:hole-id #:hole-cells #:hole-worth #:tiles #:obstacles #:utility #:find-hole
           #:plan-push #:way-to-fill #:push-to #:spend-steps #:game-over-p #:play))
