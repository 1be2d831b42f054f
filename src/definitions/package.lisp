;;;; package.lisp -- the layer of definitions: what is defined by name, once, for all who ask.

(ars-magna.host:define-package :ars-magna.definitions
  (:documentation "Registries of what users and the simulator define, kinds of objects, parameters,
operators and types of arguments; messages, and calling what users wrote.")
  (:use :cl :ars-magna.host :ars-magna.basics))
