;;;; package.lisp -- the time layer: when events happen, and which thread may run them.

(ars-magna.host:define-package :ars-magna.time
  (:documentation "Events, resources and priorities; requests from any thread, and the timeline in
which they wait; the pace of a live run. This layer does not use worlds, robots or journals.")
  (:use :cl :ars-magna.host :ars-magna.basics :ars-magna.definitions :ars-magna.copying))
