;;;; rap-agenda.lisp -- the agenda: tasks of goals, deadlines, priorities, robots.

(in-package :ars-magna.tests.rap)

(in-suite ars-magna.tests::rap)
