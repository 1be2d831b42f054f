;;;; clim.lisp -- tests of the window, where McCLIM is to be had.

(in-package :ars-magna.tests)

(def-suite* clim :in ars-magna)

;;; The rest of these tests names McCLIM's packages, so it is loaded only after McCLIM.

(defun load-window-tests ()
  "Load the window and the tests of it; true if McCLIM was found."
  (when (asdf:find-system "mcclim" nil)
    (asdf:load-system "ars-magna/clim-tests")
    t))

(defvar *window-tests-p* (load-window-tests))

(test window.tests-need-mcclim
  (if *window-tests-p*
      (pass)
      (skip "McCLIM is not installed: the window is not tested.")))
