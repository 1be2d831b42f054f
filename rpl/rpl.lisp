;;;; rpl.lisp -- the plan language in one package: all exports of its folders.

(uiop:define-package :ars-magna.rpl
  (:documentation "All of RPL (manual, appendices C and D): fluents, tasks, language, constructs,
seeing. This package does not depend on the simulator. Each symbol belongs to the package of its
folder.")
  (:use-reexport :ars-magna.rpl.fluents :ars-magna.rpl.tasks :ars-magna.rpl.language
                 :ars-magna.rpl.constructs :ars-magna.rpl.seeing))
