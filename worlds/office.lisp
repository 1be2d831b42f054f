;;;; office.lisp -- a floor of an institute, large and busy, with two robots.

;;; For long errands. Sixteen rooms lie off a corridor 118 metres long. There are locked cabinets
;;; whose keys lie elsewhere, letters that travel on a trolley, a printer that keeps printing, and
;;; people who walk about and block the way. MARVIN is well equipped; GOFER is a simple messenger.
;;; North is up, y grows downwards. Each character is 2 x 2 metres: # contains a wall, + a doorway,
;;; > MARVIN and ^ GOFER at their starts.
;;;
;;;   ############################################################
;;;   #.........#...........#.......#...........#.........#......#
;;;   #.........#...........#.......#...........#.........#......#
;;;   #.........#...#...#...#.......#...........#.........#strong#
;;;   #.supply..#...#...#...#calls..#...........#.........#......#
;;;   #.........#...#...#...#.......#...........#.........#.room.#
;;;   #.........#...#...#...#.......#...........#.........#......#
;;;   #.........#...........#.......#..library..#.lab.....#......#
;;;   #####+#####....desks..####+####...........#.........###+####
;;;   #.........#...........#.......#...........#.........#......#
;;;   #.........#...#...#...#.......#...........#.........#......#
;;;   #.........#...#...#...#.......#...........#.........#......#
;;;   #......^..+...#...#...#meeting#...........+.........#......#
;;;   #.........#...#...#...+.......#...........#.........#direc-#
;;;   #..mail...#...#...#...#.......#...........#.........#tor...#
;;;   #.........#...........#.......#...........#.........#......#
;;;   #.........#...........#.......#...........#.........#......#
;;;   #####+##########+#########+#########+##########+#######+####
;;;   #...............................corridor...................#
;;;   #...........#.........#........>........#.........#........#
;;;   #..........................................................#
;;;   ######+############+#########.....#########+##########+#####
;;;   #............#...........#...........#...........#.........#
;;;   #............#...........#...........#...........#.........#
;;;   #............#...........#...........#...........#.........#
;;;   #............#...........#.....###...#...........#.archive.#
;;;   #..canteen...#...........#.....###...#...........#.........#
;;;   #............#...........#.....##....#...........#.........#
;;;   #............#..workshop.#...........#..lectures.#.........#
;;;   #............#...........#.lobby.....#...........#.........#
;;;   #............+...........#...........#...........#####+#####
;;;   #...######...#...........#...........#...........#.........#
;;;   #............#...........#...........#...........#.........#
;;;   #............#...........##..........#...........#.........#
;;;   #............#...........###.........#...........#..store..#
;;;   #............#...........#.##........#...........+.........#
;;;   #............#...........#lo+#.......#...........#.........#
;;;   #............#...........#dge##......#...........#.........#
;;;   #............#...........#....##.....#...........#.........#
;;;   ############################################################

(in-package :ars-worlds)
(in-readtable :nisp)

