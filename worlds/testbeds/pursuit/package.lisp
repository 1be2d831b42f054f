;;;; package.lisp -- the package of pursuit.

(ars:define-user-package :ars-pursuit
  (:documentation "The testbed of pursuit: predators that model one another surround a prey.")
  (:import-from :ars-magna.base #:reject-argument)
  (:export #:pursuit #:prey #:predator-1 #:predator-2 #:predator-3 #:predator-4 #:predator-5
           #:predator-6 #:predators* #:order* #:contested* #:prey-stays* #:metric* #:diagonal*
           #:quadrant-weight* #:ties* #:time-limit* #:capture-time #:captured #:least-time
           #:predators #:current-cells #:next-cell #:cells-after #:distance-to #:quadrants-held
           #:captured-p #:game-over-p #:draw-move #:modelled-moves #:play-pursuit #:hunt))
