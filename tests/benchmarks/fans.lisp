;;;; fans.lisp -- the rooms, places and fans that rays.lisp and rays-in-c.lisp measure.

;;; Fans of 50 rays over a right angle, in the walls of the manual's big-room and in a map of
;;; 1000 x 1000 cells in rooms of 20 x 20.

(in-package :ars-magna.benchmarks)

(world:defmap benchmark-room (75 75)
  (rect (0 0) (75 75) bricks 0 10 30 25)
  (wall (30 10) (30 50) slate 10 30))

(defparameter *rooms*
  (append '((rect (0 0) (1000 1000) bricks 1))
          (loop for y from 0 below 1000 by 20
                append (loop for x from 0 below 1000 by 20
                             collect `(wall (,x ,y) (,(+ x 8) ,y) bricks 1)
                             collect `(wall (,(+ x 10) ,y) (,(+ x 19) ,y) bricks 1)
                             collect `(wall (,x ,y) (,x ,(+ y 8)) slate 1)
                             collect `(wall (,x ,(+ y 10)) (,x ,(+ y 19)) slate 1)))))

(eval `(world:defmap benchmark-rooms (1000 1000) ,@*rooms*))

(defun strew (world count dice &optional (left 0) (top 0)
                                         (size (world:map-width (world:world-map world))))
  "Put COUNT things on open cells of a square of WORLD."
  (loop with placed = 0
        while (< placed count)
        do (let ((x (+ left (base:roll-between 0 size dice)))
                 (y (+ top (base:roll-between 0 size dice))))
             (unless (world:wall-at-p (world:world-map world) x y)
               (incf placed)
               (world:make-new-thing 'box (list world x y) '((:size 5) (:color red)))))))

(defun scan-about (world places fans)
  "Scan FANS times from PLACES, a vector of lists (x y); return how many cells were found."
  (let ((found 0) (width (/ pi 2)))
    (dotimes (fan fans found)
      (destructuring-bind (x y) (svref places (mod fan (length places)))
        (incf found (length (robot::occupied-cells world x y (* 0.7d0 fan) width 50
                                                   robot::+no-limit+)))))))

(defun open-places (world count dice)
  (let ((map (world:world-map world)))
    (coerce (loop while (plusp count)
                  for x = (base:roll-between 0 (world:map-width map) dice)
                  for y = (base:roll-between 0 (world:map-height map) dice)
                  unless (world:wall-at-p map x y)
                    collect (list x y) and do (decf count))
            'simple-vector)))

(defun world-with-things (map-name count)
  "Return a world of the map so called with COUNT things, and a vector of 1,000 open places in it."
  (let* ((dice (base:make-dice 7)) (world (world:make-world (world:find-map map-name) :seed 1))
         (places (open-places world 1000 dice)))
    (strew world count dice)
    (values world places)))
