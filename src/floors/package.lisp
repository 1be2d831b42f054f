;;;; package.lisp -- the floors layer: imports and exports occupancy grids.

(ars-magna.host:define-package :ars-magna.floors
  (:documentation "Import and export of occupancy grids in the format of ROS's map_server, a flat
YAML file and a PGM or PNG image; conversion between real metres and cells of maps. Names chipz.")
  (:use :cl :ars-magna.host :ars-magna.basics :ars-magna.definitions :ars-magna.copying)
  (:shadowing-import-from :ars-magna.world #:map)
  (:import-from :ars-magna.world #:map-width #:map-height #:map-flags #:map-frame
                #:map-substances #:map-substance-types #:map-parameters #:+wall+
                #:find-map #:find-map-argument
                #:defmap #:*substances* #:find-substance #:substance-name #:substance-parameter
                #:bricks))
