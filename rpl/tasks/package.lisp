;;;; package.lisp -- running plans: tasks, how they run, wait and end, and in which order.

(ars-magna.host:define-package :ars-magna.rpl.tasks
  (:documentation "Plans are cooperative tasks of one thread. A task runs nodes, a plan's
expressions, as a chain of frames on the heap; a runner lets tasks react. Knows neither the text of
plans nor a simulator.")
  (:use :cl :ars-magna.host :ars-magna.basics :ars-magna.definitions :ars-magna.copying
        :ars-magna.rpl.fluents))
