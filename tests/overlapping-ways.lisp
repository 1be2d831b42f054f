;;;; overlapping-ways.lisp -- pictures in which several ways go along one line.

(in-package :ars-magna.tests)

(in-suite display)

(defun call-with-two-walkers (function)
  "Call FUNCTION with two robots that begin on one spot of a hall."
  (with-own-definitions
    (eval '(world:defmap hall-for-two (20 6) (rect (0 0) (20 6) bricks 5)))
    (eval '(robot:defrobot walker-1 (hall-for-two (3 3) 0)))
    (eval '(robot:defrobot walker-2 (hall-for-two (3 3) 0)))
    (run:call-with-simulation
     (lambda () (funcall function (robot:find-robot 'walker-1) (robot:find-robot 'walker-2)))
     '(walker-1 walker-2) :seed 1 :journal t :clean t :ghosts t)))

(defun walk-from-one-spot (robots &rest distances)
  "Let each of ROBOTS go one of DISTANCES."
  (mapc #'command:robot-go-forward robots distances)
  (run:run-ticks 30))

(defun line-colours-in (picture)
  "Return the colours of the lines in PICTURE that are no outlines of robots, in order."
  (loop for line in (append (drawn-with :polyline picture))
        collect (of-element line :stroke)))

(defun ways-seen-p (picture)
  "True if PICTURE has lines of two colours at least, and no white one above any of these."
  (let ((coloured (member "#ffffff" (line-colours-in picture) :test-not #'equal)))
    (and (not (find "#ffffff" coloured :test #'equal))
         (<= 2 (length (remove-duplicates coloured :test #'equal))))))

(defun starts-in (picture ink)
  "Return the radii of the small rings of the colour INK in PICTURE, as they are drawn."
  (loop for ring in (drawn-with :ellipse picture :stroke (web ink))
        when (< (of-element ring :rx) 12) collect (of-element ring :rx)))

(test ways.of-two-robots-along-one-line-are-both-seen
  "The ring where one begins is around that of the other."
  (call-with-two-walkers
   (lambda (first second)
     (walk-from-one-spot (list first second) 14 10)
     (dolist (in-color '(t nil))
       (let* ((picture (run-picture :layers '() :in-color in-color))
              (above (member "#ffffff" (line-colours-in picture) :test-not #'equal)))
         (is (= 2 (length above)))
         (is (not (find "#ffffff" above :test #'equal)))))
     (let ((picture (run-picture :layers '())))
       (is (ways-seen-p picture))
       (is (null (intersection (starts-in picture (display:nth-ink 0))
                               (starts-in picture (display:nth-ink 1)))))))))

(test ways.that-are-given-are-all-seen-where-they-overlap
  (call-with-two-walkers
   (lambda (first second)
     (declare (ignore first second))
     (with-scratch-file (file "svg")
       (display:save-way-picture 'hall-for-two '(((2 2) (15 2)) ((2 2) (10 2)) ((15 2) (2 2)))
                                 file :layers '())
       (let ((picture (uiop:read-file-string file)))
         (is (ways-seen-p picture))
         (is (= 3 (length (remove-duplicates
                           (mapcar (lambda (line) (of-element line :points))
                                   (remove "#ffffff" (drawn-with :polyline picture)
                                           :key (lambda (line) (of-element line :stroke))
                                           :test #'equal))
                           :test #'equal)))))))))

(test trails.of-two-robots-along-one-line-are-both-seen
  "In pictures and in films."
  (call-with-two-walkers
   (lambda (first second)
     (display:keep-history)
     (walk-from-one-spot (list first second) 14 10)
     (is (ways-seen-p (display:svg-picture first :layers '(:trail))))
     (with-scratch-file (file "svg")
       (display:save-animation nil file :every 30 :layers '(:trail))
       (is (ways-seen-p (first (last (split-by "<animate" (uiop:read-file-string file))))))))))

(test planned-ways.have-the-colours-of-their-robots
  (call-with-two-walkers
   (lambda (first second)
     (robot:publish-way first '((3 3) (9 3)))
     (robot:publish-way second '((3 3) (7 3)))
     (let ((picture (display:svg-picture first :layers '(:planned-way))))
       (is (ways-seen-p picture))
       (dolist (robot '(0 1))
         (is (mentions-p picture (web (display:nth-ink robot)))))))))

(test jumps.hide-no-way
  "Dots where a robot was put back along its way are below that, and the legend has none of them."
  (call-with-two-walkers
   (lambda (first second)
     (walk-from-one-spot (list first second) 14 10)
     (robot:place-robot second 5 3 0)
     (run:run-ticks 2)
     (let ((picture (run-picture :layers '())))
       (is (ways-seen-p picture))
       (is (< (search "stroke-dasharray=\"1,6\"" picture)
              (search (web (display:nth-ink 0)) picture))))
     (is (not (mentions-p (run-picture) "put elsewhere")))
     (robot:place-robot second 5 4.5 0)
     (run:run-ticks 2)
     (is (mentions-p (run-picture) "put elsewhere"))
     (is (not (mentions-p (run-picture :part '(10 0 20 6)) "put elsewhere"))))))

(test series.says-which-file-cannot-be-written
  "And which are there."
  (call-with-two-walkers
   (lambda (first second)
     (walk-from-one-spot (list first second) 14 10)
     (with-scratch-file (file "svg")
       (let ((third (display::numbered-file file 3)))
         (ensure-directories-exist (uiop:ensure-directory-pathname third))
         (let ((said (handler-case (display:save-animation nil file :series t :every 5)
                       (base:misuse (trouble) (text-of trouble)))))
           (is (stringp said))
           (when (stringp said)
             (is (mentions-p said "-0003.svg"))
             (is (mentions-p said "-0001.svg to "))
             (is (mentions-p said "-0002.svg"))))
         (uiop:delete-empty-directory (uiop:ensure-directory-pathname third))
         (dolist (number '(1 2)) (delete-file (display::numbered-file file number))))))))
