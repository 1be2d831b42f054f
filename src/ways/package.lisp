;;;; package.lisp -- the ways layer: how to get from one point of a map to another.

(ars-magna.host:define-package :ars-magna.ways
  (:documentation "Ways through a map, at any angle: away from walls where there is room, round
cells found barred, repaired at little cost. Field D* of Ferguson and Stentz (2006). Uses walls and
places, but neither robots nor things.")
  (:use :cl :ars-magna.host :ars-magna.basics :ars-magna.definitions :ars-magna.copying)
  (:import-from :ars-magna.geometry #:pt #:pt-p #:make-pt #:pt-x #:pt-y)
  (:shadowing-import-from :ars-magna.world #:map)
  (:import-from :ars-magna.world #:map-p #:map-name #:map-width #:map-height #:map-flags
                #:map-places #:map-place-types #:+wall+ #:find-map #:number-pair-p
                #:place-type-name #:place-type-index #:find-place-type #:doorway))
