;;;; hall.lisp -- a great hall, for a first session at the prompt.

;;; For the session of appendix E. PORTER is built like ROBBIE. It starts beside a lamp and a small
;;; box with a pen in it; it can look into the box, reach in and stow the pen. Nothing moves by
;;; itself. The walls' parameters go from 0 to 30 around the hall, so a view shows where the robot
;;; is. North is up, y grows downwards. Each character is 3 x 3 metres: # contains a wall, + a
;;; doorway, > PORTER at its start.
;;;
;;;   #########################
;;;   #.................#.....#
;;;   #.................#.....#
;;;   #....#......#.....#.....#
;;;   #.................#.....#
;;;   #.................#.....#
;;;   #.....>...........#.....#
;;;   #.................#.....#
;;;   #.................#.....#
;;;   #.................#.....#
;;;   #.................#.....#
;;;   #.................#.....#
;;;   #.................+.....#
;;;   #.................#.....#
;;;   #...#########.....#.....#
;;;   #.................#.....#
;;;   #.................#.....#
;;;   #.................#.....#
;;;   #.................#.###.#
;;;   #.................#.###.#
;;;   #....#......#.....#.....#
;;;   #.................#.....#
;;;   #.................#.....#
;;;   #.................#.....#
;;;   #########################

(in-package :ars-worlds)
(in-readtable :nisp)

(defmap hall (75 75)
  (rect (0 0) (75 75) bricks 0 12 30 18)
  ;; The east end is a separate room, with a doorway.
  (wall (54 0) (54 35) plaster 9 16)
  (wall (54 37) (54 74) plaster 16 24)
  ;; A screen, four pillars and a round one.
  (wall (12 42) (36 42) slate 6 21)
  (rect (15 9) (16 10) stone 28)
  (rect (36 9) (37 10) stone 26)
  (rect (15 60) (16 61) stone 24)
  (rect (36 60) (37 61) stone 22)
  (circle (64 57) 2 bricks 15)
  (rect (63 56) (65 58) bricks 15)
  (wall (64 57) (64 57) bricks 15)

  ;; These three come first, so they are LAMP#1, PEN#2, SMALL-BOX#3.
  (obj (lamp :prototype lamp*) (20 20) ())
  (obj small-box (20 20) ((:capacity 5) (:size 5) (:weight 2)
                          (:color lightblue) (:substance wood))
    (pen ((:size .2) (:color green))))

  ;; A place to eat and to sit.
  (obj (table :prototype table*) (30.5 30.5) ((:color violet)))
  (obj (table :prototype table*) (31.5 30.5) ((:color violet)))
  (obj (jug :prototype bottle*) (30.5 30.5) ((:substance stone)))
  (obj (cup :prototype cup*) (31.5 30.5) ((:color red)))
  (obj (chair :prototype chair*) (29.5 30.5) ())
  (obj (chair :prototype chair*) (32.5 30.5) ())
  (obj (bench :prototype sofa*) (24.5 43.5) ((:color blue) (:substance wood)))

  ;; Stores.
  (obj (crate :prototype crate*) (60.5 8.5) ((:color blue))
    ((box :prototype box*) ((:size 6) (:capacity 5) (:color violet) (:substance wood))
      ((tin :prototype tin*) ()
        (whistle ((:size .2) (:weight .05) (:color lightred) (:substance metal))))))
  (obj (crate :prototype crate*) (70.5 8.5) ((:color red)))
  (obj (ball :prototype ball*) (64.5 20.5) ())
  (obj (chest :prototype crate*) (5.5 68.5) ((:color green) (:obsview #t))
    (rope ((:size 3) (:weight 3) (:color lightgreen) (:substance cloth)))
    ((lantern :prototype lamp*) ((:color lightviolet))))
  (obj column (46 24) ((:obsmove #t) (:obsview #t) (:size 10) (:capacity 0) (:weight 90)
                       (:color blue) (:substance 7.5))))

(defrobot porter (hall (20 20) 0)
  :cameras (((/ pi 4) 3) ((/ pi 2) 5))
  :hands (10 4)
  :bins (20 5))

(document-variables
 hall "The map of a great hall in which nothing moves by itself, 75 x 75."
 porter "The robot in HALL, built like ROBBIE.")
