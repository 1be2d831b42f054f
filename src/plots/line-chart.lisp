;;;; line-chart.lisp -- series of points with intervals.

(in-package :ars-magna.plots)

(export '(line-chart))

(defstruct (data-point (:conc-name point-) (:constructor make-data-point (x y low high))
                       (:copier nil))
  "A point of a series: the value Y at X, with the interval from LOW to HIGH. X is a number or a
text; Y, LOW and HIGH may be NIL."
  (x nil :read-only t)
  (y nil :read-only t)
  (low nil :read-only t)
  (high nil :read-only t))

(defstruct (series (:constructor make-series (name index points)) (:copier nil))
  "A series of points, in the given order. INDEX determines its colour, markers and dashes."
  (name nil :read-only t)
  (index 0 :read-only t)
  (points '() :type list :read-only t))

(defun checked-point (point any-x-word-p)
  (check-argument chart point (and (consp point) (ignore-errors (<= 2 (length point) 4)))
                  "a list (x y) or (x y low high)")
  (destructuring-bind (x y &optional low high) point
    (check-argument chart x (not (null x)) "a number, or a word such as the name of a condition")
    (make-data-point (if any-x-word-p (name-text x) (as-rational x))
                     (as-rational y) (as-rational low) (as-rational high))))

(defun any-x-word-p (all)
  "True if any point in ALL, a list of lists (name point...), has an X that is not a number."
  (some (lambda (entry)
          (some (lambda (point) (and (consp point) (not (realp (first point))))) (rest entry)))
        all))

(defun checked-series (all)
  "Return two values: a list of series for ALL, lists (name point...); and true if the X are words."
  (check-argument chart all (and (listp all) (every #'consp all))
                  "a list of series, each a list (name (x y low high) ...)")
  (let ((any-x-word-p (any-x-word-p all)))
    (values (loop for (name . points) in all
                  for index from 0
                  collect (make-series (name-text name) index
                                       (mapcar (lambda (point) (checked-point point any-x-word-p))
                                               points)))
            any-x-word-p)))

(defun all-points (series) (mapcan (lambda (one) (copy-list (series-points one))) series))

(defun all-x (series)
  "Return the X of all points of SERIES, without duplicates, in order of appearance."
  (remove-duplicates (mapcar #'point-x (all-points series)) :test #'equal :from-end t))

(defun all-y (series)
  (loop for point in (all-points series)
        append (remove nil (list (point-y point) (point-low point) (point-high point)))))

;;; Series are drawn side by side, so that their intervals do not hide each other.

(defun least-gap (places)
  "Return the least distance between two of PLACES, in pixels, or 60 if there are fewer than two."
  (let ((sorted (sort (copy-list places) #'<)))
    (loop for (place next) on sorted
          while next
          minimize (- next place) into gap
          finally (return (if (rest sorted) gap 60)))))

(defconstant +largest-series-shift+ 8 "The greatest shift between two series, in pixels.")

(defun series-shift-step (count gap)
  "Return the horizontal shift in pixels between two of COUNT series with points GAP pixels apart."
  (min +largest-series-shift+ (/ (* 6/10 gap) (max 1 count))))

(defun inset-for-series (series values from to log-p)
  "Return the distance that VALUES must have from the ends of an axis between the pixels FROM and
TO, so that all SERIES have room side by side."
  (let* ((places (mapcar (lambda (value) (value-or-logarithm value log-p)) values))
         (span (if places (- (reduce #'max places) (reduce #'min places)) 0))
         (gap (if (zerop span) 60 (* (- to from) (/ (least-gap places) span)))))
    (+ 14 (* 1/2 (length series) (series-shift-step (length series) gap)))))

(defun series-shift-function (series places from)
  "Return a function that returns the horizontal shift, in pixels, of the series with a given index
among SERIES. PLACES are the positions of points on an axis that begins at the pixel FROM."
  (let* ((middle (/ (1- (length series)) 2))
         (room (if places (- (reduce #'min places) from 7) 0))
         (step (min (series-shift-step (length series) (least-gap places))
                    (/ room (max 1 middle)))))
    (lambda (index) (* step (- index middle)))))

(defun legend-label (name known-p)
  "Return the text for the series NAME in the legend. KNOWN-P is true if the series has data."
  (if (or known-p (string= "" name))
      name
      (concatenate 'string name " (no data)")))

;;;; The chart

;;; Words along the axis across are replaced by numbers.

(defun replace-words-by-positions (series words)
  "Return copies of SERIES in which each X, a word, is replaced by its position in WORDS."
  (loop for one in series
        for points = (loop for point in (series-points one)
                           for place = (position (point-x point) words :test #'equal)
                           collect (make-data-point place (point-y point) (point-low point)
                                                    (point-high point)))
        collect (make-series (series-name one) (series-index one) points)))

(defun point-tooltip (series point words percent)
  (flet ((text (value) (rounded-number-text value :percent percent)))
    (format nil "~@[~A, ~]~A: ~A~:[~;~:* (~A to ~A)~]"
            (and (string/= "" (series-name series)) (series-name series))
            (if words (elt words (point-x point)) (rounded-number-text (point-x point)))
            (text (point-y point))
            (and (point-low point) (point-high point) (text (point-low point)))
            (and (point-high point) (text (point-high point))))))

(defun consecutive-sublists (items test)
  (let ((runs '()) (run '()))
    (dolist (item items (nreverse (if run (cons (nreverse run) runs) runs)))
      (cond ((funcall test item) (push item run))
            (run (push (nreverse run) runs)
                 (setf run '()))))))

(defun draw-connections (canvas series plot shift)
  (dolist (run (consecutive-sublists (series-points series) #'point-y))
    (when (rest run)
      (with-series-look ((series-index series) 1.8)
        (draw-lines canvas draw-gcontext*
                    (loop for point in run
                          collect (+ shift (axis-pixel (point-x point) (plot-x-axis plot)))
                          collect (axis-pixel (point-y point) (plot-y-axis plot))))))))

(defun draw-intervals (canvas series plot shift)
  (with-ink ((series-color (series-index series)) 1.2)
    (dolist (point (series-points series))
      (when (and (point-low point) (point-high point))
        (draw-vertical-interval canvas (+ shift (axis-pixel (point-x point) (plot-x-axis plot)))
                                (axis-pixel (point-low point) (plot-y-axis plot))
                                (axis-pixel (point-high point) (plot-y-axis plot)))))))

(defun draw-markers (canvas series plot shift words percent)
  (dolist (point (series-points series))
    (when (point-y point)
      (with-subject (canvas (point-tooltip series point words percent))
        (draw-marker canvas (series-index series)
                     (+ shift (axis-pixel (point-x point) (plot-x-axis plot)))
                     (axis-pixel (point-y point) (plot-y-axis plot)))))))

(defun draw-series (canvas all plot words percent)
  "Draw the series in the list ALL: lines first, then intervals, then markers."
  (let ((shifts (series-shift-function all
                                       (mapcar (lambda (x) (axis-pixel x (plot-x-axis plot)))
                                                (all-x all))
                                       (axis-from (plot-x-axis plot)))))
    (flet ((each (function)
             (dolist (series all)
               (funcall function series (funcall shifts (series-index series))))))
      (unless words
        (each (lambda (series shift) (draw-connections canvas series plot shift))))
      (each (lambda (series shift) (draw-intervals canvas series plot shift)))
      (each (lambda (series shift) (draw-markers canvas series plot shift words percent))))))

(defun lay-out-line-chart (all words values log-x upward options)
  "Return the PLOT for the series ALL. VALUES are their X; with WORDS, they are positions in WORDS."
  (apply #'lay-out-plot
         (lambda (from to)
           (if words
               (word-x-axis words from to)
               (numeric-x-axis values from to log-x
                               :inset (inset-for-series all values from to log-x))))
         upward
         (loop for series in all
               collect (legend-label (series-name series) (some #'point-y (series-points series))))
         :connect (null words) options))

(defun line-chart (series &rest options
                   &key percent range log-x title subtitle x-label y-label legend-title
                     width height)
  "Return a chart of SERIES as an SVG document. Each series is a list (name point...), each point a
list (x y) or (x y low high): the value Y at X, with the interval from LOW to HIGH. The X of all
points are either numbers (lines join the points) or strings and symbols. Unknown values are NIL. If
PERCENT is true, Y are rates, shown as per cent from 0 to 100. RANGE is a list (low high) that the
vertical axis must include. If LOG-X is true, the scale of X is logarithmic. TITLE, SUBTITLE,
X-LABEL, Y-LABEL and LEGEND-TITLE, which is above the names of the series, are strings or NIL. WIDTH
and HEIGHT are pixels, by default 720 and 440; the chart is larger if its texts need more room. If
all names are NIL, there is no legend. Signals WRONG-ARGUMENT."
  (declare (ignore title subtitle x-label y-label legend-title width height))
  (check-argument line-chart range (typep range '(or null (cons real (cons real null))))
                  "a list of two numbers, or NIL")
  (multiple-value-bind (checked any-x-word-p) (checked-series series)
    (let* ((values (all-x checked))
           (words (and any-x-word-p values))
           (all (if any-x-word-p (replace-words-by-positions checked words) checked))
           (upward (numeric-y-axis (all-y all) percent
                                   (mapcar #'as-rational (or range (and percent '(0 1))))))
           (plot (lay-out-line-chart all words values log-x upward options)))
      (plot-svg plot (all-y all)
                (lambda (canvas)
                  (draw-series canvas all plot words percent))))))
