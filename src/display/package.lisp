;;;; package.lisp -- the display layer: what a world looks like to people.

(ars-magna.host:define-package :ars-magna.display
  (:documentation "Pictures of a robot in its world, drawn on any kind of canvas. Manual B.")
  (:use :cl :ars-magna.host :ars-magna.basics :ars-magna.definitions :ars-magna.copying
        :ars-magna.geometry :ars-magna.world :ars-magna.time :ars-magna.robot :ars-magna.run
        :ars-magna.canvas)
  (:shadowing-import-from :cl #:equal)
  (:shadowing-import-from :ars-magna.world #:map)
  (:import-from :ars-magna.command #:under-way-text #:interruption-text #:last-failure
                #:failure-code-p))
