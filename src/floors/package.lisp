;;;; package.lisp -- the floors layer: maps from elsewhere, and ours for others.

(ars-magna.host:define-package :ars-magna.floors
  (:documentation "Occupancy grids as ROS's map_server keeps them, a flat YAML file and an image,
PGM or PNG: read as maps, written from maps, and the way between their metres and our cells. Names
chipz.")
  (:use :cl :ars-magna.host :ars-magna.basics :ars-magna.definitions :ars-magna.copying)
  (:shadowing-import-from :ars-magna.world #:map)
  (:import-from :ars-magna.world #:map-width #:map-height #:map-flags #:map-frame
                #:map-substances #:map-substance-types #:map-parameters #:+wall+ #:find-map
                #:defmap #:*substances* #:find-substance #:substance-name #:substance-parameter
                #:bricks))
