;;;; line-chart.lisp -- what comes of what is varied: points with intervals, by series.

(in-package :ars-magna.plots)

(export '(line-chart))

;;; Words along the axis across are counted, so that all else deals with numbers.

(defun numbered (series words)
  "Return SERIES with the places in WORDS for X."
  (loop for one in series
        collect (make-series (series-name one) (series-index one)
                             (loop for spot in (series-spots one)
                                   collect (make-spot (position (spot-x spot) words :test #'equal)
                                                      (spot-y spot) (spot-low spot)
                                                      (spot-high spot))))))

(defun spot-title (series spot words percent)
  "Return what a viewer says of SPOT: its series, X, Y and interval."
  (flet ((text (value) (figure-text value :percent percent)))
    (format nil "~@[~A, ~]~A: ~A~:[~;~:* (~A to ~A)~]"
            (and (string/= "" (series-name series)) (series-name series))
            (if words (elt words (spot-x spot)) (figure-text (spot-x spot)))
            (text (spot-y spot))
            (and (spot-low spot) (spot-high spot) (text (spot-low spot)))
            (and (spot-high spot) (text (spot-high spot))))))

(defun runs (items test)
  "Return lists of ITEMS that follow each other and for which TEST is true."
  (let ((runs '()) (run '()))
    (dolist (item items (nreverse (if run (cons (nreverse run) runs) runs)))
      (cond ((funcall test item) (push item run))
            (run (push (nreverse run) runs)
                 (setf run '()))))))

(defun draw-connections (canvas series plane shift)
  (dolist (run (runs (series-spots series) #'spot-y))
    (when (rest run)
      (with-look ((series-index series) 1.8)
        (draw-lines canvas draw-gcontext*
                    (loop for spot in run
                          collect (+ shift (place (spot-x spot) (plane-across plane)))
                          collect (place (spot-y spot) (plane-upward plane))))))))

(defun draw-intervals (canvas series plane shift)
  (with-ink ((look-color (series-index series)) 1.2)
    (dolist (spot (series-spots series))
      (when (and (spot-low spot) (spot-high spot))
        (draw-interval canvas (+ shift (place (spot-x spot) (plane-across plane)))
                       (place (spot-low spot) (plane-upward plane))
                       (place (spot-high spot) (plane-upward plane)))))))

(defun draw-spots (canvas series plane shift words percent)
  (dolist (spot (series-spots series))
    (when (spot-y spot)
      (with-subject (canvas (spot-title series spot words percent))
        (draw-marker canvas (series-index series)
                     (+ shift (place (spot-x spot) (plane-across plane)))
                     (place (spot-y spot) (plane-upward plane)))))))

(defun draw-series (canvas all plane words percent connect)
  "Draw ALL series: lines, above them intervals, above them markers."
  (let ((shifts (sideways all
                          (mapcar (lambda (x) (place x (plane-across plane))) (all-x all))
                          (axis-from (plane-across plane)))))
    (flet ((each (function)
             (dolist (series all)
               (funcall function series (funcall shifts (series-index series))))))
      (when connect
        (each (lambda (series shift) (draw-connections canvas series plane shift))))
      (each (lambda (series shift) (draw-intervals canvas series plane shift)))
      (each (lambda (series shift) (draw-spots canvas series plane shift words percent))))))

(defun plan-line-chart (all words values log-x upward options)
  "Return the plane for ALL series, whose X are VALUES, in the order of WORDS if there are any."
  (apply #'plan-plane
         (lambda (from to)
           (if words
               (word-axis words from to)
               (axis-across values from to log-x
                            :inset (room-beside all values from to log-x))))
         upward
         (loop for series in all
               collect (legend-name (series-name series) (some #'spot-y (series-spots series))))
         options))

(defun line-chart (series &rest options &key percent range log-x (connect nil connect-given-p)
                                          title subtitle x-label y-label legend-title
                                          width height)
  "Return a chart of SERIES as an SVG document. Each is a list (name point...), a point a list
(x y) or (x y low high): Y at X, with an interval. X is a number or, then for all, a string or
symbol; what is not known is NIL. PERCENT: Y are rates, shown as per cent from 0 to 100. RANGE is a
list (low high) that the axis upward shows at least. LOG-X: X on a logarithmic scale. CONNECT: lines
join the points, by default if X are numbers. TITLE, SUBTITLE, X-LABEL, Y-LABEL and
LEGEND-TITLE, which says what the series are, are strings or NIL; WIDTH and HEIGHT are pixels, by
default 720 and 440, and grow where the text needs it. A series without a name, NIL, does without a
legend. Signals WRONG-ARGUMENT."
  (declare (ignore title subtitle x-label y-label legend-title width height))
  (check-argument line-chart range (typep range '(or null (cons real (cons real null))))
                  "a list of two numbers, or NIL")
  (multiple-value-bind (given words-p) (checked-series series)
    (let* ((values (all-x given))
           (words (and words-p values))
           (all (if words-p (numbered given words) given))
           (connect (if connect-given-p connect (not words-p)))
           (upward (axis-upward (all-y all) percent
                                (mapcar #'exact (or range (and percent '(0 1))))))
           (plane (plan-line-chart all words values log-x upward
                                   (list* :connect connect options))))
      (plane-svg plane (all-y all)
                 (lambda (canvas)
                   (draw-series canvas all plane words percent connect))))))
