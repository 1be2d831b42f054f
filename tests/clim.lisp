;;;; clim.lisp -- tests of the window, where McCLIM is to be had.

(in-package :ars-magna.tests)

(def-suite* clim :in ars-magna)

;;; The rest of these tests, ars-magna/clim-tests, names McCLIM's packages: it is loaded besides
;;; where McCLIM is found.

(test window.tests-need-mcclim
  (if (find-package :ars-magna.clim)
      (pass)
      (skip "McCLIM is not installed: the window is not tested.")))
