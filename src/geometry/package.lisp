;;;; package.lisp -- the geometry layer: points, intervals and angles (manual 3.2.1).

(ars-magna.host:define-package :ars-magna.geometry
  (:documentation "Points, intervals and point intervals with their arithmetic, and angles. The
package has its own EQUAL, which compares points and intervals by value.")
  (:use :cl :ars-magna.host :ars-magna.basics :ars-magna.definitions :ars-magna.copying)
  (:shadow #:equal))
