;;;; measure-chart.lisp -- many numbers along one axis: how they lie, group by group.

(in-package :ars-magna.plots)

(export '(measure-chart))

;;; The numbers of a group stand in columns of four pixels, as high as there are many in each. So
;;; ten numbers and ten thousand are drawn alike.

(defconstant +column-width+ 4 "How wide a column is, in pixels.")
(defconstant +column-height+ 28 "How high the highest column of a group is, in pixels.")

(defun checked-group (row)
  "Return ROW as a list (label numbers middle low high): NUMBERS, and what is in their middle, with
an interval."
  (check-argument measure-chart row
                  (and (consp row) (ignore-errors (<= 2 (length row) 5))
                       (typep (second row) 'sequence))
                  "a list (label numbers middle low high)")
  (destructuring-bind (label numbers &optional middle low high) row
    (list (name-text label) (remove nil (map 'list #'exact numbers))
          (exact middle) (exact low) (exact high))))

(defun group-values (group)
  (append (remove nil (cddr group)) (second group)))

(defun group-entry (group middle-label)
  (destructuring-bind (label numbers middle low high) group
    (list label
          (and middle
               (format nil "~A ~A" middle-label (interval-text middle low high #'figure-text)))
          (format nil "n = ~D" (length numbers)))))

(defun columns (numbers axis)
  "Return an alist from columns, counted from where AXIS begins, to how many NUMBERS are in each."
  (let ((counts (make-hash-table)))
    (dolist (number numbers)
      (incf (gethash (floor (- (place number axis) (axis-from axis)) +column-width+) counts 0)))
    (sort (loop for column being the hash-keys of counts using (hash-value count)
                collect (cons column count))
          #'< :key #'car)))

(defun draw-columns (canvas numbers y axis)
  (let* ((columns (columns numbers axis))
         (most (reduce #'max columns :key #'cdr :initial-value 1)))
    (with-ink (#x8FB3CC)
      (loop for (column . count) in columns
            for height = (max 2 (* +column-height+ (/ count most)))
            do (draw-rectangle canvas draw-gcontext*
                               (+ (axis-from axis) (* column +column-width+)) (- y height)
                               (- +column-width+ 1/2) height t)))
    (with-ink (#x9A9A9A)
      (draw-line canvas draw-gcontext* (axis-from axis) y (axis-to axis) y))))

(defun draw-group (canvas group row axis)
  (destructuring-bind (numbers middle low high) (rest group)
    (let ((base (+ (row-middle row) 12)))
      (draw-columns canvas numbers base axis)
      (draw-estimate canvas 3 (+ base 8) middle low high axis))))

(defun measure-chart (rows &key log-x (middle-label "median") title subtitle x-label (width 720))
  "Return a chart of many numbers as an SVG document. ROWS are lists (label numbers middle low
high): NUMBERS, a sequence, NIL among which do not count, are drawn as columns, as high as there are
many; below these what is in their middle, with its interval, any of which may be NIL. MIDDLE-LABEL
says what the middle is, such as the median. LOG-X: numbers on a logarithmic scale. The other
arguments are those of LINE-CHART. Signals WRONG-ARGUMENT."
  (check-argument measure-chart rows (listp rows) "a list of rows")
  (let* ((groups (mapcar #'checked-group rows))
         (table (plan-table (mapcar (lambda (group) (group-entry group middle-label)) groups)
                            (loop for group in groups append (group-values group))
                            :title title :subtitle subtitle :x-label x-label :width width
                            :least (+ +column-height+ 20) :log-x log-x)))
    (table-svg table
               (lambda (canvas row number)
                 (draw-group canvas (elt groups number) row (table-across table))))))
