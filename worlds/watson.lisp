;;;; watson.lisp -- a family's house, where ROBBIE lives.

;;; For errands: six rooms off a hallway, furniture to drive round, things in drawers and cupboards
;;; up to three deep. The cat wanders about, the ball rolls, the newspaper blows about, somebody
;;; keeps borrowing the scissors, and Aunt Agatha does her rounds. The parameters of walls differ
;;; from room to room. North is up, y grows downwards. Each character is a square metre: # wall, +
;;; doorway, > ROBBIE at its start.
;;;
;;;   ########################################
;;;   #..###...........#...........#.........#
;;;   #..###...........#...........#.........#
;;;   #................#..kitchen..#.........#
;;;   #................#...........#.........#
;;;   #.........>......+...........#.........#
;;;   #...living.room..#...........#.bedroom.#
;;;   #................#....####...#.........#
;;;   #..........#.....#....####...#.........#
;;;   #..........#.nook#...........#.........#
;;;   #..........#.....#...........#.........#
;;;   #..........#.....#...........#.........#
;;;   ########+##############+##########+#####
;;;   #......................................#
;;;   #......................................#
;;;   #.............hallway..................#
;;;   #......................................#
;;;   ######+#########+########+#########+####
;;;   #...........#.......#..........#.......#
;;;   #...........#.......#..........#.......#
;;;   #...........#.......#..........#.......#
;;;   #...........#.......#..........#.......#
;;;   #...........#.......#..........#.......#
;;;   #...........#.......#.guests...#.store.#
;;;   #...study...#.bath..#..........+.......#
;;;   #...........#.......#..........#.......#
;;;   #...........#.......#..........#.......#
;;;   #...........#.......#..........#.......#
;;;   #...........#.......#..........#.......#
;;;   ########################################

(in-package :ars-worlds)
(in-readtable :nisp)

