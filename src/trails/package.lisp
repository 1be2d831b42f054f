;;;; package.lisp -- where robots went in many trials, as a picture.

(ars-magna.host:define-package :ars-magna.trails
  (:documentation "The ways of robots over their map. Knows neither experiments nor plans.")
  (:use :cl :ars-magna.host :ars-magna.basics :ars-magna.definitions :ars-magna.copying
        :ars-magna.canvas)
  (:import-from :ars-magna.time #:current-simulation)
  (:import-from :ars-magna.run
                #:simulation-robots #:simulation-tick #:call-with-replay #:replaying
                #:repeated-words
                #:journal-meant
                #:journal-header #:simulation-world)
  (:import-from :ars-magna.robot
                #:robot #:robot-x #:robot-y #:robot-angle #:robot-placements #:robot-put-x
                #:robot-put-y #:robot-name
                #:robot-hands #:robot-last-place
                #:robot-main-odometer #:odometer-estimate #:find-blueprint #:blueprint-name
                #:hand-holding)
  (:import-from :ars-magna.display
                #:snapshot-map #:snapshot-robots #:snapshot-things #:robot-image-name
                #:robot-image-x #:robot-image-y #:thing-image-x #:thing-image-y
                #:drawn-scale
                #:draw-terrain #:draw-movers #:draw-framed #:draw-names #:make-way-line
                #:draw-way-lines #:draw-way-sample #:draw-arrows #:draw-way-marks #:jumps-seen-p
                #:jumps-of #:way-seen-p
                #:call-along #:framed-text
                #:draw-jump-dots #:jump-entry
                #:draw-start #:draw-ring #:robot-entry #:sample-of-name #:turn-ink
                #:to-pixels #:box-around
                #:inked #:around #:draw-circle #:half-width
                #:overlap-p #:telling-what-breaks #:with-map-svg
                #:drawn-name #:shown-part #:snapshot-part #:pixels-of #:*picture-layers*
                #:check-map-options #:in-part #:sample-of
                #:take-snapshot #:picture-kind #:save-svg
                #:make-moment #:moment-tick #:moment-kind #:moment-code #:moment-text #:moment-x
                #:moment-y
                #:moment-robot #:moment-weight #:moment-words #:moments-watcher
                #:remarked-moments #:checked-moments #:check-kinds #:of-kinds #:in-order
                #:shown-end)
  (:import-from :ars-magna.plots #:draw-marker))
