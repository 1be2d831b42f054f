;;;; ways-picture.lisp -- the map with the ways of many trials over it, by what became of these.

(in-package :ars-magna.experiment)

(defparameter *outcome-looks*
  '(("success" 0 "succeeded") ("limit" 4 "came to the limit") ("failure" 1 "failed")
    ("error" 3 "broke off with an error"))
  "Lists (outcome look words), in the order of the legend.")

(defun scale-for (width)
  "Return how many pixels a metre has in a picture of WIDTH metres."
  (clamp (floor 720 width) 4 40))

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

(defun ways-chart (experiment condition snapshot ways part)
  "Return a picture of the world in SNAPSHOT with WAYS, of CONDITION of EXPERIMENT, in it: of the
PART (left top right bottom)."
  (destructuring-bind (left top right bottom) part
    (drawing-chart (lambda (canvas)
                     (let ((graphics-scale* (scale-for (- right left))))
                       (draw-ways-on-map canvas snapshot ways left top)))
                   (* (scale-for (- right left)) (- right left))
                   (* (scale-for (- right left)) (- bottom top))
                   :title (or (question-of (experiment-name experiment))
                              (string-downcase (experiment-name experiment)))
                   :subtitle (format nil "~A. The ways of all trials, with a marker at the end of ~
                                          each. Robots and things are where a trial begins."
                                     (condition-name condition))
                   :entries (ways-entries ways))))

(defun trial-numbers (trials)
  "Return the numbers of the trials that TRIALS, an argument of SAVE-WAYS-PICTURE, means."
  (check-argument save-ways-picture trials
                  (or (whole-p trials 1 10000)
                      (and (consp trials) (proper-list-p trials)
                           (every (lambda (trial) (whole-p trial 1)) trials)))
                  "how many trials, from 1 to 10000, or a list of their numbers, from 1")
  (if (consp trials)
      trials
      (loop for trial from 1 to trials collect trial)))

(defun part-of-map (part map)
  "Return the list (left top right bottom) that PART, an argument of SAVE-WAYS-PICTURE, means."
  (let ((width (map-width map)) (height (map-height map)))
    (check-argument save-ways-picture part
                    (or (null part)
                        (and (proper-list-p part) (= 4 (length part)) (every #'integerp part)
                             (destructuring-bind (left top right bottom) part
                               (and (< -1 left right (1+ width)) (< -1 top bottom (1+ height))))))
                    (format nil "a list (left top right bottom) of integers within ~D x ~D, or NIL"
                            width height))
    (or part (list 0 0 width height))))

(addition save-ways-picture)
(defun save-ways-picture (experiment condition file &key (trials 50) part)
  "Save in FILE, replacing it, a map of the world of CONDITION of EXPERIMENT with the ways that its
robots went in TRIALS, the first so many or a list of their numbers: in colours that say what became
of each trial, with a marker where it ended. The trials are run again for that. CONDITION is as for
FIND-CONDITION. PART (left top right bottom), in cells, is what is wanted of the map, by default
all. FILE is SVG or, where the program rsvg-convert is installed, PNG, as its name ends. Return its
truename. Signals UNKNOWN-NAME, WRONG-ARGUMENT, and MISUSE without that program."
  (picture-kind 'save-ways-picture file)
  (let* ((experiment (find-experiment experiment))
         (condition (find-condition experiment condition))
         (trials (trial-numbers trials))
         (snapshot (start-of-trial experiment condition (first trials)))
         (part (part-of-map part (snapshot-map snapshot))))
    (save-chart file (ways-chart experiment condition snapshot
                                 (ways-of-trials experiment condition trials) part))))
