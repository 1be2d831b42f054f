;;;; saving.lisp -- a chart as a file.

(in-package :ars-magna.plots)

(export '(save-chart))

(defun save-chart (file chart)
  "Save CHART, an SVG document that a function such as LINE-CHART has returned, in FILE, replacing
it: SVG or, where the program rsvg-convert is installed, PNG, as its name ends. Return the file's
truename. Signals WRONG-ARGUMENT, and MISUSE without that program."
  (check-argument save-chart chart (stringp chart) "what a function such as LINE-CHART returns")
  (save-svg chart file (picture-kind 'save-chart file)))
