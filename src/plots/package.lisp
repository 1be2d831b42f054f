;;;; package.lisp -- charts of numbers.

(ars-magna.host:define-package :ars-magna.plots
  (:documentation "Charts of numbers and words, as SVG or PNG, independent of experiments and
robots. Each chart is a function that returns an SVG document as a string.")
  (:use :cl :ars-magna.host :ars-magna.basics :ars-magna.definitions :ars-magna.copying
        :ars-magna.canvas)
  (:import-from :ars-magna.display #:nth-cyclic #:picture-kind #:save-svg))
