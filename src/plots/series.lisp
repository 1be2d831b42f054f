;;;; series.lisp -- the data of a chart of points, checked and made exact.

(in-package :ars-magna.plots)

(defstruct (spot (:constructor make-spot (x y low high)) (:copier nil))
  "A point of a series: Y at X, between LOW and HIGH. X is a number or a text; all else may be NIL."
  (x nil :read-only t)
  (y nil :read-only t)
  (low nil :read-only t)
  (high nil :read-only t))

(defstruct (series (:constructor make-series (name index spots)) (:copier nil))
  "Points in the order in which they are given. INDEX decides the look."
  (name nil :read-only t)
  (index 0 :read-only t)
  (spots '() :type list :read-only t))

(defun make-checked-spot (point words-p)
  (check-argument chart point (and (consp point) (ignore-errors (<= 2 (length point) 4)))
                  "a list (x y) or (x y low high)")
  (destructuring-bind (x y &optional low high) point
    (check-argument chart x (not (null x)) "a number, or a word such as the name of a condition")
    (make-spot (if words-p (name-text x) (exact x)) (exact y) (exact low) (exact high))))

(defun words-p (all)
  "True if some point in the lists ALL has an X that is no number."
  (some (lambda (entry)
          (some (lambda (point) (and (consp point) (not (realp (first point))))) (rest entry)))
        all))

(defun checked-series (all)
  "Return series for ALL, a list of lists (name point...); true as well if X are words."
  (check-argument chart all (and (listp all) (every #'consp all))
                  "a list of series, each a list (name (x y low high) ...)")
  (let ((words-p (words-p all)))
    (values (loop for (name . points) in all
                  for index from 0
                  collect (make-series (name-text name) index
                                       (mapcar (lambda (point) (make-checked-spot point words-p))
                                               points)))
            words-p)))

(defun all-spots (series) (mapcan (lambda (one) (copy-list (series-spots one))) series))

(defun all-x (series)
  "Return what there is along the axis across, each once, in order of appearance."
  (remove-duplicates (mapcar #'spot-x (all-spots series)) :test #'equal :from-end t))

(defun all-y (series)
  (loop for spot in (all-spots series)
        append (remove nil (list (spot-y spot) (spot-low spot) (spot-high spot)))))

;;; Series side by side, so that their intervals do not hide each other.

(defun least-gap (places)
  "Return how far the nearest two of PLACES are apart, in pixels; 60 if there are no two."
  (let ((sorted (sort (copy-list places) #'<)))
    (loop for (place next) on sorted
          while next
          minimize (- next place) into gap
          finally (return (if (rest sorted) gap 60)))))

(defconstant +most-sideways+ 8 "How far series stand beside each other at most, in pixels.")

(defun step-sideways (count gap)
  "Return how far COUNT series stand beside each other, for places that are GAP pixels apart."
  (min +most-sideways+ (/ (* 6/10 gap) (max 1 count))))

(defun room-beside (series values from to log-p)
  "Return how far VALUES should be from the ends of an axis between the pixels FROM and TO, so that
all SERIES find room beside them."
  (let* ((spots (mapcar (lambda (value) (spot-of value log-p)) values))
         (span (if spots (- (reduce #'max spots) (reduce #'min spots)) 0))
         (gap (if (zerop span) 60 (* (- to from) (/ (least-gap spots) span)))))
    (+ 14 (* 1/2 (length series) (step-sideways (length series) gap)))))

(defun sideways (series places from)
  "Return a function from an index of SERIES to how many pixels that stands to the right of PLACES,
on an axis that begins at FROM."
  (let* ((middle (/ (1- (length series)) 2))
         (room (if places (- (reduce #'min places) from 7) 0))
         (step (min (step-sideways (length series) (least-gap places))
                    (/ room (max 1 middle)))))
    (lambda (index) (* step (- index middle)))))

(defun legend-name (name known-p)
  "Return what the legend says of what is called NAME, if something of it is KNOWN-P or not."
  (if (or known-p (string= "" name))
      name
      (concatenate 'string name " (no data)")))
