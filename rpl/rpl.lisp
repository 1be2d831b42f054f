;;;; rpl.lisp -- the plan language in one package: what its rooms export.

(uiop:define-package :ars-magna.rpl
  (:documentation "RPL (manual, appendices C and D) whole: fluents, tasks, language, constructs,
seeing. Knows no simulator. Each name lives in the package of its room.")
  (:use-reexport :ars-magna.rpl.fluents :ars-magna.rpl.tasks :ars-magna.rpl.language
                 :ars-magna.rpl.constructs :ars-magna.rpl.seeing))
