;;;; drawing-chart.lisp -- any drawing as a page: with a title above, and a legend below.

(in-package :ars-magna.plots)

(defconstant +entry-space+ 24 "How far entries of a legend below are apart, in pixels.")

(defun entry-width (text)
  (+ +sample-width+ 12 (text-width text +text-size+)))

(defun entry-rows (entries width)
  "Return ENTRIES, lists (index text), as lists of those that stand beside each other within WIDTH."
  (let ((rows '()) (row '()) (used 0))
    (dolist (entry entries (nreverse (if row (cons (nreverse row) rows) rows)))
      (let ((more (entry-width (second entry))))
        (when (and row (> (+ used more) width))
          (push (nreverse row) rows)
          (setf row '() used 0))
        (push entry row)
        (incf used (+ more +entry-space+))))))

(defun draw-entries (canvas rows y)
  (dolist (row rows)
    (loop with x = +margin+
          for (index text) in row
          do (with-ink ((look-color index) 1.6)
               (draw-line canvas draw-gcontext* x (- y 4) (+ x +sample-width+) (- y 4)))
             (draw-marker canvas index (+ x +sample-width+) (- y 4))
             (write-lines canvas (+ x +sample-width+ 12) y (list text))
             (incf x (+ (entry-width text) +entry-space+)))
    (incf y (+ +text-step+ 4))))

(defun drawing-chart (draw width height &key title subtitle entries)
  "Return a drawing WIDTH and HEIGHT pixels large as an SVG document, with TITLE and SUBTITLE above,
strings or NIL, and ENTRIES below, lists (index text) that say what lines mean that end in a marker
(see LOOK-COLOR and DRAW-MARKER). The function DRAW is called with a canvas whose origin is the
upper left corner of the drawing."
  (let* ((page-width (max width 480))
         (heading (plan-heading title subtitle (+ page-width (* 2 +margin+))))
         (rows (entry-rows entries page-width))
         (legend (* (+ +text-step+ 4) (length rows)))
         (top (+ (heading-bottom heading) 12)))
    (page-svg (lambda (canvas)
                (draw-heading canvas heading)
                (with-origin (canvas +margin+ top)
                  (with-clipping (canvas 0 0 width height) (funcall draw canvas)))
                (draw-entries canvas rows (+ top height 22)))
              (+ page-width (* 2 +margin+))
              (+ top height legend +margin+ 4))))
