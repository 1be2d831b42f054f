;;;; difference-chart.lisp -- differences with intervals, one below the other, against zero.

(in-package :ars-magna.plots)

(export '(difference-chart))

(defun checked-difference (row)
  "Return ROW as a list (label estimate low high words): what is compared, an estimate with an
interval, any of which may be NIL, and what else is said of it."
  (check-argument difference-chart row (and (consp row) (ignore-errors (<= 2 (length row) 5)))
                  "a list (label estimate low high words)")
  (destructuring-bind (label estimate &optional low high words) row
    (list (name-text label) (exact estimate) (exact low) (exact high) words)))

(defun signed-text (value percent)
  (concatenate 'string (if (and value (plusp value)) "+" "")
               (figure-text value :percent percent :digits 3)))

(defun interval-text (value low high text)
  "Return what is said of VALUE and its interval, each written by the function TEXT."
  (cond ((null value) "no data")
        ((and low high)
         (format nil "~A (~A to ~A)" (funcall text value) (funcall text low) (funcall text high)))
        (t (funcall text value))))

(defun difference-entry (difference percent)
  (destructuring-bind (label estimate low high words) difference
    (list label
          (interval-text estimate low high (lambda (value) (signed-text value percent)))
          words)))

(defun draw-estimate (canvas index y value low high across)
  "Draw VALUE with its interval along the axis ACROSS at Y, with the look of INDEX."
  (when (and low high)
    (with-ink ((look-color index) 1.8)
      (draw-interval-across canvas y (place low across) (place high across))))
  (when value
    (draw-marker canvas index (place value across) y 5)))

(defun draw-zero (canvas table)
  (let ((x (place 0 (table-across table))))
    (with-ink (+line-ink+ 1.2)
      (draw-line canvas draw-gcontext* x (table-top table) x (table-bottom table)))))

(defun difference-chart (rows &key percent title subtitle x-label (width 720))
  "Return a chart of differences, one below the other against a line at 0, as an SVG document. ROWS
are lists (label estimate low high words): what is compared, the difference, its interval, and what
else is said of it, such as \"p = 0.03\". All but LABEL may be NIL. PERCENT: they are shown as
hundredths. The other arguments are those of LINE-CHART. Signals WRONG-ARGUMENT."
  (check-argument difference-chart rows (listp rows) "a list of rows")
  (let* ((differences (mapcar #'checked-difference rows))
         (table (plan-table (mapcar (lambda (difference) (difference-entry difference percent))
                                    differences)
                            (cons 0 (loop for difference in differences
                                          append (remove nil (subseq difference 1 4))))
                            :title title :subtitle subtitle :x-label x-label :width width
                            :percent percent)))
    (table-svg table
               (lambda (canvas row number)
                 (when (zerop number) (draw-zero canvas table))
                 (destructuring-bind (estimate low high) (subseq (elt differences number) 1 4)
                   (draw-estimate canvas 0 (row-middle row) estimate low high
                                  (table-across table)))))))
