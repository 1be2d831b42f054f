;;;; package.lisp -- the command layer: what a program can tell a robot to do.

(ars-magna.host:define-package :ars-magna.command
  (:documentation "DEFINE-COMMAND, and the robot's commands by family. Manual 3.1 and 3.4 to 3.6.")
  (:use :cl :ars-magna.host :ars-magna.basics :ars-magna.definitions :ars-magna.copying
        :ars-magna.geometry :ars-magna.world :ars-magna.time :ars-magna.robot)
  (:shadowing-import-from :cl #:equal)
  (:shadowing-import-from :ars-magna.world #:map)
  (:import-from :ars-magna.nisp #:matchvar-p #:matchvar-name))
