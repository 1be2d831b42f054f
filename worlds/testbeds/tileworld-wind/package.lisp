;;;; package.lisp -- the package of NASA Tileworld.

(ars:define-user-package :ars-testbeds.wind
  (:documentation "NASA Tileworld: tiles of several cells, a robot that carries them, and wind.")
  (:import-from :ars-magna.base #:reject-argument)
  (:import-from :ars-magna.experiment #:check-new-game)
  (:export #:tileworld-wind #:carrier #:in-place #:blown #:bound
           #:gust-interval* #:gust-strength* #:tile-count* #:tile-cells* #:game-steps*
           #:tiles #:tile-thing #:tile-target #:tile-in-place-p #:held-tile #:step-to
           #:grasp-tile #:put-down #:rest-a-step #:game-over-p #:play))
