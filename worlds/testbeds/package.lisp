;;;; package.lisp -- the package of the shipped testbeds.

(ars:define-user-package :ars-testbeds
  (:documentation "Testbeds: worlds with rules, knobs, scores and agents, written as you would write
  your own.")
  ;; Tileworld with holes only. Agents are named in the testbed.
  (:export #:tileworld #:tiler #:dynamism* #:planning-time* #:holes* #:directions*
           #:effectiveness #:filled
           #:open-holes #:hole-score #:steps-to #:game-over-p #:plan-move #:step-towards
           #:spend-steps #:play-holes))
