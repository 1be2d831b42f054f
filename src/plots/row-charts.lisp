;;;; row-charts.lisp -- charts of rows along one axis: differences, and measured values.

(in-package :ars-magna.plots)

(export '(difference-chart measure-chart))

(defstruct (row (:constructor make-row (label words height)) (:copier nil))
  "A row of a chart, with the lines of text LABEL and WORDS beside it. TOP, HEIGHT are pixels."
  (label '() :type list :read-only t)
  (words '() :type list :read-only t)
  (height 0 :read-only t)
  (top 0))

(defun row-middle (row) (+ (row-top row) (/ (row-height row) 2)))

(defun lay-out-row (label words width least)
  "Return a row, at least LEAST pixels high, on a page of WIDTH pixels. WORDS is a list of strings."
  (let ((label (wrap-text label (* 32/100 width)))
        (words (loop for text in words append (wrap-text text (* 34/100 width)))))
    (make-row label words
              (+ 8 (max least (text-lines-height label) (text-lines-height words))))))

(defstruct (table (:include page) (:copier nil))
  "A page whose data are rows below each other, each with a label and texts."
  rows)

(defun stack-rows (rows top)
  "Place ROWS below each other, from the pixel TOP on. Return the pixel below the last row."
  (dolist (row rows top)
    (setf (row-top row) top)
    (incf top (row-height row))))

(defun lay-out-table (entries values &key title subtitle x-label (width 720) (least 14) log-x
                                        percent)
  "Return a table with a row for each of ENTRIES, lists (label text...), and a horizontal axis for
VALUES. Each row is at least LEAST pixels high. The page becomes wider than WIDTH if necessary."
  (check-chart-size width 440)
  (flet ((widest (reader rows)
           (reduce #'max rows :initial-value 0
                              :key (lambda (row) (text-lines-width (funcall reader row))))))
    (let* ((heading (lay-out-heading title subtitle width))
           (rows (loop for (label . words) in entries
                       collect (lay-out-row label words width least)))
           (left (+ +chart-margin+ (widest #'row-label rows) 12))
           (words-width (widest #'row-words rows))
           (right (max (+ left +least-data-area-width+)
                       (- width +chart-margin+ (if (plusp words-width) (+ 14 words-width) 16))))
           (across (numeric-x-axis values left right log-x :percent percent))
           (top (+ (heading-bottom heading) 12))
           (bottom (+ 4 (stack-rows rows (+ top 4))))
           (bottom (if rows bottom (+ top 60)))
           (x-lines (wrap-text x-label (- right left))))
      (make-table :heading heading :x-axis across :rows rows :x-lines x-lines
                  :left left :right right :top top :bottom bottom
                  :width (ceiling (+ right (max 16 (+ 14 words-width)) +chart-margin+))
                  :height (ceiling (+ bottom (marks-height across) 6 (text-lines-height x-lines)
                                      +chart-margin+))))))

(defun draw-text-beside-row (canvas x row lines anchor)
  (draw-text-lines canvas x (+ 12 (- (row-middle row) (/ (text-lines-height lines) 2))) lines
                   :anchor anchor))

(defun draw-table (canvas table draw-row)
  "Draw TABLE. For each row, call DRAW-ROW with CANVAS, the row and its number, to draw the data."
  (let ((left (table-left table)) (right (table-right table)) (top (table-top table))
        (bottom (table-bottom table)) (across (table-x-axis table)))
    (with-ink (+grid-color+)
      (loop for (value) in (axis-marks across)
            for x = (axis-pixel value across)
            do (draw-line canvas draw-gcontext* x top x bottom)))
    (with-ink (+axis-color+ 1.2)
      (draw-line canvas draw-gcontext* left bottom right bottom))
    (draw-x-axis canvas table)
    (loop for row in (table-rows table)
          for number from 0
          do (draw-text-beside-row canvas (- left 12) row (row-label row) :end)
             (draw-text-beside-row canvas (+ right 14) row (row-words row) :start)
             (funcall draw-row canvas row number))
    (unless (table-rows table) (draw-no-data-text canvas table))))

(defun table-svg (table draw-row)
  (page-svg table (lambda (canvas) (draw-table canvas table draw-row))))

;;;; Differences with intervals, against zero

(defun checked-difference (row)
  "Check ROW, an element of the argument ROWS of DIFFERENCE-CHART. Return a list (label estimate low
high words); all but the label may be NIL."
  (check-argument difference-chart row (and (consp row) (ignore-errors (<= 2 (length row) 5)))
                  "a list (label estimate low high words)")
  (destructuring-bind (label estimate &optional low high words) row
    (list (name-text label) (as-rational estimate) (as-rational low) (as-rational high) words)))

(defun signed-number-text (value percent)
  (concatenate 'string (if (and value (plusp value)) "+" "")
               (rounded-number-text value :percent percent :digits 3)))

(defun interval-text (value low high text)
  "Return a text of VALUE and its interval from LOW to HIGH. The function TEXT formats a number."
  (cond ((null value) "no data")
        ((and low high)
         (format nil "~A (~A to ~A)" (funcall text value) (funcall text low) (funcall text high)))
        (t (funcall text value))))

(defun difference-entry (difference percent)
  (destructuring-bind (label estimate low high words) difference
    (list label
          (interval-text estimate low high (lambda (value) (signed-number-text value percent)))
          words)))

(defun draw-estimate (canvas index y value low high across)
  "Draw VALUE and its interval from LOW to HIGH on the horizontal axis ACROSS, at the height Y, with
the colour and marker of the series INDEX."
  (when (and low high)
    (with-ink ((series-color index) 1.8)
      (draw-horizontal-interval canvas y (axis-pixel low across) (axis-pixel high across))))
  (when value
    (draw-marker canvas index (axis-pixel value across) y 5)))

(defun draw-zero-line (canvas table)
  (let ((x (axis-pixel 0 (table-x-axis table))))
    (with-ink (+axis-color+ 1.2)
      (draw-line canvas draw-gcontext* x (table-top table) x (table-bottom table)))))

(defun difference-chart (rows &key percent title subtitle x-label (width 720))
  "Return a chart of differences, below each other and with a line at 0, as an SVG document. ROWS
are lists (label estimate low high words): the name of the comparison, the difference, its interval,
and a remark such as \"p = 0.03\". All but the label may be NIL. If PERCENT is true, numbers are
shown as per cent. The other arguments are those of LINE-CHART. Signals WRONG-ARGUMENT."
  (check-argument difference-chart rows (listp rows) "a list of rows")
  (let* ((differences (mapcar #'checked-difference rows))
         (table (lay-out-table (mapcar (lambda (difference) (difference-entry difference percent))
                                       differences)
                               (cons 0 (loop for difference in differences
                                             append (remove nil (subseq difference 1 4))))
                               :title title :subtitle subtitle :x-label x-label :width width
                               :percent percent)))
    (table-svg table
               (lambda (canvas row number)
                 (when (zerop number) (draw-zero-line canvas table))
                 (destructuring-bind (estimate low high) (subseq (elt differences number) 1 4)
                   (draw-estimate canvas 0 (row-middle row) estimate low high
                                  (table-x-axis table)))))))

;;;; Distributions of many numbers, by group

;;; The numbers of a group are a histogram with columns of four pixels, whether ten or ten thousand.

(defconstant +histogram-column-width+ 4 "The width of a column of a histogram, in pixels.")
(defconstant +histogram-column-height+ 28 "The height of the highest column of a group, in pixels.")

(defun checked-group (row)
  "Check ROW, one of the ROWS of MEASURE-CHART. Return a list (label numbers middle low high)."
  (check-argument measure-chart row
                  (and (consp row) (ignore-errors (<= 2 (length row) 5))
                       (typep (second row) 'sequence))
                  "a list (label numbers middle low high)")
  (destructuring-bind (label numbers &optional middle low high) row
    (list (name-text label) (remove nil (map 'list #'as-rational numbers))
          (as-rational middle) (as-rational low) (as-rational high))))

(defun group-entry (group middle-label)
  (destructuring-bind (label numbers middle low high) group
    (list label
          (and middle
               (format nil "~A ~A" middle-label
                       (interval-text middle low high #'rounded-number-text)))
          (format nil "n = ~D" (length numbers)))))

(defun histogram-columns (numbers axis)
  "Return an alist from the columns of a histogram, numbered from the beginning of AXIS, to the
count of NUMBERS in each column."
  (let ((counts (make-hash-table)))
    (dolist (number numbers)
      (incf (gethash (floor (- (axis-pixel number axis) (axis-from axis)) +histogram-column-width+)
                     counts 0)))
    (sort (loop for column being the hash-keys of counts using (hash-value count)
                collect (cons column count))
          #'< :key #'car)))

(defun draw-histogram (canvas numbers y axis)
  (let* ((columns (histogram-columns numbers axis))
         (most (reduce #'max columns :key #'cdr :initial-value 1)))
    (with-ink (#x8FB3CC)
      (loop for (column . count) in columns
            for height = (max 2 (* +histogram-column-height+ (/ count most)))
            do (draw-rectangle canvas draw-gcontext*
                               (+ (axis-from axis) (* column +histogram-column-width+)) (- y height)
                               (- +histogram-column-width+ 1/2) height t)))
    (with-ink (#x9A9A9A)
      (draw-line canvas draw-gcontext* (axis-from axis) y (axis-to axis) y))))

(defun draw-group (canvas group row axis)
  (destructuring-bind (numbers middle low high) (rest group)
    (let ((base (+ (row-middle row) 12)))
      (draw-histogram canvas numbers base axis)
      (draw-estimate canvas 3 (+ base 8) middle low high axis))))

(defun measure-chart (rows &key log-x (middle-label "median") title subtitle x-label (width 720))
  "Return a chart of the distributions of many numbers, by group, as an SVG document. ROWS are lists
(label numbers middle low high). NUMBERS, a sequence in which NIL is ignored, are drawn as a
histogram. Below the histogram is MIDDLE, such as their median, with the interval from LOW to HIGH;
MIDDLE, LOW and HIGH may be NIL. MIDDLE-LABEL names this statistic, by default \"median\". The scale
is logarithmic if LOG-X. The other arguments are those of LINE-CHART. Signals WRONG-ARGUMENT."
  (check-argument measure-chart rows (listp rows) "a list of rows")
  (let* ((groups (mapcar #'checked-group rows))
         (table (lay-out-table (mapcar (lambda (group) (group-entry group middle-label)) groups)
                               (loop for group in groups
                                     append (remove nil (cddr group))
                                     append (second group))
                               :title title :subtitle subtitle :x-label x-label :width width
                               :least (+ +histogram-column-height+ 20) :log-x log-x)))
    (table-svg table
               (lambda (canvas row number)
                 (draw-group canvas (elt groups number) row (table-x-axis table))))))
