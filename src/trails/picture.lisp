;;;; picture.lisp -- a map with the ways of many trials over it, by what became of these.

(in-package :ars-magna.trails)

(defparameter *outcome-looks*
  '(("success" 0 "succeeded") ("limit" 4 "came to the limit") ("failure" 1 "failed")
    ("error" 3 "broke off with an error"))
  "Lists (outcome look words), in the order of the legend.")

(defun scale-for (width height)
  "Return how many pixels a metre has in a picture of WIDTH by HEIGHT metres."
  (clamp (floor 720 (max width height)) 4 40))

(defun way-opacity (count)
  "Return how much one of COUNT ways hides what is below."
  (clamp (/ 8 (max 1 count)) 12/100 6/10))

(defun draw-way (canvas way look)
  (let ((points (straightened (way-points way) (/ 1/2 graphics-scale*))))
    (when (rest points)
      (with-gcontext (draw-gcontext* :foreground (look-color look) :line-width 1.6)
        (draw-lines canvas draw-gcontext*
                    (loop for (x . y) in points
                          collect (* graphics-scale* x) collect (* graphics-scale* y)))))))

(defun draw-end (canvas way look)
  (let ((points (way-points way)))
    (when (plusp (length points))
      (destructuring-bind (x . y) (svref points (1- (length points)))
        (draw-marker canvas look (* graphics-scale* x) (* graphics-scale* y) 4)))))

(defun look-of (way)
  (second (assoc (way-outcome way) *outcome-looks* :test #'string=)))

(defun draw-ways (canvas ways)
  "Draw WAYS, in order, so faint that many can be told apart, and above them where they end."
  (dolist (way ways)
    (with-opacity (canvas (way-opacity (length ways))) (draw-way canvas way (look-of way))))
  (dolist (way ways)
    (with-opacity (canvas 8/10) (draw-end canvas way (look-of way)))))

(defun ways-entries (ways)
  "Return the entries of the legend for WAYS."
  (loop for (outcome look words) in *outcome-looks*
        for count = (length (remove-duplicates
                             (loop for way in ways
                                   when (string= outcome (way-outcome way))
                                     collect (way-trial way))))
        when (plusp count)
          collect (list look (format nil "~A: ~D trial~:P" words count))))

(defun draw-ways-on-map (canvas snapshot ways left top)
  "Draw WAYS and the world of SNAPSHOT, so that the point LEFT, TOP of it is in the upper left."
  (with-origin (canvas (- (* graphics-scale* left)) (- (* graphics-scale* top)))
    (with-opacity (canvas 1/2) (draw-terrain canvas (snapshot-map snapshot)))
    (draw-ways canvas ways)
    (draw-movers canvas snapshot '())))

(defun ways-chart (snapshot ways part title subtitle)
  "Return a picture of the world in SNAPSHOT with WAYS in it, of its PART (left top right bottom),
under TITLE and SUBTITLE."
  (destructuring-bind (left top right bottom) part
    (let* ((width (- right left)) (height (- bottom top)) (scale (scale-for width height)))
      (drawing-chart (lambda (canvas)
                       (let ((graphics-scale* scale))
                         (draw-ways-on-map canvas snapshot ways left top)))
                     (* scale width) (* scale height)
                     :title title
                     :subtitle subtitle
                     :entries (ways-entries ways)))))

(defun part-of-map (operator part map)
  "Return the list (left top right bottom) that PART, an argument of OPERATOR, means of MAP: all if
it is NIL. Signals WRONG-ARGUMENT."
  (let ((width (map-width map)) (height (map-height map)))
    (unless (or (null part)
                (and (proper-list-p part) (= 4 (length part)) (every #'integerp part)
                     (destructuring-bind (left top right bottom) part
                       (and (< -1 left right (1+ width)) (< -1 top bottom (1+ height))))))
      (reject-argument operator 'part part
                       (format nil "a list (left top right bottom) of integers within ~D x ~D, or ~
                                    NIL" width height)))
    (or part (list 0 0 width height))))
