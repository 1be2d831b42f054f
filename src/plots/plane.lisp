;;;; plane.lisp -- a page with a title, two axes and a legend, without overlaps.

(in-package :ars-magna.plots)

(defconstant +legend-sample-width+ 30 "The width of the sample of a series, in pixels.")
(defconstant +legend-entry-gap+ 6 "The gap between entries of the legend, in pixels.")

(defstruct (legend (:copier nil))
  "The legend beside a chart. TITLE is a list of lines of text, ENTRIES a list of lists (index
line...). If CONNECT is true, the samples of series show lines."
  (title '() :type list)
  (entries '() :type list)
  (connect t)
  (width 0 :type real)
  (height 0 :type real))

(defun legend-title-height (title)
  "Return the height, in pixels, of TITLE, a list of lines of text above the entries of a legend."
  (if title (+ +legend-entry-gap+ (text-lines-height title)) 0))

(defun lay-out-legend (names title most connect)
  "Return the legend for series with NAMES, below TITLE, a string or NIL, and at most MOST pixels
wide. If all names are empty, the legend is empty. If CONNECT, the samples show lines."
  (if (every (lambda (name) (string= "" name)) names)
      (make-legend)
      (let* ((room (- most +legend-sample-width+ 24))
             (title (wrap-text title (- most 24) :bold-p t))
             (entries (loop for name in names
                            for index from 0
                            collect (cons index (wrap-text name room)))))
        (make-legend :title title :entries entries :connect connect
                     :width (max (+ 24 (text-lines-width title +text-size+ t))
                                 (+ +legend-sample-width+ 24
                                    (reduce #'max entries :key (lambda (entry)
                                                                 (text-lines-width (rest entry))))))
                     :height (+ (legend-title-height title)
                                (loop for (nil . lines) in entries
                                      sum (+ +legend-entry-gap+
                                           (text-lines-height (or lines '(""))))))))))

(defun draw-legend-sample (canvas index x y connect)
  (when connect
    (with-series-look (index 1.8)
      (draw-line canvas draw-gcontext* x y (+ x +legend-sample-width+) y)))
  (draw-marker canvas index (+ x (/ +legend-sample-width+ 2)) y))

(defun draw-legend (canvas legend x y)
  (draw-text-lines canvas (+ x 16) (+ y 10) (legend-title legend) :bold-p t)
  (incf y (legend-title-height (legend-title legend)))
  (loop for (index . lines) in (legend-entries legend)
        do (draw-legend-sample canvas index (+ x 16) (+ y 6) (legend-connect legend))
           (draw-text-lines canvas (+ x 16 +legend-sample-width+ 8) (+ y 10) lines)
           (incf y (+ +legend-entry-gap+ (text-lines-height (or lines '("")))))))

(defconstant +least-data-area-height+ 170 "The least height of the area for the data, in pixels.")
(defconstant +least-data-area-width+ 200 "The least width of the area for the data, in pixels.")

(defstruct (page (:copier nil))
  "The layout of a chart. X-AXIS is the horizontal axis. LEFT, RIGHT, TOP and BOTTOM are the edges
of the area for the data, in pixels."
  heading x-axis x-lines
  (left 0) (right 0) (top 0) (bottom 0) (width 0) (height 0))

(defstruct (plot (:include page) (:copier nil))
  "A page with a vertical axis, Y-AXIS. BELOW is the top, in pixels, of the space below the
horizontal axis that some charts use."
  y-axis legend y-lines (below 0))

(defun lay-out-plot (make-across upward names
                     &key title subtitle x-label y-label legend-title (width 720) (height 440)
                       (connect t) (extra 0) (least-left 0)
                     &allow-other-keys)
  "Return a PLOT for series with NAMES. UPWARD is the vertical axis. The function MAKE-ACROSS is
called with the left and right pixel of the area for the data, and returns the horizontal axis.
EXTRA is the height to leave free at the bottom, LEAST-LEFT the least width at the left. The page
grows beyond WIDTH and HEIGHT if necessary."
  (check-chart-size width height)
  (let* ((heading (lay-out-heading title subtitle width))
         (legend (lay-out-legend names legend-title (* 4/10 width) connect))
         (y-lines (wrap-text y-label (- width (* 2 +chart-margin+))))
         (top (+ (heading-bottom heading) 14 (text-lines-height y-lines) (if y-lines 8 0)))
         (left (max least-left (+ +chart-margin+ (marks-width upward) 8)))
         (right (- width +chart-margin+ (max 16 (legend-width legend))))
         (across (funcall make-across left (max right (+ left +least-data-area-width+))))
         (right (axis-to across))
         (x-lines (wrap-text x-label (- right left)))
         (low (+ (marks-height across) (text-lines-height x-lines) (if x-lines 6 0)))
         (bottom (max (- height +chart-margin+ low extra) (+ top +least-data-area-height+)
                      (+ top (legend-height legend)))))
    (setf (axis-from upward) bottom (axis-to upward) top)
    (make-plot :heading heading :legend legend :x-axis across :y-axis upward
               :x-lines x-lines :y-lines y-lines :left left :right right :top top :bottom bottom
               :below (+ bottom low)
               :width (ceiling (+ right (max 16 (legend-width legend)) +chart-margin+))
               :height (ceiling (+ bottom low extra +chart-margin+)))))

(defun draw-y-axis (canvas plot)
  (loop with left = (plot-left plot)
        for (value . lines) in (axis-marks (plot-y-axis plot))
        for y = (axis-pixel value (plot-y-axis plot))
        do (with-ink (+grid-color+)
             (draw-line canvas draw-gcontext* left y (plot-right plot) y))
           (draw-text-lines canvas (- left 8) (+ y 4) lines :anchor :end)))

(defun draw-no-data-text (canvas page)
  (draw-text-lines canvas (/ (+ (page-left page) (page-right page)) 2)
                   (/ (+ (page-top page) (page-bottom page)) 2) '("no data")
                   :anchor :middle :color +faint-text-color+))

(defun draw-x-axis (canvas page)
  (let ((across (page-x-axis page)) (bottom (page-bottom page)))
    (draw-x-axis-marks canvas across bottom)
    (draw-text-lines canvas (/ (+ (page-left page) (page-right page)) 2)
                     (+ bottom (marks-height across) 15) (page-x-lines page) :anchor :middle)))

(defun draw-plot (canvas plot)
  (let ((left (plot-left plot)) (top (plot-top plot)) (right (plot-right plot))
        (bottom (plot-bottom plot)))
    (draw-text-lines canvas +chart-margin+ (- top 2 (text-lines-height (plot-y-lines plot)))
                     (plot-y-lines plot))
    (draw-y-axis canvas plot)
    (with-ink (+axis-color+ 1.2)
      (draw-lines canvas draw-gcontext* (list left top left bottom right bottom)))
    (draw-x-axis canvas plot)
    (draw-legend canvas (plot-legend plot) right top)))

(defun page-svg (page draw)
  (with-output-to-string (stream)
    (with-svg (canvas stream :font +text-font+)
      (with-canvas (canvas)
        (draw-heading canvas (page-heading page))
        (funcall draw canvas)
        (values (page-width page) (page-height page))))))

(defun plot-svg (plot data-p draw-data)
  "Return PLOT as an SVG document. If DATA-P is true, the function DRAW-DATA of a canvas draws the
data; else the chart has the text \"no data\"."
  (page-svg plot (lambda (canvas)
                   (draw-plot canvas plot)
                   (if data-p (funcall draw-data canvas) (draw-no-data-text canvas plot)))))
