;;;; rays.lisp -- rays per second of scans, and ticks per second of robots that look in each.

;;; Prints rays per second of fans of 50 rays over a right angle, in the walls of the manual's
;;; big-room and in a map of 1000 x 1000 cells in rooms of 20 x 20; then ticks per second of
;;; robots that search for objects in every tick, with ten things in view and
;;; with 100,000 more in the world that no camera sees.

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
(robot:defrobot looker (benchmark-room (20.5 30.5) 0) :cameras (((/ pi 2) 50)))
(robot:defrobot roomer (benchmark-rooms (505.5 505.5) 0) :cameras (((/ pi 2) 50)))

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

(defun measure-rays (name map things)
  (let* ((dice (base:make-dice 7)) (world (world:make-world (world:find-map map) :seed 1))
         (places (open-places world 1000 dice)) (fans 20000))
    (strew world things dice)
    (flet ((run () (scan-about world places fans)))
      (say name (per-second (* 50 fans) #'run) "rays/s")
      (say "  cells with things found per 1,000 scans" (/ (* 1000 (run)) fans) "")
      (say "  bytes allocated per scan" (/ (bytes-for #'run) fans) "bytes"))))

(measure-rays "50-ray scans, 75 x 75, no things" 'benchmark-room 0)
(measure-rays "50-ray scans, 75 x 75, 10 things" 'benchmark-room 10)
(measure-rays "50-ray scans, 75 x 75, 1,000 things" 'benchmark-room 1000)
(measure-rays "50-ray scans, 1000 x 1000 rooms, 100,000 things" 'benchmark-rooms 100000)

;;; Ticks.

(defun look-each-tick (robots simulation)
  "Let each of ROBOTS search for things in every tick of SIMULATION."
  (run:add-observer
   (lambda (simulation)
     (declare (ignore simulation))
     (dolist (robot robots)
       (robot:look-for-things (robot:robot-camera robot 0) :non-local '((:color green)))))
   simulation))

(defun measure-looking (name robot-name world-things near-things robots ticks)
  (run:call-with-simulation
   (lambda ()
     (let* ((dice (base:make-dice 7)) (world world:*world*)
            (robot (first (world:world-robots world))))
       (strew world near-things dice (floor (+ 2 (robot:robot-x robot)))
              (- (floor (robot:robot-y robot)) 2) 5)
       (strew world world-things dice 0 600 400)
       (loop repeat (1- robots) do (robot::make-robot (robot:robot-blueprint robot) world))
       (look-each-tick (world:world-robots world) (time:current-simulation))
       (say name (per-second ticks (lambda () (run:run-ticks ticks)) :runs 3) "ticks/s")))
   (list robot-name) :seed 1))

(measure-looking "one robot looks each tick, 75 x 75, 10 in view" 'looker 0 10 1 50000)
(measure-looking "one robot looks each tick, rooms, 10 in view" 'roomer 0 10 1 50000)
(measure-looking "  the same with 100,000 more things in the world" 'roomer 100000 10 1 50000)
(measure-looking "100 robots look each tick, 75 x 75, 10 in view" 'looker 0 10 100 500)
