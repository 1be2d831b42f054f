;;;; package.lisp -- the Nisp dialect, as far as the manual uses it (manual 3.1).

(defpackage :ars-magna.slots
  (:documentation "The accessors of slots by name, such as !_X for all slots x; see types.lisp.")
  (:use))

(ars-magna.host:define-package :ars-magna.nisp
  (:documentation "Nisp's typed forms, slot access, matching and reader syntax, and the registries
of types and slots that other layers fill. The package replaces LET, LOOP and IF by extended
versions. These accept everything that LET, LOOP and IF of Common Lisp accept. The code of this
layer uses the extended versions.")
  (:use :cl :ars-magna.host :ars-magna.basics :ars-magna.definitions :ars-magna.copying)
  (:shadow #:let #:loop #:if)
  (:import-from :named-readtables #:in-readtable #:find-readtable #:make-readtable
                #:readtable-name)
  (:import-from :ars-magna.geometry
                #:pt #:make-pt #:pt-x #:pt-y
                #:interval #:make-interval #:interval-min #:interval-max
                #:pt-interval #:make-pt-interval #:pt-interval-x #:pt-interval-y
                #:pt-interval-dx #:pt-interval-dy)
  (:export #:out #:\\ #:in-readtable #:readtable-name))
