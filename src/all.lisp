;;;; all.lisp -- what the packages ARS and NISP export besides the names of the core.

(in-package :ars-magna.faces)

(export-marked-names)
(lock-packages)
