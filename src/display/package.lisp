;;;; package.lisp -- the display layer: what a world looks like to people.

(defpackage :ars-magna.display
  (:documentation "Pictures of a robot in its world: what is drawn, on whatever canvas. Manual B.")
  (:use :cl :ars-magna.base :ars-magna.geometry :ars-magna.world :ars-magna.time
        :ars-magna.robot :ars-magna.run :ars-magna.canvas)
  (:shadowing-import-from :cl #:equal)
  (:shadowing-import-from :ars-magna.world #:map)
  (:import-from :ars-magna.command #:under-way-text #:interruption-text #:last-failure
                #:trouble-p)
  ;; text-map
  (:export #:text-map #:text-layers)
  ;; history
  (:export #:history #:history-of #:keep-history)
  ;; snapshot
  (:export #:snapshot #:take-snapshot #:snapshot-of #:snapshot-tick #:snapshot-map
           #:snapshot-things #:snapshot-robots #:snapshot-robot #:thing-image #:robot-image
           #:robot-image-name #:robot-image-x #:robot-image-y #:robot-image-designators)
  (:export #:thing-image-thing #:thing-image-x #:thing-image-y #:thing-image-attributes
           #:thing-image-location
           #:robot-image-angle #:robot-image-cameras #:robot-image-hands #:robot-image-bins
           #:camera-image #:camera-image-index #:camera-image-track
           #:hand-image #:hand-image-index #:hand-image-contents #:hand-image-location
           #:bin-image #:bin-image-index #:bin-image-closed-p #:bin-image-contents
           #:designator-image #:designator-image-number #:designator-image-denotation)
  ;; subjects, contents
  (:export #:describe-subject #:snapshot-content #:display-content)
  ;; layers
  (:export #:*picture-layers* #:picture-layers #:layer-title #:layer-documentation
           #:define-layer #:layer-named #:text-layer-named #:layer-words)
  ;; inks, user-drawing, terrain, names, world-display, legend, scales, margins, way-picture
  ;; and displays
  (:export #:draw-terrain #:draw-movers #:draw-world #:users-scale #:check-map-options
           #:in-part #:draw-framed #:with-map-svg #:drawn-scale #:sample-of
           #:turn-ink #:draw-ring #:robot-entry #:sample-of-name
           #:robot-radius #:drawn-name #:draw-names
           #:telling-what-breaks #:lines-within #:make-way-line #:draw-way-lines #:draw-way-sample
           #:draw-arrows
           #:draw-way-marks
           #:jumps-seen-p #:jumps-of #:way-seen-p #:call-along #:draw-jump-dots #:jump-entry
           #:draw-start
           #:way-entry #:to-pixels #:pixels-of #:shown-part #:snapshot-part
           #:inked #:around #:draw-circle #:half-width
           #:box-around #:overlap-p #:draw-view-margins #:view-edges
           #:draw-display #:display-title #:+displays+)
  ;; moments
  (:export #:moment-p #:moment-tick #:moment-kind #:moment-text #:moment-x #:moment-y
           #:moment-robot #:make-moment #:moments-watcher #:remarked-moments #:checked-moments
           #:check-kinds #:of-kinds #:in-order #:moment-weight #:moment-words #:journal-moments)
  ;; picture, animation
  (:export #:picture-scale)
  (:export #:picture-kind #:save-svg #:save-picture #:save-snapshot #:svg-picture #:save-animation
           #:*frame-hook* #:shown-end #:save-way-picture)
  ;; opening
  (:export #:open-display #:*display-opener* #:*displays-waiter* #:announce-display))
