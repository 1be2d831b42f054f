;;;; package.lisp -- the robot layer: robots and their parts, what they sense, how they move.

(defpackage :ars-magna.robot
  (:documentation "Robots and their parts, odometers, motion and place sensing; designators, views
and tracks. Manual 2.2, 3.2.2, 3.4 and 5.2.")
  (:use :cl :ars-magna.base :ars-magna.geometry :ars-magna.world :ars-magna.time)
  (:shadowing-import-from :cl #:equal)
  (:shadowing-import-from :ars-magna.world #:map)
  ;; parts
  (:export #:robot #:robot-p #:robot-name #:robot-blueprint #:robot-world #:robot-retired
           #:check-in-run
           #:robot-enders #:retire-robot #:close-robot
           #:*robots* #:all-blueprints #:find-blueprint #:blueprint-robot #:blueprint-x
           #:blueprint-y
           #:make-robot #:settle-robot #:resident-p
           #:robot-of-blueprint #:start-trouble
           #:robot-x #:robot-y #:robot-angle #:robot-cos #:robot-sin #:robot-position
           #:robot-speed #:robot-turn-angle #:robot-cameras #:robot-hands #:robot-bins
           #:robot-last-place #:robot-drove-tick #:robot-failure #:robot-designators
           #:robot-camera #:robot-hand #:robot-storage-bin #:robot-part #:robot-parts
           #:robot-resources #:robot-mind #:mind-p #:mind-robot
           #:parts-of-kind #:robot-sensors #:robot-ended-tracks
           #:part #:part-p #:part-robot #:part-index #:part-location
           #:camera #:camera-p #:camera-robot #:camera-index #:camera-field-of-view
           #:camera-resolution #:camera-angle #:camera-location #:camera-last-view
           #:camera-last-view-tick
           #:camera-tracking
           #:hand #:hand-p #:hand-robot #:hand-index #:hand-strength #:hand-location
           #:hand-contents #:hand-holding #:unsettle #:hand-way-in
           #:storage-bin #:storage-bin-p #:storage-bin-robot #:storage-bin-index
           #:storage-bin-capacity #:storage-bin-closed-p #:storage-bin-contents)
  (:export #:world-tick #:ensure-timeline)
  ;; planned-way
  (:export #:publish-way #:robot-planned-way #:robot-way-left)
  ;; odometer
  (:export #:odometer #:odometer-p #:odometer-name #:odometer-robot #:odometer-estimate
           #:odometer-origin-angle #:make-odometer #:robot-main-odometer
           #:robot-odometer #:robot-odometers #:reset-odometer #:reset-odometer-pos
           #:reset-odometer-ang #:get-odometer-pos #:get-odometer-ang)
  ;; motion
  (:export #:set-robot-pose #:robot-placements #:robot-put-x #:robot-put-y
           #:set-robot-angle #:drive-tick #:coast-tick #:turn-tick
           #:robot-speed-now #:standing-p #:longest-step #:step-now
           #:robot-turn-angle-now #:robot-moved
           #:robot-turned-low #:robot-turned-high #:begin-movement #:robot-last-move
           #:robot-last-move-estimate
           #:robot-cell-index)
  ;; reach
  (:export #:within-reach-p #:in-same-cell-p #:reached-p)
  ;; designator
  (:export #:designator #:designator-p #:designator-type #:designator-angle #:designator-data
           #:designator-robot #:designator-serial #:designator-number #:designator-denotation
           #:designator-distance #:designator-valid-p #:designator-x #:designator-y
           #:designator-location #:find-designator #:*robot-meant*
           #:live-designators #:designators-on
           #:*designator-limit* #:thing-space #:designator-position
           #:designator-local-p*)
  ;; sight, tracks
  (:export #:line-clear-p #:in-sight-p
           #:camera-tracks #:tracking-p #:tracking-cameras #:tracked-p #:end-track
           #:drop-designator #:part-moved #:add-designator)
  ;; noise, matching, scanning, views, tending
  (:export #:own-symbol #:reading-reliability #:reading-deviation #:read-attribute #:angle-error
           #:specification-p #:specification-trouble #:notice-probability #:sighting
           #:sighting-p
           #:designate #:look-for-things #:tend-tracks #:tracks-busy-p
           #:track #:track-operation #:track-ended #:serial-designator #:make-designator
           #:look-for-places #:camera-heading #:take-view #:start-track #:trackable-p
           #:out-of-sight-p
           #:approaching-p #:end-on-arrival #:distance-to #:bearing-to)
  ;; inside
  (:export #:in-location #:outer-location #:inside-p #:part-inside #:part-reaches-p
           #:part-reaches-bin-p #:take-up #:set-down #:move-part #:space-around #:settle-parts
           #:settle-robots)
  ;; places
  (:export #:robot-place-here #:sense-place-type #:canonical-directions #:nearest-direction)
  ;; blueprint, making
  (:export #:defrobot #:define-robot #:find-robot #:all-robots
           #:blueprint #:blueprint-name #:blueprint-map #:blueprint-angle #:blueprint-cameras
           #:blueprint-hands #:blueprint-bins #:blueprint-parts)
  ;; own-changes
  (:export #:place-robot)
  ;; soundness
  (:export #:check-robot))
