;;;; time-chart.lisp -- charts of curves over ticks, below each other, on any canvas.

(in-package :ars-magna.plots)

(export '(time-chart time-chart-series collect-time-charts draw-time-charts sample-at
          sample-text value-and-unit-text time-charts-svg +time-chart-height+))

;;; A chart has a line with the name, the unit and the last value; below it is the curve between two
;;; axes. All charts share the ticks of the axis across. Charts are collected before they are drawn,
;;; because a curve may grow while it is drawn.

(defconstant +time-chart-height+ 96 "The height of the chart of a curve, in pixels.")
(defconstant +time-chart-title-height+ 19 "The height of the title of a chart, in pixels.")
(defconstant +value-marks-width+ 62 "The width of the marks to the left of a curve, in pixels.")

(define-record (time-chart (:constructor make-time-chart (series samples step note across)))
  "The chart of SERIES with the horizontal axis ACROSS. It shows SAMPLES (tick . value), STEP ticks
apart, and NOTE, a text."
  (series nil time-series "the time series of the chart" :export)
  (samples '() list)
  (step 1 (integer 1))
  (note "" string)
  (across (make-axis) axis))

(defun value-and-unit-text (series value)
  "Return VALUE as text, with the unit of SERIES."
  (format nil "~A~:[ ~A~;~]" (rounded-number-text value) (string= "" (time-series-unit series))
          (time-series-unit series)))

(defun sample-text (series tick value)
  "Return a text with the name of SERIES, VALUE and TICK."
  (format nil "~A: ~A at tick ~D"
          (time-series-name series) (value-and-unit-text series value) tick))

(defmethod subject-title ((chart time-chart))
  (format nil "~A: ~A" (time-series-name (time-chart-series chart)) (time-chart-note chart)))

(defun sample-at (chart x)
  "Return the tick and the value of the sample that CHART shows nearest to the pixel X, or NIL."
  (let* ((axis (time-chart-across chart))
         (tick (+ (axis-low axis)
                  (* (- (axis-high axis) (axis-low axis))
                     (/ (- x (axis-from axis)) (- (axis-to axis) (axis-from axis))))))
         (nearest nil))
    (dolist (sample (time-chart-samples chart) (values (car nearest) (cdr nearest)))
      (when (or (null nearest) (< (abs (- tick (car sample))) (abs (- tick (car nearest)))))
        (setf nearest sample)))))

;;; Collecting.

(defun ticks-shown (all from)
  "Return a list of the first and the last tick of charts of ALL, time series, from FROM on."
  (let ((first-ticks (remove nil (mapcar #'first-tick all)))
        (last-ticks (remove nil (mapcar #'last-sample all))))
    (list (max from (if first-ticks (reduce #'min first-ticks) 0))
          (reduce #'max last-ticks :initial-value from))))

(defun last-value-text (series)
  (multiple-value-bind (tick value) (last-sample series)
    (if tick (value-and-unit-text series value) "no value yet")))

(defun collect-time-charts (all width &key (from 0) (notes (constantly nil)))
  "Return charts of ALL, a list of time series, from the tick FROM on, WIDTH pixels wide. NOTES is a
function from a time series to a text to show instead of its last value, or NIL."
  (let ((across (numeric-x-axis (ticks-shown all from) +value-marks-width+
                                (max (+ 20 +value-marks-width+) (- width 12)) nil :inset 0)))
    (loop for series in all
          collect (multiple-value-bind (samples step) (time-series-samples series from)
                    (make-time-chart series samples step
                                      (or (funcall notes series) (last-value-text series))
                                      across)))))

;;; Drawing.

(defun value-axis (samples top bottom)
  "Return the vertical axis for SAMPLES between the pixels TOP and BOTTOM."
  (let* ((values (mapcar #'cdr samples))
         (axis (numeric-y-axis (and values (list (as-rational (reduce #'min values))
                                                 (as-rational (reduce #'max values))))
                               nil '() 3)))
    (setf (axis-from axis) bottom (axis-to axis) top)
    axis))

(defun pixel-function (axis)
  "Return a function that maps numbers to pixels along AXIS, in double-floats."
  (let* ((low (coerce (axis-low axis) 'double-float))
         (from (coerce (axis-from axis) 'double-float))
         (scale (/ (- (coerce (axis-to axis) 'double-float) from)
                   (- (coerce (axis-high axis) 'double-float) low))))
    (lambda (number) (+ from (* scale (- number low))))))

(defun unbroken-parts (samples step)
  "Return SAMPLES as a list of lists, broken where more than STEP ticks have no sample."
  (let ((parts '()) (part '()))
    (dolist (sample samples (nreverse (if part (cons (nreverse part) parts) parts)))
      (when (and part (> (- (car sample) (car (first part))) step))
        (push (nreverse part) parts)
        (setf part '()))
      (push sample part))))

(defun draw-time-line (canvas chart upward)
  (let ((x-of (pixel-function (time-chart-across chart))) (y-of (pixel-function upward)))
    (with-ink ((series-color (time-series-index (time-chart-series chart))) 1.5)
      (dolist (part (unbroken-parts (time-chart-samples chart) (time-chart-step chart)))
        (let ((points (loop for (tick . value) in part
                            collect (funcall x-of tick) collect (funcall y-of value))))
          (draw-lines canvas draw-gcontext*
                      ;; A single sample is a dot.
                      (if (rest part)
                          points
                          (list* (- (first points) 1) (second points) points))))))))

(defun draw-time-chart-title (canvas chart y)
  (let ((series (time-chart-series chart)))
    (draw-text-lines canvas 6 (+ y 13) (list (time-series-name series)) :bold-p t)
    (draw-text-lines canvas (axis-to (time-chart-across chart)) (+ y 13)
                     (list (time-chart-note chart))
                     :anchor :end :color (series-color (time-series-index series)))))

(defun draw-chart-axes (canvas across upward)
  (let ((left (axis-from across)) (right (axis-to across)) (bottom (axis-from upward)))
    (loop for (value . lines) in (axis-marks upward)
          for y = (axis-pixel value upward)
          do (with-ink (+grid-color+) (draw-line canvas draw-gcontext* left y right y))
             (draw-text-lines canvas (- left 6) (+ y 4) lines :anchor :end))
    (with-ink (+axis-color+)
      (draw-lines canvas draw-gcontext* (list left (axis-to upward) left bottom right bottom)))
    (draw-x-axis-marks canvas across bottom)
    (draw-text-lines canvas (- left 24) (+ bottom 17) '("tick") :anchor :end
                                                                :color +faint-text-color+)))

(defun draw-time-chart (canvas chart top height)
  (let ((upward (value-axis (time-chart-samples chart) (+ top +time-chart-title-height+ 6)
                            (- (+ top height) 26)))
        (across (time-chart-across chart)))
    (with-subject (canvas chart)
      ;; All of the chart reacts to the mouse.
      (with-ink (white*)
        (draw-rectangle canvas draw-gcontext* 0 top (+ 12 (axis-to across)) height t))
      (draw-time-chart-title canvas chart top)
      (draw-chart-axes canvas across upward)
      (draw-time-line canvas chart upward))))

(defun draw-time-charts (canvas charts &optional (height +time-chart-height+))
  "Draw CHARTS below each other, each HEIGHT pixels high. Return the height of all charts."
  (loop for chart in charts
        for top from 0 by height
        do (draw-time-chart canvas chart top height))
  (* height (length charts)))

(defun time-charts-svg (charts title)
  "Return CHARTS, which are 720 pixels wide, below TITLE as an SVG document."
  (let ((height 180) (top 32))
    (with-output-to-string (stream)
      (with-svg (canvas stream :font +text-font+)
        (with-canvas (canvas)
          (draw-text-lines canvas 6 18 (list title) :size 15)
          (with-origin (canvas 0 top) (draw-time-charts canvas charts height))
          (values 720 (+ top (* height (length charts)))))))))