(defmap watson (40 30)
  (rect (0 0) (40 30) bricks 10 20 30 20)

  ;; Living room (with a chimney and a nook), kitchen (with a counter), bedroom.
  (wall (17 0) (17 4) plaster 32 34)
  (wall (17 6) (17 12) plaster 34 37)
  (wall (29 0) (29 12) plaster 44 50)
  (wall (3 1) (5 1) bricks 24)
  (wall (3 2) (5 2) bricks 25)
  (wall (11 8) (11 12) wood 72 75)
  (wall (22 7) (25 7) stone 41)
  (wall (22 8) (25 8) stone 42)

  ;; The hallway between y = 12 and y = 17.
  (wall (0 12) (7 12) plaster 58)
  (wall (9 12) (22 12) plaster 59)
  (wall (24 12) (33 12) plaster 60)
  (wall (35 12) (39 12) plaster 61)
  (wall (0 17) (5 17) plaster 62)
  (wall (7 17) (15 17) plaster 63)
  (wall (17 17) (24 17) plaster 64)
  (wall (26 17) (34 17) plaster 65)
  (wall (36 17) (39 17) plaster 66)

  ;; Study, bathroom, guest room, storeroom.
  (wall (12 17) (12 29) wood 80 90)
  (wall (20 17) (20 29) stone 38 46)
  (wall (31 17) (31 23) plaster 52)
  (wall (31 25) (31 29) plaster 54)

  ;; The living room.
  (obj (sofa :prototype sofa*) (4.5 9.5) ((:color blue))
    (cushion ((:size 3) (:weight .5) (:color lightred) (:substance cloth)))
    (coin ((:size .1) (:weight .01) (:substance metal))))
  (obj (armchair :prototype sofa*) (2.5 6.5) ((:size 30) (:capacity 3) (:color green)))
  (obj (table :prototype table*) (5.5 6.5) ((:color violet)))
  (obj (cup :prototype cup*) (5.5 6.5) ())
  (obj (newspaper :prototype sheet* :kickers (blow-about)) (5.5 6.5) ((:size .6)))
  (obj (bookcase :prototype shelf*) (15.5 1.5) ()
    ((atlas :prototype book*) ((:size 3) (:weight 2.5) (:color green)))
    ((novel :prototype book*) ((:color red)))
    ((casket :prototype box*) ((:size 3) (:capacity 2) (:weight 1) (:color violet)
                               (:substance wood))
      (ring ((:size .1) (:weight .01) (:color lightviolet) (:substance metal)))))
  (obj (lamp :prototype lamp*) (1.5 10.5) ())
  (obj (plant :prototype plant*) (15.5 10.5) ())
  (obj (toy-chest :prototype box*) (13.5 10.5) ((:size 20) (:capacity 18) (:weight 4)
                                                (:color lightred) (:substance wood))
    (doll ((:size 2) (:weight .6) (:color lightblue) (:substance cloth)))
    ((box :prototype box*) ((:size 4) (:capacity 3) (:weight .5) (:color blue)
                            (:substance paper))
      (marble ((:size .1) (:weight .02) (:color lightgreen) (:substance glass)))))
  (obj (ball :prototype ball* :kickers (roll-away)) (9.5 8.5) ())
  (obj (cat :kickers (wander-about)) (7.5 3.5)
       ((:size 5) (:weight 4.5) (:color lightred) (:substance 105)))

  ;; The kitchen.
  (obj (table :prototype table*) (20.5 9.5) ())
  (obj (plate :prototype sheet*) (20.5 9.5) ((:size 1) (:weight .6) (:substance stone)))
  (obj (teacup :prototype cup*) (20.5 9.5) ((:color lightviolet)))
  (obj (chair :prototype chair*) (19.5 9.5) ())
  (obj (chair :prototype chair*) (21.5 10.5) ())
  (obj (stove :prototype cupboard*) (22.5 1.5) ((:obsview #f) (:color blue) (:substance metal)))
  (obj (kettle :prototype bottle*) (22.5 1.5) ((:size 3) (:capacity 2) (:substance metal)))
  (obj (fridge :prototype cupboard*) (28.5 1.5) ((:color lightviolet) (:substance metal))
    ((bottle :prototype bottle*) ((:color lightblue))
      (milk ((:size 1) (:weight 1) (:color lightviolet))))
    ((butter-dish :prototype tin*) ((:substance glass))
      (butter ((:size .5) (:weight .25) (:color lightgreen)))))
  (obj (cupboard :prototype cupboard*) (18.5 1.5) ()
    ((jar :prototype bottle*) ((:color lightviolet))
      (biscuit ((:size .2) (:weight .02) (:color lightred))))
    ((cup :prototype cup*) ())
    ((mug :prototype cup*) ((:color green))))
  (obj (scissors :kickers (be-borrowed)) (27.5 10.5)
       ((:size .8) (:weight .3) (:color red) (:substance metal)
        (:haunts ((27.5 10.5) (2.5 20.5) (10.5 4.5) (33.5 3.5)))))
  (obj (waste-basket :prototype waste-basket*) (28.5 10.5) ()
    ((wrapper :prototype sheet* :kickers (blow-about)) ((:color red))))

  ;; The bedroom.
  (obj (bed :prototype bed*) (36.5 3.5) ()
    (slipper ((:size 1.5) (:weight .3) (:color red) (:substance cloth)))
    (slipper ((:size 1.5) (:weight .3) (:color red) (:substance cloth))))
  (obj (nightstand :prototype desk*) (38.5 3.5) ((:size 14) (:capacity 8))
    ((drawer :prototype drawer*) ()
      (spectacles ((:size .3) (:weight .05) (:color lightblue) (:substance glass)))
      ((cabinet-key :prototype key*) ((:lock-id 1)))))
  (obj (lamp :prototype lamp*) (38.5 3.5) ((:color lightviolet)))
  (obj (wardrobe :prototype cupboard*) (38.5 9.5) ()
    (coat ((:size 8) (:capacity 3) (:weight 3) (:color violet) (:substance cloth))
      (purse ((:size 1) (:capacity .8) (:weight .2) (:color red) (:substance cloth))
        (coin ((:size .1) (:weight .01) (:substance metal)))))
    (hat ((:size 4) (:weight .4) (:color green) (:substance cloth))))

  ;; The hallway.
  (obj (umbrella-stand :prototype waste-basket*) (1.5 13.5) ((:substance metal))
    (umbrella ((:size 3) (:weight 1) (:color violet) (:substance cloth))))
  (obj (shoe-box :prototype box*) (20.5 13.5) ((:color lightred) (:substance paper))
    (shoe ((:size 2) (:weight .5) (:color blue) (:substance cloth)))
    (shoe ((:size 2) (:weight .5) (:color blue) (:substance cloth))))
  (obj (clock :prototype shelf*) (38.5 15.5) ((:capacity 6) (:color violet))
    (pendulum ((:size 2) (:weight 1.5) (:color lightgreen) (:substance metal))))
  (obj (aunt-agatha :prototype person* :kickers (do-rounds)) (28.5 14.5)
       ((:rounds ((23.5 14.5) (23.5 10.5) (27.5 9.5) (27.5 5.5) (14.5 5.5) (8.5 9.5) (8.5 14.5)
                  (25.5 14.5) (25.5 20.5) (25.5 14.5) (34.5 14.5) (34.5 9.5) (34.5 14.5)))))

  ;; The study.
  (obj (desk :prototype desk*) (2.5 20.5) ()
    ((drawer :prototype drawer*) ()
      (pencil-case ((:size 1) (:capacity .9) (:weight .1) (:color red) (:substance cloth))
        ((pen :prototype pen*) ())
        ((pencil :prototype pen*) ((:color lightgreen) (:substance wood)))))
    ((drawer :prototype drawer*) ()
      ((letter :prototype sheet*) ((:size .2)))
      ((stamp :prototype sheet*) ((:color red)))))
  (obj (lamp :prototype lamp*) (2.5 20.5) ((:color lightgreen)))
  (obj (chair :prototype chair*) (3.5 21.5) ())
  (obj (cabinet :prototype cabinet*) (10.5 27.5) ((:lock-id 1))
    ((money-box :prototype tin*) ()
      ((banknote :prototype sheet*) ((:color lightgreen)))))
  (obj (shelf :prototype shelf*) (6.5 28.5) ()
    ((dictionary :prototype book*) ((:size 3) (:weight 2.5)))
    ((diary :prototype book*) ((:color violet))))
  (obj (waste-basket :prototype waste-basket*) (1.5 22.5) ()
    ((note :prototype sheet*) ()))

  ;; The bathroom.
  (obj (tub :prototype table*) (18.5 27.5) ((:color lightviolet) (:substance stone)))
  (obj (duck :prototype ball*) (18.5 27.5) ((:size .5) (:weight .1) (:color lightgreen)))
  (obj (basin :prototype table*) (13.5 20.5) ((:color lightviolet) (:substance stone)))
  (obj (laundry-basket :prototype waste-basket*) (13.5 27.5) ((:size 12) (:capacity 11))
    (towel ((:size 3) (:weight .8) (:color lightblue) (:substance cloth)))
    (sock ((:size .5) (:weight .1) (:color red) (:substance cloth))))
  (obj (medicine-chest :prototype box*) (19.5 22.5) ((:color lightred) (:substance metal))
    ((bottle :prototype bottle*) ((:size 1) (:capacity .5))
      (pill ((:size .05) (:weight .01) (:color lightred)))))

  ;; The guest room.
  (obj (bed :prototype bed*) (29.5 19.5) ((:color lightgreen)))
  (obj (chair :prototype chair*) (22.5 19.5) ())
  (obj (suitcase :prototype suitcase*) (22.5 27.5) ()
    (sponge-bag ((:size 2) (:capacity 1.5) (:weight .2) (:color green) (:substance cloth))
      (toothbrush ((:size .3) (:weight .03) (:color lightblue) (:substance plastic))))
    ((guidebook :prototype book*) ()))

  ;; The storeroom.
  (obj (crate :prototype crate*) (33.5 27.5) ((:color blue))
    ((box :prototype box*) ((:color green) (:substance wood))
      ((candle :prototype pen*) ((:color lightviolet)))))
  (obj (crate :prototype crate*) (34.5 27.5) ((:color red)))
  (obj (toolbox :prototype toolbox*) (37.5 20.5) ())
  (obj broom (32.5 18.5) ((:size 6) (:weight 1) (:color lightgreen) (:substance wood)))
  (obj (paint-pot :prototype tin*) (38.5 27.5) ((:size 2) (:weight 2) (:color blue))))

;; See reading 10.
(defrobot robbie (watson (10 5) 0)
  :cameras (((/ pi 4) 3) ((/ pi 2) 5))
  :hands (10 4)
  :bins (20 5))

(document-variables
 watson "The map of a family's house, 40 x 30."
 robbie "The robot in WATSON: two cameras, two hands, two bins (manual 5.2).")
