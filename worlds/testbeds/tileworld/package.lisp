;;;; package.lisp -- the package of Tileworld with holes only.

(ars:define-user-package :ars-testbeds
  (:documentation "Tileworld with holes only: holes open and close, and an agent goes to them.")
  (:import-from :ars-magna.base #:reject-argument)
  (:export #:tileworld #:tiler #:dynamism* #:planning-time* #:holes* #:directions*
           #:effectiveness #:filled
           #:open-holes #:hole-score #:steps-to #:game-over-p #:plan-move #:step-towards
           #:spend-steps #:play-holes))
