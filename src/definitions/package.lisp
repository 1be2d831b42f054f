;;;; package.lisp -- the layer of definitions: everything that is defined by name.

(ars-magna.host:define-package :ars-magna.definitions
  (:documentation "Registries of definitions, kinds of objects, parameters, operators and argument
types; messages; calling users' code.")
  (:use :cl :ars-magna.host :ars-magna.basics))
