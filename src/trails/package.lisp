;;;; package.lisp -- where robots went in many trials, as a picture.

(ars-magna.host:define-package :ars-magna.trails
  (:documentation "Pictures and tables of the ways of robots. No experiments or plans are needed.")
  (:use :cl :ars-magna.host :ars-magna.basics :ars-magna.definitions :ars-magna.copying
        :ars-magna.time :ars-magna.robot :ars-magna.run :ars-magna.canvas :ars-magna.display)
  (:import-from :ars-magna.plots #:draw-marker))
