;;;; plane.lisp -- a page with title, two axes and a legend, laid out so that nothing overlaps.

(in-package :ars-magna.plots)

(defconstant +least-height+ 170 "How high the place for the data is at least, in pixels.")
(defconstant +least-width+ 200 "How wide the place for the data is at least, in pixels.")

(defstruct (plane (:copier nil))
  "A page. What is across and upward are axes, LEFT to BOTTOM the box that they enclose, all in
pixels. BELOW is where what a chart adds below begins."
  heading across upward legend x-lines y-lines
  (left 0) (right 0) (top 0) (bottom 0) (below 0) (width 0) (height 0))

(defun plan-plane (make-across upward names
                   &key title subtitle x-label y-label legend-title (width 720) (height 440)
                     (connect t) (extra 0) (least-left 0)
                   &allow-other-keys)
  "Return a plane for series called NAMES. MAKE-ACROSS is called with the pixels where the data
begin and end, and returns an axis; UPWARD is one. EXTRA is how much room the chart wants below,
LEAST-LEFT how much to the left. The page becomes larger than WIDTH and HEIGHT where it must."
  (check-size width height)
  (let* ((heading (plan-heading title subtitle width))
         (legend (plan-legend names legend-title (* 4/10 width) connect))
         (y-lines (wrapped y-label (- width (* 2 +margin+))))
         (top (+ (heading-bottom heading) 14 (lines-height y-lines) (if y-lines 8 0)))
         (left (max least-left (+ +margin+ (marks-width upward) 8)))
         (right (- width +margin+ (max 16 (legend-width legend))))
         (across (funcall make-across left (max right (+ left +least-width+))))
         (right (axis-to across))
         (x-lines (wrapped x-label (- right left)))
         (low (+ (marks-height across) (lines-height x-lines) (if x-lines 6 0)))
         (bottom (max (- height +margin+ low extra) (+ top +least-height+)
                      (+ top (legend-height legend)))))
    (setf (axis-from upward) bottom (axis-to upward) top)
    (make-plane :heading heading :legend legend :across across :upward upward
                :x-lines x-lines :y-lines y-lines :left left :right right :top top :bottom bottom
                :below (+ bottom low)
                :width (ceiling (+ right (max 16 (legend-width legend)) +margin+))
                :height (ceiling (+ bottom low extra +margin+)))))

;;; Drawing it.

(defun draw-upward (canvas plane)
  "Draw the axis upward, with a faint line across at each mark."
  (loop with left = (plane-left plane)
        for (value . lines) in (axis-marks (plane-upward plane))
        for y = (place value (plane-upward plane))
        do (with-ink (+grid-ink+)
             (draw-line canvas draw-gcontext* left y (plane-right plane) y))
           (write-lines canvas (- left 8) (+ y 4) lines :anchor :end)))

(defun draw-no-data (canvas left top right bottom)
  (write-lines canvas (/ (+ left right) 2) (/ (+ top bottom) 2) '("no data") :anchor :middle
               :color +faint-ink+))

(defun draw-plane (canvas plane)
  (let ((left (plane-left plane)) (top (plane-top plane)) (right (plane-right plane))
        (bottom (plane-bottom plane)) (across (plane-across plane)))
    (draw-heading canvas (plane-heading plane))
    (write-lines canvas +margin+ (- top 2 (lines-height (plane-y-lines plane)))
                 (plane-y-lines plane))
    (draw-upward canvas plane)
    (with-ink (+line-ink+ 1.2)
      (draw-lines canvas draw-gcontext* (list left top left bottom right bottom)))
    (draw-marks-across canvas across bottom)
    (write-lines canvas (/ (+ left right) 2) (+ bottom (marks-height across) 15)
                 (plane-x-lines plane) :anchor :middle)
    (draw-legend canvas (plane-legend plane) right top)))

(defun plane-svg (plane data-p draw-data)
  "Return PLANE as an SVG document, with what DRAW-DATA draws on the canvas it is given, or a word
that there is nothing unless DATA-P."
  (page-svg (lambda (canvas)
              (draw-plane canvas plane)
              (if data-p
                  (funcall draw-data canvas)
                  (draw-no-data canvas (plane-left plane) (plane-top plane)
                                (plane-right plane) (plane-bottom plane))))
            (plane-width plane) (plane-height plane)))
