;;;; package.lisp -- charts of numbers.

(defpackage :ars-magna.plots
  (:documentation "Charts of numbers and words on our own canvas, to be saved as SVG or PNG. Knows
no experiment and no robot. Each chart is a function that returns an SVG document as a string.")
  (:use :cl :ars-magna.base :ars-magna.canvas)
  (:import-from :ars-magna.display #:picture-kind #:save-svg)
  ;; figures
  (:export #:figure-text #:power-of-ten)
  ;; charts
  (:export #:line-chart #:survival-chart #:difference-chart #:measure-chart)
  ;; looks
  (:export #:draw-marker)
  ;; saving
  (:export #:save-chart))
