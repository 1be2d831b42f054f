;;;; ways.lisp -- how long it takes to find a way, and another after cells are barred.

(in-package :ars-magna.benchmarks)

(world:defmap benchmark-ground (75 75)
  (rect (0 0) (75 75) bricks 0 10 30 25)
  (wall (25 0) (25 30) bricks 1)
  (wall (25 32) (25 74) bricks 1)
  (wall (50 0) (50 50) bricks 1)
  (wall (50 52) (50 74) bricks 1)
  (wall (25 40) (36 40) bricks 1)
  (wall (38 40) (50 40) bricks 1))

(defparameter *ground-of-rooms*
  (append '((rect (0 0) (1000 1000) bricks 1))
          (loop for y from 0 below 1000 by 20
                append (loop for x from 0 below 1000 by 20
                             collect `(wall (,x ,y) (,(+ x 8) ,y) bricks 1)
                             collect `(wall (,(+ x 10) ,y) (,(+ x 19) ,y) bricks 1)
                             collect `(wall (,x ,y) (,x ,(+ y 8)) bricks 1)
                             collect `(wall (,x ,(+ y 10)) (,x ,(+ y 19)) bricks 1)))))

(eval `(world:defmap benchmark-ground-of-rooms (1000 1000) ,@*ground-of-rooms*))

(defun random-ends (map count dice)
  "Return COUNT lists (start goal) of points of MAP."
  (flet ((free ()
           (loop for x = (base:roll-between 1 (1- (world:map-width map)) dice)
                 for y = (base:roll-between 1 (1- (world:map-height map)) dice)
                 unless (world:wall-at-p map x y) return (list x y))))
    (loop repeat count collect (list (free) (free)))))

(defun points-ahead (way count)
  "Return COUNT points on WAY, five metres apart, the first five metres from its start; fewer if it
is short."
  (let ((points '()) (gone 5))
    (loop for (point next) on way
          while next
          do (let* ((dx (- (geo:pt-x next) (geo:pt-x point)))
                    (dy (- (geo:pt-y next) (geo:pt-y point)))
                    (length (sqrt (+ (* dx dx) (* dy dy)))))
               (loop while (and (< gone length) (< (length points) count))
                     do (push (list (+ (geo:pt-x point) (* (/ gone length) dx))
                                    (+ (geo:pt-y point) (* (/ gone length) dy)))
                              points)
                        (incf gone 5))
               (decf gone length)))
    points))

(defun bar-and-free (chart start goal points)
  "Find the way from START to GOAL with POINTS barred, and that with POINTS free again."
  (dolist (point points) (ars:bar-cell chart point 20))
  (ars:find-way chart start goal)
  (dolist (point points) (ars:free-cell chart point))
  (ars:find-way chart start goal))

(defun measure-replanning (chart ends barred times)
  "Return how many seconds it takes to find another way after BARRED cells have changed."
  (/ (loop for (start goal) in ends
           for points = (points-ahead (ars:find-way chart start goal) barred)
           ;; With a cell barred elsewhere the chart keeps a field of its own.
           do (ars:free-all-cells chart)
              (ars:bar-cell chart goal 1/100)
              (ars:find-way chart start goal)
           sum (seconds-for (lambda ()
                              (loop repeat times do (bar-and-free chart start goal points)))))
     (* 2 times (length ends))))

(defun measure-ways (name map count times)
  (let* ((map (world:find-map map)) (ends (random-ends map count (base:make-dice 5)))
         (chart (ars:make-chart map)))
    (flet ((tell (what seconds)
             (say (format nil "~A, ~A" name what) (* 1d6 seconds) "us"))
           (seconds-each (times function)
             (/ (seconds-for (lambda ()
                               (loop repeat times
                                     do (loop for (start goal) in ends
                                              do (funcall function chart start goal)))))
                (* times count))))
      (tell "a first way" (seconds-each 1 #'ars:find-way))
      (setf ends (subseq ends (- count 2)))
      (setf count 2)
      (tell "another to the same goal" (seconds-each (* 50 times) #'ars:find-way))
      (tell "no more than its first turn" (seconds-each (* 50 times) #'ars:next-point))
      (dolist (barred '(1 5))
        (tell (format nil "another after ~D cell~:P changed" barred)
              (measure-replanning chart ends barred times))))))

(measure-ways "75 x 75" 'benchmark-ground 200 200)
(measure-ways "1000 x 1000 rooms" 'benchmark-ground-of-rooms 8 5)
