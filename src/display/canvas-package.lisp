;;;; canvas-package.lisp -- the package that users know as XLIB.

(ars-magna.host:define-package :ars-magna.canvas
  (:documentation "The drawing functions of CLX that :graphics and :draw-function bodies use, the
manual's colours, and the protocol of canvases, which are windows or files. Manual B.1.")
  (:use :cl :ars-magna.host :ars-magna.basics :ars-magna.definitions :ars-magna.copying))
