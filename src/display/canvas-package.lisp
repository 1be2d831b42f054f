;;;; canvas-package.lisp -- the package that users know as XLIB.

(ars-magna.host:define-package :ars-magna.canvas
  (:documentation "Drawing on anything: the part of CLX that the bodies of :graphics and of
:draw-function need, its colours, and the protocol of canvases. Manual B.1.")
  (:use :cl :ars-magna.host :ars-magna.basics :ars-magna.definitions :ars-magna.copying))
