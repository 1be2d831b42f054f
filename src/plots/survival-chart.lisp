;;;; survival-chart.lisp -- survival over time, as curves with steps.

(in-package :ars-magna.plots)

(export '(survival-chart))

(defstruct (curve (:constructor make-curve (name index steps censored times)) (:copier nil))
  "A survival curve. STEPS are lists (time survival low high), sorted by time; each is valid from
its time on. CENSORED are the times of censored trials, TIMES the times at which all trials ended."
  (name "" :read-only t)
  (index 0 :read-only t)
  (steps '() :type list :read-only t)
  (censored '() :type list :read-only t)
  (times '() :type list :read-only t))

(defun time-p (value) (and (finite-p value) (<= 0 value)))

(defun checked-step (step)
  (check-argument survival-chart step
                  (and (consp step) (ignore-errors (<= 2 (length step) 4))
                       (time-p (first step)) (probability-p (second step)))
                  "a list (time survival low high), with a time from 0 and a survival from 0 to 1")
  (destructuring-bind (time survival &optional low high) step
    (mapcar #'as-rational (list time survival low high))))

(defun checked-times (times)
  (check-argument survival-chart times
                  (and (typep times 'sequence) (every #'time-p times))
                  "a sequence of times from 0")
  (map 'list #'as-rational times))

(defun checked-curve (name index &key steps censored times)
  (make-curve (name-text name) index
              (cons '(0 1 nil nil)
                    (stable-sort (mapcar #'checked-step steps) #'< :key #'first))
              (checked-times censored) (checked-times times)))

(defun checked-curves (curves)
  (check-argument survival-chart curves (and (listp curves) (every #'consp curves))
                  "a list of curves, each a list (name :steps ... :censored ... :times ...)")
  (loop for (name . options) in curves
        for index from 0
        collect (apply #'checked-curve name index options)))

(defun curve-end (curve)
  (reduce #'max (append (mapcar #'first (curve-steps curve)) (curve-censored curve)
                        (curve-times curve))))

(defun step-at (time curve)
  (find time (curve-steps curve) :key #'first :test #'>= :from-end t))

(defun curve-has-data-p (curve)
  (or (rest (curve-steps curve)) (curve-censored curve) (curve-times curve)))

(defun count-at-risk (time curve)
  "Return the number of trials in CURVE that are at risk just before TIME."
  (count time (curve-times curve) :test #'<=))

;;; The curve.

(defun step-line-points (steps end reader plot)
  "Return points x y ... along STEPS until the time END. READER returns the value of a step."
  (loop for (step next) on steps
        for y = (axis-pixel (funcall reader step) (plot-y-axis plot))
        collect (axis-pixel (first step) (plot-x-axis plot))
        collect y
        collect (axis-pixel (if next (first next) end) (plot-x-axis plot))
        collect y))

(defun reverse-points (points)
  "Return POINTS, x y ..., in reverse order."
  (loop for (y x) on (reverse points) by #'cddr
        collect x
        collect y))

(defun confidence-bands (curve)
  "Return lists (end step...), one for each sequence of consecutive steps of CURVE that have an
interval. END is the time until which the last of these steps is valid."
  (loop with steps = (curve-steps curve)
        for band in (consecutive-sublists steps (lambda (step) (and (third step) (fourth step))))
        for next = (second (member (first (last band)) steps))
        collect (cons (if next (first next) (curve-end curve)) band)))

(defun draw-confidence-bands (canvas curve plot)
  (with-opacity (canvas 16/100)
    (with-ink ((series-color (curve-index curve)))
      (loop for (end . steps) in (confidence-bands curve)
            do (draw-lines canvas draw-gcontext*
                           (append (step-line-points steps end #'third plot)
                                   (reverse-points (step-line-points steps end #'fourth plot)))
                           :fill-p t)))))

(defun draw-censoring-marks (canvas curve plot)
  "Draw a short vertical line for each censored trial in CURVE, at most one line for each pixel."
  (let ((places (remove-duplicates
                 (loop for time in (remove-duplicates (curve-censored curve))
                       collect (list (round (axis-pixel time (plot-x-axis plot)))
                                     (axis-pixel (second (step-at time curve))
                                                 (plot-y-axis plot))))
                 :test #'equal)))
    (with-ink ((series-color (curve-index curve)) 1.4)
      (loop for (x y) in places
            do (draw-line canvas draw-gcontext* x (- y 5) x (+ y 5))))))

(defun draw-markers-along (canvas curve curves plot)
  "Draw up to four markers along CURVE, at times at which none of the other CURVES has markers."
  (loop with end = (reduce #'max curves :key #'curve-end)
        for turn below 4
        for time = (* end 1/4 (+ turn (/ (+ 1/2 (curve-index curve)) (length curves))))
        while (<= time (curve-end curve))
        do (draw-marker canvas (curve-index curve) (axis-pixel time (plot-x-axis plot))
                        (axis-pixel (second (step-at time curve)) (plot-y-axis plot)))))

(defun draw-curves (canvas curves plot)
  (let ((known (remove-if-not #'curve-has-data-p curves)))
    (dolist (curve known) (draw-confidence-bands canvas curve plot))
    (dolist (curve known)
      (with-series-look ((curve-index curve) 1.8)
        (draw-lines canvas draw-gcontext*
                    (step-line-points (curve-steps curve) (curve-end curve) #'second plot)))
      (draw-censoring-marks canvas curve plot))
    (dolist (curve known) (draw-markers-along canvas curve curves plot))))

;;; Below: the numbers at risk.

(defun risk-count-width (curves)
  (text-width (rounded-number-text (reduce #'max curves :key
                                           (lambda (curve) (length (curve-times curve)))
                                                        :initial-value 0))
              +text-size+))

(defun draw-risk-counts (canvas curves plot label)
  (let ((y (+ (plot-below plot) 20)))
    (draw-text-lines canvas +chart-margin+ y (list label) :color +faint-text-color+)
    (dolist (curve curves)
      (incf y +chart-line-height+)
      (draw-legend-sample canvas (curve-index curve) +chart-margin+ (- y 4) t)
      (dolist (mark (axis-marks (plot-x-axis plot)))
        (draw-text-lines canvas (axis-pixel (first mark) (plot-x-axis plot)) y
                         (list (format nil "~D" (count-at-risk (first mark) curve)))
                         :anchor :middle)))))

(defun survival-chart (curves &rest options
                       &key (risk-label "still there") title subtitle x-label y-label legend-title
                         width height)
  "Return a chart of survival CURVES as an SVG document. Each curve is a list (name :steps steps
:censored times :times times). A step is a list (time survival low high): the share that survives
from that time on, from 0 to 1, and the bounds of its confidence band; before the first step the
share is 1. TIMES are the times at which the trials ended, by the event or censoring; CENSORED are
the times of the censored trials. Below the chart are the numbers at risk, computed from TIMES, with
the heading RISK-LABEL. The other arguments are those of LINE-CHART. Signals WRONG-ARGUMENT."
  (declare (ignore title subtitle x-label y-label legend-title width height))
  (check-argument survival-chart risk-label (stringp risk-label) "a string")
  (let* ((curves (checked-curves curves))
         (ends (cons 0 (mapcar #'curve-end curves)))
         (plot (apply #'lay-out-plot
                       (lambda (from to)
                         (numeric-x-axis ends from to nil
                                         :least (risk-count-width curves) :inset 8))
                       (numeric-y-axis '() t '(0 1))
                       (mapcar (lambda (curve)
                                 (legend-label (curve-name curve) (curve-has-data-p curve)))
                               curves)
                       :extra (if (some #'curve-times curves)
                                  (+ 10 (* +chart-line-height+ (1+ (length curves))))
                                  0)
                       :least-left (+ +chart-margin+ +legend-sample-width+ 14
                                      (/ (risk-count-width curves) 2))
                       options)))
    (plot-svg plot (some #'curve-has-data-p curves)
               (lambda (canvas)
                 (draw-curves canvas curves plot)
                 (when (some #'curve-times curves)
                   (draw-risk-counts canvas curves plot risk-label))))))
