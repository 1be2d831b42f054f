;;;; package.lisp -- the geometry layer: points, intervals and angles (manual 3.2.1).

(defpackage :ars-magna.geometry
  (:documentation "Points, intervals and point intervals with their arithmetic, and angles.
Shadows EQUAL, which compares these by value.")
  (:use :cl :ars-magna.base)
  (:shadow #:equal)
  ;; types
  (:export #:pt #:pt-p #:make-pt #:pt-x #:pt-y #:set-pt!
           #:interval #:interval-p #:make-interval #:interval-min #:interval-max #:set-interval!
           #:pt-interval #:pt-interval-p #:make-pt-interval #:pt-interval-x #:pt-interval-y
           #:pt-interval-dx #:pt-interval-dy #:set-pt-interval! #:copy-obj #:equal)
  ;; points
  (:export #:add #:add! #:subtract #:subtract! #:neg #:neg! #:mul #:mul! #:dist #:norm)
  ;; intervals
  (:export #:interval-intersect? #:interval-subset? #:interval-intersect #:interval-intersect!
           #:interval-width #:interval-dist #:interval-overlap-width #:interval-lbi
           #:interval-lbi! #:add-to-lbi #:add-to-lbi! #:nominal #:grow-interval
           #:grow-interval! #:less #:greater #:in-interval #:interval-lift #:lift-lbi)
  ;; angles
  (:export #:2pi #:origin* #:atan2 #:angle-difference #:nearest-angle))
