;;;; time-chart.lisp -- charts of curves over ticks, below each other, on any canvas.

(in-package :ars-magna.plots)

(export '(time-chart time-chart-series collect-time-charts draw-time-charts
          sample-range-at sample-text value-and-unit-text time-charts-svg +time-chart-height+))

;;; A chart has a line with the name, the description, the last value and the unit; below it is the
;;; curve between two axes. All charts share the ticks of the axis across. Charts are collected
;;; before they are drawn, because a curve may grow while it is drawn.

(defconstant +time-chart-height+ 96 "The height of the chart of a curve, in pixels.")
(defconstant +time-chart-title-height+ 19 "The height of the title of a chart, in pixels.")
(defconstant +value-marks-width+ 62 "The width of the marks to the left of a curve, in pixels.")

(define-record (time-chart (:constructor make-time-chart (series ranges step note across)))
  "The chart of SERIES with the horizontal axis ACROSS. It shows RANGES, sample ranges of STEP ticks
each, and NOTE, a text."
  (series nil time-series "the time series of the chart" :export)
  (ranges '() list)
  (step 1 (integer 1))
  (note "" string)
  (across (make-axis) axis))

(defun sampled-value-text (value)
  "Return VALUE as text: whole numbers below a billion in full, as scores are, others rounded."
  (if (and (integerp value) (< (abs value) 1000000000))
      (format nil "~D" value)
      (rounded-number-text value)))

(defun value-and-unit-text (series value)
  "Return VALUE as text, with the unit of SERIES."
  (format nil "~A~:[ ~A~;~]" (sampled-value-text value) (string= "" (time-series-unit series))
          (time-series-unit series)))

(defun sample-text (series range)
  "Return a text with the name of SERIES and the values and ticks of RANGE, a sample range."
  (let ((low (sampled-value-text (sample-range-low range)))
        (high (value-and-unit-text series (sample-range-high range))))
    (if (= (sample-range-low range) (sample-range-high range))
        (format nil "~A: ~A at tick ~D" (time-series-name series) high (sample-range-tick range))
        (format nil "~A: ~A to ~A at ticks ~D to ~D" (time-series-name series) low high
                (sample-range-tick range) (sample-range-end range)))))

(defmethod subject-title ((chart time-chart))
  (format nil "~A: ~A" (time-series-name (time-chart-series chart)) (time-chart-note chart)))

(defun ticks-from-range (range tick)
  "Return the distance of TICK from the interval of RANGE, or 0 if TICK is inside."
  (max 0 (- (sample-range-tick range) tick) (- tick (sample-range-end range))))

(defun sample-range-at (chart x)
  "Return the sample range that CHART shows nearest to the pixel X, or NIL."
  (let* ((axis (time-chart-across chart))
         (tick (+ (axis-low axis)
                  (* (- (axis-high axis) (axis-low axis))
                     (/ (- x (axis-from axis)) (- (axis-to axis) (axis-from axis))))))
         (nearest nil))
    (dolist (range (time-chart-ranges chart) nearest)
      (when (or (null nearest)
                (<= (ticks-from-range range tick) (ticks-from-range nearest tick)))
        (setf nearest range)))))

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
          collect (multiple-value-bind (ranges step) (time-series-ranges series from)
                    (make-time-chart series ranges step
                                      (or (funcall notes series) (last-value-text series))
                                      across)))))

;;; Drawing.

(defun value-axis (ranges top bottom)
  "Return the vertical axis for RANGES between the pixels TOP and BOTTOM."
  (let ((axis (numeric-y-axis
               (and ranges
                    (list (as-rational (reduce #'min ranges :key #'sample-range-low))
                          (as-rational (reduce #'max ranges :key #'sample-range-high))))
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

(defun unbroken-parts (ranges step)
  "Return RANGES as a list of lists, broken where more than STEP ticks have no sample."
  (let ((parts '()) (part '()))
    (dolist (range ranges (nreverse (if part (cons (nreverse part) parts) parts)))
      (when (and part
                 (> (- (sample-range-tick range) (sample-range-tick (first part))) step))
        (push (nreverse part) parts)
        (setf part '()))
      (push range part))))

;;; The line visits the first, the least and the greatest value of each range. So it shows each
;;; peak, and it is straight if the values rise or fall steadily.

(defun extremes-to-visit (range next)
  "Return the least and the greatest value of RANGE, without its first value. The one nearer to
NEXT, the range after it or NIL, is the last."
  (let* ((low (sample-range-low range)) (high (sample-range-high range))
         (falling-p (and next (< (abs (- low (sample-range-first next)))
                                 (abs (- high (sample-range-first next)))))))
    (remove (sample-range-first range) (if falling-p (list high low) (list low high)))))

(defun points-of-line (ranges)
  "Return a list of lists (tick value): the line through RANGES."
  (loop for (range next) on ranges
        for tick = (sample-range-tick range)
        for extremes = (extremes-to-visit range next)
        for step = (/ (- (sample-range-end range) tick) (max 1 (length extremes)))
        collect (list tick (sample-range-first range))
        append (loop for value in extremes
                     for number from 1
                     collect (list (+ tick (* number step)) value))))

(defun draw-time-line (canvas chart upward)
  (let ((x-of (pixel-function (time-chart-across chart))) (y-of (pixel-function upward)))
    (with-ink ((series-color (time-series-index (time-chart-series chart))) 1.5)
      (dolist (part (unbroken-parts (time-chart-ranges chart) (time-chart-step chart)))
        (let ((points (loop for (tick value) in (points-of-line part)
                            collect (funcall x-of tick) collect (funcall y-of value))))
          (draw-lines canvas draw-gcontext*
                      ;; A single sample is a dot.
                      (if (cddr points)
                          points
                          (list* (- (first points) 1) (second points) points))))))))

(defun beginning-of-text (text width)
  "Return TEXT, cut after a word, with dots, unless it fits in WIDTH pixels. The least is no text."
  (let ((lines (wrap-text text (max 1 (- width (text-width "..." +text-size+))))))
    (cond ((or (null lines) (<= (text-width text +text-size+) width)) text)
          ((< width 40) "")
          (t (format nil "~A..." (first lines))))))

(defun draw-time-chart-title (canvas chart y)
  (let* ((series (time-chart-series chart)) (name (time-series-name series))
         (left (+ 14 (text-width name +text-size+ t)))
         (right (axis-to (time-chart-across chart)))
         (room (- right left 8 (text-width (time-chart-note chart) +text-size+))))
    (draw-text-lines canvas 6 (+ y 13) (list name) :bold-p t)
    (draw-text-lines canvas left (+ y 13)
                     (list (beginning-of-text (time-series-description series) room))
                     :color +faint-text-color+)
    (draw-text-lines canvas right (+ y 13) (list (time-chart-note chart))
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
  (let ((upward (value-axis (time-chart-ranges chart) (+ top +time-chart-title-height+ 6)
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
