;;;; page.lisp -- what all charts have: a margin, a title, and a document that is saved.

(in-package :ars-magna.plots)

(export '(save-chart))

(defconstant +margin+ 16 "How much is left free around a chart, in pixels.")

(defun check-size (width height)
  (check-argument chart width (whole-p width 300 10000)
                  "an integer from 300 to 10000, in pixels")
  (check-argument chart height (whole-p height 200 10000)
                  "an integer from 200 to 10000, in pixels"))

;;; Title and subtitle: a heading is a list of both, each a list of lines.

(defun plan-heading (title subtitle width)
  (let ((room (- width (* 2 +margin+))))
    (list (wrapped title room :size 15 :bold-p t) (wrapped subtitle room))))

(defun heading-bottom (heading)
  (+ +margin+ (* 19 (length (first heading))) (lines-height (second heading))))

(defun draw-heading (canvas heading)
  (destructuring-bind (title subtitle) heading
    (let ((y (write-lines canvas +margin+ (+ +margin+ 13) title :size 15 :step 19 :bold-p t)))
      (write-lines canvas +margin+ (- y 2) subtitle :color +faint-ink+))))

;;; The document.

(defun page-svg (draw width height)
  "Return what the function DRAW draws on a canvas as an SVG document, as a string."
  (with-output-to-string (stream)
    (with-svg (canvas stream :font +text-font+)
      (with-canvas (canvas)
        (funcall draw canvas)
        (values width height)))))

(defun save-chart (file chart)
  "Save CHART, an SVG document that a function such as LINE-CHART has returned, in FILE, replacing
it: SVG or, where the program rsvg-convert is installed, PNG, as its name ends. Return the file's
truename. Signals WRONG-ARGUMENT, and MISUSE without that program."
  (check-argument save-chart chart (stringp chart) "what a function such as LINE-CHART returns")
  (save-svg chart file (picture-kind 'save-chart file)))
