;;;; package.lisp -- the time layer: what happens when, and who may make it happen.

(ars-magna.host:define-package :ars-magna.time
  (:documentation "Events, resources and priorities; requests from any thread and the timeline that
they wait in; the pace of a live one. Knows nothing of worlds, robots and journals.")
  (:use :cl :ars-magna.host :ars-magna.basics :ars-magna.definitions :ars-magna.copying))
