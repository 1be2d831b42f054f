;;;; ways-picture.lisp -- the map with the ways of many trials over it, by what became of these.

(in-package :ars-magna.experiment)

(defparameter *outcome-looks*
  '(("success" 0 "succeeded") ("limit" 4 "came to the limit") ("failure" 1 "failed")
    ("error" 3 "broke off with an error"))
  "Lists (outcome look words), in the order of the legend.")

(defun scale-for (map)
  "Return how many pixels a metre of MAP has in a picture."
  (clamp (floor 720 (map-width map)) 4 20))

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

(defun ways-chart (experiment condition snapshot ways)
  "Return a picture of the world in SNAPSHOT with WAYS, of CONDITION of EXPERIMENT, in it."
  (let* ((map (snapshot-map snapshot)) (scale (scale-for map)))
    (drawing-chart (lambda (canvas)
                     (let ((graphics-scale* scale))
                       (with-opacity (canvas 1/2) (draw-terrain canvas map))
                       (draw-ways canvas ways)
                       (draw-movers canvas snapshot '())))
                   (* scale (map-width map)) (* scale (map-height map))
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

(addition save-ways-picture)
(defun save-ways-picture (experiment condition file &key (trials 50))
  "Save in FILE, replacing it, a map of the world of CONDITION of EXPERIMENT with the ways that its
robots went in TRIALS, the first so many or a list of their numbers: in colours that say what became
of each trial, with a marker where it ended. The trials are run again for that. CONDITION is as for
FIND-CONDITION. FILE is SVG or, where the program rsvg-convert is installed, PNG, as its name ends.
Return its truename. Signals UNKNOWN-NAME, WRONG-ARGUMENT, and MISUSE without that program."
  (picture-kind 'save-ways-picture file)
  (let* ((experiment (find-experiment experiment))
         (condition (find-condition experiment condition))
         (trials (trial-numbers trials)))
    (save-chart file (ways-chart experiment condition
                                 (start-of-trial experiment condition (first trials))
                                 (ways-of-trials experiment condition trials)))))