(defmap office (120 80)
  (rect (0 0) (120 80) bricks 5 20 40 25)

  ;; The corridor between y = 34 and y = 42, with pillars; the lobby lies open to it.
  (wall (0 34) (9 34) plaster 60)
  (wall (11 34) (31 34) plaster 62)
  (wall (33 34) (51 34) plaster 64)
  (wall (53 34) (71 34) plaster 66)
  (wall (73 34) (93 34) plaster 68)
  (wall (95 34) (110 34) plaster 70)
  (wall (112 34) (119 34) plaster 72)
  (wall (0 42) (12 42) plaster 61)
  (wall (14 42) (37 42) plaster 63)
  (wall (39 42) (56 42) plaster 65)
  (wall (68 42) (85 42) plaster 67)
  (wall (87 42) (107 42) plaster 69)
  (wall (109 42) (119 42) plaster 71)
  (rect (24 38) (25 39) stone 44)
  (rect (44 38) (45 39) stone 45)
  (rect (80 38) (81 39) stone 46)
  (rect (100 38) (101 39) stone 47)

  ;; North: supplies and mail, the open-plan office, two meeting rooms, library, laboratory,
  ;; director's room and strongroom.
  (wall (20 0) (20 24) plaster 50)
  (wall (20 26) (20 34) plaster 51)
  (wall (0 16) (9 16) plaster 48)
  (wall (11 16) (20 16) plaster 49)
  (wall (44 0) (44 25) glass 6)
  (wall (44 27) (44 34) glass 7)
  (wall (60 0) (60 34) plaster 54)
  (wall (44 16) (51 16) glass 8)
  (wall (53 16) (60 16) glass 9)
  (wall (84 0) (84 23) wood 84)
  (wall (84 25) (84 34) wood 86)
  (wall (104 0) (104 34) plaster 56)
  (wall (104 16) (110 16) metal 76)
  (wall (112 16) (119 16) metal 78)
  (wall (28 6) (28 13) cloth 98)
  (wall (36 6) (36 13) cloth 100)
  (wall (28 20) (28 28) cloth 102)
  (wall (36 20) (36 28) cloth 104)

  ;; South: canteen, workshop, lobby with the porter's lodge, lecture room, archive, storeroom.
  (wall (26 42) (26 59) plaster 52)
  (wall (26 61) (26 79) plaster 53)
  (wall (50 42) (50 79) bricks 22)
  (wall (51 66) (56 71) wood 88)
  (wall (58 73) (63 78) wood 90)
  (wall (74 42) (74 79) bricks 24)
  (wall (98 42) (98 69) plaster 57)
  (wall (98 71) (98 79) plaster 58)
  (wall (98 60) (107 60) metal 74)
  (wall (109 60) (119 60) metal 75)
  (wall (8 62) (18 62) stone 42)
  (wall (8 63) (18 63) stone 43)
  (circle (64 52) 2 stone 36)
  (rect (63 51) (65 53) stone 36)
  (wall (64 52) (64 52) stone 36)

  ;; The corridor.
  (obj (mail-trolley :prototype crate* :kickers (do-rounds)) (10.5 36.5)
       ((:size 30) (:capacity 26) (:weight 25) (:color lightred) (:substance metal)
        (:rounds ((32.5 36.5) (52.5 36.5) (94.5 36.5) (94.5 32.5) (94.5 36.5) (111.5 36.5)
                  (111.5 32.5) (111.5 36.5) (10.5 36.5) (10.5 32.5) (10.5 36.5))))
    ((letter :prototype sheet*) ((:size .2)))
    ((parcel :prototype box*) ((:size 4) (:capacity 3) (:weight 1) (:color green)
                               (:substance paper))
      ((book :prototype book*) ((:color red)))))
  (obj (caretaker :prototype person* :kickers (do-rounds)) (60.5 40.5)
       ((:rounds ((86.5 40.5) (86.5 46.5) (86.5 40.5) (108.5 40.5) (108.5 63.5) (108.5 40.5)
                  (38.5 40.5) (38.5 46.5) (38.5 40.5) (13.5 40.5) (13.5 46.5) (13.5 40.5)))))
  (obj (plant :prototype plant*) (1.5 38.5) ())
  (obj (plant :prototype plant*) (118.5 38.5) ((:size 9) (:weight 8)))
  (obj (extinguisher :prototype bottle*) (58.5 35.5)
       ((:size 4) (:capacity 0) (:weight 5) (:color red) (:substance metal)))
  (obj (waste-basket :prototype waste-basket*) (71.5 41.5) ()
    ((leaflet :prototype sheet* :kickers (blow-about)) ((:color lightblue))))

  ;; The mail room and the supplies behind it.
  (obj (table :prototype table*) (3.5 20.5) ())
  (obj (scales :prototype tin*) (3.5 20.5) ((:size 2) (:weight 2) (:color blue)))
  (obj (pigeon-holes :prototype shelf*) (1.5 26.5) ()
    ((letter :prototype sheet*) ((:size .2) (:color lightred)))
    ((letter :prototype sheet*) ((:size .2) (:color lightblue)))
    ((envelope :prototype sheet*) ((:size .3) (:capacity .2))
      ((cheque :prototype sheet*) ((:color lightgreen)))))
  (obj (printer :kickers (print-page)) (18.5 30.5)
       ((:obsmove #t) (:size 20) (:capacity 2) (:weight 30) (:color lightviolet)
        (:substance plastic)))
  (obj (supply-shelf :prototype shelf*) (4.5 2.5) ()
    ((box :prototype box*) ((:color red) (:substance paper))
      ((pen :prototype pen*) ())
      ((pen :prototype pen*) ((:color red)))
      ((tin :prototype tin*) ()
        (paper-clip ((:size .05) (:weight .01) (:substance metal)))))
    ((box :prototype box*) ((:color blue) (:substance paper))
      ((ream :prototype book*) ((:size 2) (:weight 2.5) (:color lightviolet)))))
  (obj (supply-cabinet :prototype cabinet*) (18.5 2.5) ((:lock-id 11))
    ((toner :prototype tin*) ((:size 2) (:weight 1.5) (:color violet)))
    ((lamp :prototype lamp*) ()))

  ;; The open-plan office: four cubicles.
  (obj (desk :prototype desk*) (23.5 8.5) ()
    ((drawer :prototype drawer*) ()
      ((pen :prototype pen*) ())
      ((supply-key :prototype key*) ((:lock-id 11)))))
  (obj (cup :prototype cup* :kickers (be-borrowed)) (23.5 8.5)
       ((:haunts ((23.5 8.5) (32.5 8.5) (40.5 24.5) (4.5 50.5) (88.5 10.5)))))
  (obj (desk :prototype desk*) (32.5 8.5) ((:color blue))
    ((drawer :prototype drawer*) ((:color blue))
      (stapler ((:size .8) (:weight .4) (:color red) (:substance metal))))
    ((drawer :prototype drawer*) ((:color blue))
      ((memo :prototype sheet*) ())))
  (obj (lamp :prototype lamp*) (32.5 8.5) ((:color lightgreen)))
  (obj (desk :prototype desk*) (40.5 24.5) ()
    ((drawer :prototype drawer*) ()
      ((lunch-box :prototype box*) ((:size 3) (:capacity 2.5) (:weight .3) (:color violet))
        (apple ((:size 1) (:weight .2) (:color lightgreen))))))
  (obj (desk :prototype desk*) (23.5 24.5) ((:color red)))
  (obj (report :prototype sheet* :kickers (blow-about)) (23.5 24.5) ((:size .5) (:weight .2)))
  (obj (chair :prototype chair*) (24.5 9.5) ())
  (obj (chair :prototype chair*) (33.5 9.5) ())
  (obj (chair :prototype chair*) (39.5 25.5) ((:color blue)))
  (obj (chair :prototype chair*) (24.5 25.5) ())
  (obj (waste-basket :prototype waste-basket*) (38.5 8.5) ()
    ((draft :prototype sheet* :kickers (blow-about)) ()))
  (obj (clerk :prototype person* :kickers (wander-about)) (32.5 17.5) ((:color lightblue)))
  (obj (ball :prototype ball* :kickers (roll-away)) (30.5 31.5) ())

  ;; The meeting rooms.
  (obj (table :prototype table*) (51.5 24.5) ((:color violet)))
  (obj (table :prototype table*) (52.5 24.5) ((:color violet)))
  (obj (pointer :prototype pen* :kickers (be-borrowed)) (52.5 24.5)
       ((:size 1) (:color lightred)
        (:haunts ((52.5 24.5) (86.5 74.5) (76.5 45.5)))))
  (obj (chair :prototype chair*) (50.5 24.5) ())
  (obj (chair :prototype chair*) (53.5 24.5) ())
  (obj (flip-chart :prototype shelf*) (58.5 18.5) ((:capacity 2) (:weight 9))
    ((marker :prototype pen*) ((:color red))))
  (obj (table :prototype table*) (48.5 6.5) ())
  (obj (telephone :prototype tin*) (48.5 6.5) ((:color violet) (:substance plastic)))
  (obj (sofa :prototype sofa*) (56.5 2.5) ()
    (coin ((:size .1) (:weight .01) (:substance metal))))

  ;; The library: shelves in two rows.
  (obj (shelf :prototype shelf*) (66.5 8.5) ()
    ((dictionary :prototype book*) ((:size 3) (:weight 2.5)))
    ((bible :prototype book*) ((:size 2.5) (:weight 2) (:color violet))))
  (obj (shelf :prototype shelf*) (67.5 8.5) ()
    ((atlas :prototype book*) ((:size 4) (:capacity .5) (:weight 3) (:color green))
      ((world-map :prototype sheet*) ((:size .3)))))
  (obj (shelf :prototype shelf*) (68.5 8.5) ()
    ((proceedings :prototype book*) ((:color red)))
    ((thesis :prototype book*) ((:color lightgreen))))
  (obj (shelf :prototype shelf*) (74.5 8.5) ()
    ((manual :prototype book*) ((:capacity .2) (:color lightblue))
      ((errata :prototype sheet*) ((:color red)))))
  (obj (shelf :prototype shelf*) (75.5 8.5) ()
    ((journal :prototype book*) ()) ((journal :prototype book*) ()))
  (obj (shelf :prototype shelf*) (76.5 8.5) ()
    ((novel :prototype book*) ((:color red))))
  (obj (table :prototype table*) (71.5 20.5) ())
  (obj (lamp :prototype lamp*) (71.5 20.5) ((:color lightgreen)))
  (obj (magazine :prototype book* :kickers (be-borrowed)) (71.5 20.5)
       ((:size .6) (:weight .3) (:color lightred)
        (:haunts ((71.5 20.5) (52.5 24.5) (4.5 50.5) (114.5 26.5)))))
  (obj (armchair :prototype sofa*) (62.5 30.5) ((:size 30) (:capacity 3) (:color green)))
  (obj (reader :prototype person* :kickers (wander-about)) (78.5 28.5) ((:color lightgreen)))

  ;; The laboratory.
  (obj (bench :prototype table*) (88.5 10.5) ((:substance stone)))
  (obj (flask :prototype bottle*) (88.5 10.5) ()
    (acid ((:size .8) (:weight 1) (:color lightgreen))))
  (obj (bench :prototype table*) (89.5 10.5) ((:substance stone)))
  (obj (beaker :prototype cup*) (89.5 10.5) ((:color lightviolet) (:substance glass)))
  (obj (signal-lamp :prototype lamp* :kickers (change-light)) (94.5 2.5) ())
  (obj (incubator :prototype cupboard*) (102.5 4.5) ((:color lightred) (:substance metal))
    ((rack :prototype box*) ((:size 4) (:capacity 3) (:weight .8) (:color green)
                             (:substance plastic))
      ((sample :prototype bottle*) ((:size .3) (:capacity .2) (:weight .1))
        (specimen ((:size .1) (:weight .01) (:color red))))
      ((sample :prototype bottle*) ((:size .3) (:capacity .2) (:weight .1) (:color blue)))))
  (obj (glove-box :prototype box*) (100.5 30.5) ((:color lightgreen) (:substance plastic))
    (glove ((:size .5) (:weight .1) (:color lightblue) (:substance plastic))))

  ;; The director's room, and the strongroom behind it.
  (obj (desk :prototype desk*) (114.5 26.5) ((:color violet))
    ((drawer :prototype drawer*) ((:color violet))
      ((key-box :prototype tin*) ()
        ((safe-key :prototype key*) ((:lock-id 7)))))
    ((drawer :prototype drawer*) ((:color violet))
      ((contract :prototype sheet*) ((:size .2)))))
  (obj (lamp :prototype lamp*) (114.5 26.5) ())
  (obj (chair :prototype chair*) (115.5 26.5) ((:color violet) (:substance cloth)))
  (obj (globe :prototype ball*) (106.5 18.5) ((:size 6) (:weight 5) (:color blue)))
  (obj (director :prototype person* :kickers (wander-about)) (108.5 24.5) ((:color red)))
  (obj (safe :prototype cabinet*) (117.5 2.5) ((:lock-id 7) (:color violet))
    ((cash-box :prototype box*) ((:size 4) (:capacity 3) (:weight 2) (:color red)
                                 (:substance metal))
      ((banknote :prototype sheet*) ((:color lightgreen))))
    (medal ((:size .2) (:weight .1) (:color lightviolet) (:substance metal))))

  ;; The canteen, with its counter.
  (obj (table :prototype table*) (4.5 50.5) ())
  (obj (table :prototype table*) (10.5 50.5) ())
  (obj (table :prototype table*) (16.5 50.5) ())
  (obj (salt :prototype tin*) (10.5 50.5) ((:substance glass)))
  (obj (chair :prototype chair*) (5.5 51.5) ())
  (obj (chair :prototype chair*) (11.5 51.5) ())
  (obj (refrigerator :prototype cupboard*) (2.5 76.5) ((:color lightviolet) (:substance metal))
    ((bottle :prototype bottle*) ((:color lightblue)))
    ((cake-tin :prototype tin*) ((:size 3) (:capacity 2.5))
      (cake ((:size 1) (:weight .5) (:color lightred)))))
  (obj (dresser :prototype cupboard*) (22.5 76.5) ()
    ((cup :prototype cup*) ()) ((cup :prototype cup*) ((:color green)))
    ((tray :prototype sheet*) ((:size 2) (:weight .6) (:substance plastic))))
  (obj (waste-basket :prototype waste-basket*) (24.5 44.5) ((:size 12) (:capacity 11))
    ((napkin :prototype sheet* :kickers (blow-about)) ()))

  ;; The workshop.
  (obj (bench :prototype table*) (30.5 74.5) ())
  (obj (toolbox :prototype toolbox*) (30.5 74.5) ())
  (obj (vice :prototype tin*) (31.5 74.5) ((:size 3) (:weight 8) (:color blue)))
  (obj (crate :prototype crate*) (46.5 48.5) ((:color blue))
    ((box :prototype box*) ((:color lightred) (:substance paper))
      ((motor :prototype tin*) ((:size 2) (:weight 1.5) (:color green)))))
  (obj (crate :prototype crate*) (46.5 49.5) ((:color red))
    ((wheel :prototype ball*) ((:size 3) (:weight 1) (:color blue))))
  (obj (broom :kickers (be-borrowed)) (28.5 44.5)
       ((:size 6) (:weight 1) (:color lightgreen) (:substance wood)
        (:haunts ((28.5 44.5) (2.5 40.5) (76.5 40.5) (100.5 76.5)))))

  ;; The lobby, and the porter's lodge cut off its corner.
  (obj (sofa :prototype sofa*) (72.5 60.5) ())
  (obj (sofa :prototype sofa*) (72.5 62.5) ((:color blue)))
  (obj (newspaper :prototype sheet* :kickers (blow-about)) (70.5 61.5) ((:size .6)))
  (obj (plant :prototype plant*) (52.5 44.5) ())
  (obj (visitor :prototype person* :kickers (wander-about)) (60.5 60.5) ((:color lightred)))
  (obj (key-cupboard :prototype cupboard*) (52.5 77.5) ((:size 10) (:capacity 6))
    ((archive-key :prototype key*) ((:lock-id 3)))
    ((desk-key :prototype key*) ((:lock-id 5))))
  (obj (bell :prototype tin*) (53.5 70.5) ((:capacity 0)))

  ;; The lecture room.
  (obj (lectern :prototype desk*) (86.5 74.5) ((:size 10) (:capacity 4))
    ((notes :prototype sheet*) ((:size .5))))
  (obj (projector :prototype box*) (86.5 50.5) ((:capacity 2) (:weight 5) (:color violet)
                                                 (:substance metal))
    (slide ((:size .05) (:weight .01) (:color lightblue) (:substance glass))))
  (obj (chair :prototype chair*) (80.5 60.5) ())
  (obj (chair :prototype chair*) (83.5 60.5) ())
  (obj (chair :prototype chair*) (90.5 60.5) ())
  (obj (chair :prototype chair*) (93.5 60.5) ())

  ;; Archive and storeroom.
  (obj (archive-cabinet :prototype cabinet*) (102.5 46.5) ((:lock-id 3))
    ((file :prototype box*) ((:size 3) (:capacity 2) (:weight 1) (:color lightblue)
                             (:substance paper))
      ((deed :prototype sheet*) ((:size .2)))))
  (obj (shelf :prototype shelf*) (112.5 46.5) ()
    ((ledger :prototype book*) ((:size 2) (:weight 2) (:color green))))
  (obj (desk :prototype desk*) (116.5 56.5) ((:closed #t) (:locked #t) (:lock-id 5))
    ((drawer :prototype drawer*) ()
      ((will :prototype sheet*) ((:size .2)))))
  (obj (crate :prototype crate*) (102.5 74.5) ())
  (obj (crate :prototype crate*) (103.5 74.5) ((:color red))
    ((suitcase :prototype suitcase*) ()
      ((casket :prototype box*) ((:size 3) (:capacity 2) (:weight 1) (:color violet)
                                 (:substance wood))
        (brooch ((:size .1) (:weight .02) (:color lightgreen) (:substance metal))))))
  (obj (ladder :prototype shelf*) (117.5 66.5) ((:obsview #f) (:capacity 0) (:weight 9)))
  (obj (bucket :prototype waste-basket*) (106.5 68.5) ((:color blue))))

(defrobot marvin (office (62 38) 0)
  :cameras (((/ pi 4) 5) ((/ pi 2) 9) ((/ pi 6) 3))
  :hands (10 5)
  :bins (20 8))

(defrobot gofer (office (15 24) (- (/ pi 2)))
  :cameras (((/ pi 2) 7))
  :hands (3)
  :bins (10))

(document-variables
 office "The map of a busy floor of an institute, 120 x 80."
 marvin "The well-equipped robot in OFFICE, in its corridor."
 gofer "The messenger robot in OFFICE, in its mail room.")
