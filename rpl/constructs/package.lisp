;;;; package.lisp -- the constructs that the plan language adds to Lisp.

(ars-magna.host:define-package :ars-magna.rpl.constructs
  (:documentation "The constructs of RPL (manual, appendices C and D). Each construct is one form,
DEFINE-CONSTRUCT, which also exports its name.")
  (:use :cl :ars-magna.host :ars-magna.basics :ars-magna.definitions :ars-magna.copying
        :ars-magna.rpl.fluents :ars-magna.rpl.tasks :ars-magna.rpl.language))
