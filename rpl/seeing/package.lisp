;;;; package.lisp -- inspecting plans that run, and have run.

(ars-magna.host:define-package :ars-magna.rpl.seeing
  (:documentation "Shows plans: tasks with their stacks and variables, how and why tasks ended, and
plans in the debugger. Changes nothing.")
  (:use :cl :ars-magna.host :ars-magna.basics :ars-magna.definitions :ars-magna.copying
        :ars-magna.rpl.fluents :ars-magna.rpl.tasks :ars-magna.rpl.language
        :ars-magna.rpl.constructs))
