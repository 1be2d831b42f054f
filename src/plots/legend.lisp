;;;; legend.lisp -- which look means which series, beside the chart.

(in-package :ars-magna.plots)

(defconstant +sample-width+ 30 "How wide the sample of a series is, in pixels.")
(defconstant +entry-gap+ 6 "How far entries of the legend are apart, in pixels.")

(defstruct (legend (:copier nil))
  "What stands beside a chart: the lines TITLE, and ENTRIES, lists (index line...)."
  (title '() :type list)
  (entries '() :type list)
  (connect t)
  (width 0 :type real)
  (height 0 :type real))

(defun title-height (title)
  "Return how much room TITLE, lines, takes above the entries."
  (if title (+ +entry-gap+ (lines-height title)) 0))

(defun plan-legend (names title most connect)
  "Return the legend for series called NAMES below TITLE, a string or NIL, at most MOST pixels wide;
one of no width if all are empty. CONNECT: lines belong to the samples."
  (if (every (lambda (name) (string= "" name)) names)
      (make-legend)
      (let* ((room (- most +sample-width+ 24))
             (title (wrapped title (- most 24) :bold-p t))
             (entries (loop for name in names
                            for index from 0
                            collect (cons index (wrapped name room)))))
        (make-legend :title title :entries entries :connect connect
                     :width (max (+ 24 (lines-width title +text-size+ t))
                                 (+ +sample-width+ 24
                                    (reduce #'max entries :key (lambda (entry)
                                                                 (lines-width (rest entry))))))
                     :height (+ (title-height title)
                                (loop for (nil . lines) in entries
                                      sum (+ +entry-gap+ (lines-height (or lines '(""))))))))))

(defun draw-sample (canvas index x y connect)
  "Draw how the series INDEX looks from X, around Y."
  (when connect
    (with-look (index 1.8)
      (draw-line canvas draw-gcontext* x y (+ x +sample-width+) y)))
  (draw-marker canvas index (+ x (/ +sample-width+ 2)) y))

(defun draw-legend (canvas legend x y)
  (write-lines canvas (+ x 16) (+ y 10) (legend-title legend) :bold-p t)
  (incf y (title-height (legend-title legend)))
  (loop for (index . lines) in (legend-entries legend)
        do (draw-sample canvas index (+ x 16) (+ y 6) (legend-connect legend))
           (write-lines canvas (+ x 16 +sample-width+ 8) (+ y 10) lines)
           (incf y (+ +entry-gap+ (lines-height (or lines '("")))))))
