;;;; package.lisp -- the ways layer: how to get from one point of a map to another.

(ars-magna.host:define-package :ars-magna.ways
  (:documentation "Finds ways through a map, at any angle, that keep away from walls and avoid
barred cells. If cells change, only the affected costs are computed again. The algorithm is Field D*
of Ferguson and Stentz (2006). The layer uses walls and places, but neither robots nor things.")
  (:use :cl :ars-magna.host :ars-magna.basics :ars-magna.definitions :ars-magna.copying)
  (:import-from :ars-magna.geometry #:pt #:pt-p #:make-pt #:pt-x #:pt-y)
  (:shadowing-import-from :ars-magna.world #:map)
  (:import-from :ars-magna.world #:map-p #:map-name #:map-width #:map-height #:map-flags
                #:map-places #:map-place-types #:+wall+
                #:find-map-argument #:number-pair-p
                #:place-type-name #:place-type-index #:find-place-type #:doorway))
