;;;; package.lisp -- the robot layer: robots and their parts, what they sense, how they move.

(ars-magna.host:define-package :ars-magna.robot
  (:documentation "Robots and their parts, odometers, motion and place sensing; designators, views
and tracks. Manual 2.2, 3.2.2, 3.4 and 5.2.")
  (:use :cl :ars-magna.host :ars-magna.basics :ars-magna.definitions :ars-magna.copying
        :ars-magna.geometry :ars-magna.world :ars-magna.time)
  (:shadowing-import-from :cl #:equal)
  (:shadowing-import-from :ars-magna.world #:map))
