;;;; package.lisp -- the run layer: worlds with robots in them, as time goes by.

(ars-magna.host:define-package :ars-magna.run
  (:documentation "A run: its tick, its journal and replay, its digest; headless or live, and what
takes part in it. Manual 2.3 and appendix A.")
  (:use :cl :ars-magna.host :ars-magna.basics :ars-magna.definitions :ars-magna.copying
        :ars-magna.world :ars-magna.time :ars-magna.robot :ars-magna.command)
  (:import-from :ars-magna.geometry #:pt #:interval #:pt-interval)
  (:shadowing-import-from :cl #:equal)
  (:shadowing-import-from :ars-magna.world #:map))
