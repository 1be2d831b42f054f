;;;; package.lisp -- the world layer: maps, places, things and what moves them.

(ars-magna.host:define-package :ars-magna.world
  (:documentation "The fixed grid (maps, place types, substances) and what changes in it
(worlds, things, kickers). Manual 2.1, 3.3 and 5.1 to 5.4.")
  (:use :cl :ars-magna.host :ars-magna.basics :ars-magna.definitions :ars-magna.copying)
  (:shadow #:map)
  (:import-from :ars-magna.nisp #:matchvar-p))
