;;;; clim.lisp -- tests of the window, if McCLIM is available.

(in-package :ars-magna.tests)

(def-suite* clim :in ars-magna)

;;; The rest of these tests, ars-magna/clim-tests, names McCLIM's packages. It is loaded only if
;;; McCLIM is found.

(test window.tests-need-mcclim
  (if (find-package :ars-magna.clim)
      (pass)
      (skip "McCLIM is not installed: the window is not tested.")))
