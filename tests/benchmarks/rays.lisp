;;;; rays.lisp -- rays per second of scans, and ticks per second of robots that look in each.

;;; Prints rays per second of the fans of fans.lisp. Then prints ticks per second of robots that
;;; search for objects in every tick: with ten things in view, and with 100,000 more things that no
;;; camera sees.

(in-package :ars-magna.benchmarks)

(load (merge-pathnames "fans.lisp" *load-truename*))

(robot:defrobot looker (benchmark-room (20.5 30.5) 0) :cameras (((/ pi 2) 50)))
(robot:defrobot roomer (benchmark-rooms (505.5 505.5) 0) :cameras (((/ pi 2) 50)))

(defun measure-rays (name map things)
  (multiple-value-bind (world places) (world-with-things map things)
    (let ((fans 20000))
      (flet ((run () (scan-about world places fans)))
        (say name (per-second (* 50 fans) #'run) "rays/s")
        (say "  cells with things found per 1,000 scans" (/ (* 1000 (run)) fans) "")
        (say "  bytes allocated per scan" (/ (bytes-for #'run) fans) "bytes")))))

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

(defun define-lookers (count)
  "Define COUNT robots in free cells of a room, two cells apart. Return their names."
  (loop with map = (world:find-map 'benchmark-room)
        with places = (loop for y from 20.5d0 below 60 by 3
                            append (loop for x from 15.5d0 below 60 by 3
                                         unless (world:wall-at-p map x y) collect (list x y)))
        for number below count
        for name = (intern (format nil "LOOKER-~D" number) :ars-magna.benchmarks)
        do (robot:define-robot name 'benchmark-room (pop places) 0
             :cameras (list (list (/ pi 2) 50)))
        collect name))

(defun be-ghosts (world)
  (setf (world:world-ghosts-p world) t)
  (robot:arrange-robots world))

(defun measure-looking (name robot-names world-things near-things ticks &key ghosts)
  (run:call-with-simulation
   (lambda ()
     (let* ((dice (base:make-dice 7)) (world world:*world*)
            (robot (first (world:world-robots world))))
       (when ghosts (be-ghosts world))
       (strew world near-things dice (floor (+ 2 (robot:robot-x robot)))
              (- (floor (robot:robot-y robot)) 2) 5)
       (strew world world-things dice 0 600 400)
       (look-each-tick (world:world-robots world) (time:current-simulation))
       (say name (per-second ticks (lambda () (run:run-ticks ticks)) :runs 3) "ticks/s")))
   robot-names :seed 1))

(measure-looking "one robot looks each tick, 75 x 75, 10 in view" '(looker) 0 10 50000)
(measure-looking "one robot looks each tick, rooms, 10 in view" '(roomer) 0 10 50000)
(measure-looking "  the same with 100,000 more things in the world" '(roomer) 100000 10 50000)
(let ((lookers (define-lookers 100)))
  (measure-looking "100 robots look each tick, 75 x 75, ghosts" lookers 0 10 500 :ghosts t)
  (measure-looking "100 robots look each tick, 75 x 75, with bodies" lookers 0 10 500))
