;;;; package.lisp -- running plans: tasks, how they run, wait and end, and in which order.

(ars-magna.host:define-package :ars-magna.rpl.tasks
  (:documentation "Plans are cooperative tasks of one thread. A task runs nodes, the expressions of
a plan, as a chain of frames on the heap. A plan runner lets tasks react. This package depends
neither on the text of plans nor on the simulator.")
  (:use :cl :ars-magna.host :ars-magna.basics :ars-magna.definitions :ars-magna.copying
        :ars-magna.rpl.fluents))
