;;;; package.lisp -- where robots went in many trials, as a picture.

(defpackage :ars-magna.trails
  (:documentation "The ways of robots over their map. Knows neither experiments nor plans.")
  (:use :cl :ars-magna.base :ars-magna.canvas)
  (:import-from :ars-magna.time #:current-simulation #:asking)
  (:import-from :ars-magna.run
                #:simulation-robots #:simulation-tick #:call-with-replay #:journal-meant
                #:journal-header #:simulation-world)
  (:import-from :ars-magna.robot
                #:robot-x #:robot-y #:robot-angle #:robot-name #:robot-hands #:robot-last-place
                #:robot-main-odometer #:odometer-estimate #:find-blueprint #:blueprint-name
                #:hand-holding)
  (:import-from :ars-magna.world #:map-width #:map-height)
  (:import-from :ars-magna.display
                #:snapshot-map #:draw-terrain #:draw-movers #:take-snapshot #:picture-kind
                #:moment-tick #:moment-text #:moment-x #:moment-y #:moments-watcher
                #:checked-moments #:in-order)
  (:import-from :ars-magna.plots #:drawing-chart #:look-color #:draw-marker #:save-chart)
  ;; trails
  (:export #:way-trial #:way-outcome #:way-points #:note-places #:ways-along
           #:straightened)
  ;; trajectory
  (:export #:save-trajectory)
  ;; picture
  (:export #:ways-chart #:part-of-map)
  ;; run-picture
  (:export #:save-run-picture))
