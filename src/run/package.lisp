;;;; package.lisp -- the run layer: runs of worlds with robots in them.

(ars-magna.host:define-package :ars-magna.run
  (:documentation "A run, headless or live: its tick, journal and replay, digest, forks and
participants. Manual 2.3 and appendix A.")
  (:use :cl :ars-magna.host :ars-magna.basics :ars-magna.definitions :ars-magna.copying
        :ars-magna.world :ars-magna.time :ars-magna.robot :ars-magna.command)
  (:import-from :ars-magna.geometry #:pt #:interval #:pt-interval)
  (:shadowing-import-from :cl #:equal)
  (:shadowing-import-from :ars-magna.world #:map))
