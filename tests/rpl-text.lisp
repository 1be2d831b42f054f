;;;; rpl-text.lisp -- what is said of a plan's text before it runs, and to those who look it up.

(in-package :ars-magna.tests)
(in-suite rpl)
