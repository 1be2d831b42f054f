;;;; prototypes.lisp -- prototypes of the things in the shipped worlds.

;;; Use them in any world: (obj (stool :prototype ars-worlds:chair*) (3.5 4.5) ((:color red))).
;;; Sizes, capacities and weights are in the units of the robots' bins and hands. A size up to 5
;;; fits into any bin of a shipped robot, and any hand of ROBBIE lifts a weight up to 4. No
;;; prototype contains more than its capacity. Manual 5.3.

(in-package :ars-worlds)
(in-readtable :nisp)

;;; Furniture. It blocks robots; tall furniture blocks the view, too.

;; See reading 60.
(defvar table* (new-thing table nil
                 ((:obsmove #t) (:size 30) (:weight 20) (:color lightgreen) (:substance wood)))
  "A table. Things in the table's cell lie on the table.")

(defvar desk* (new-thing desk nil
                ((:obsmove #t) (:size 36) (:capacity 24) (:weight 30)
                 (:color lightgreen) (:substance wood)))
  "A desk, with room for drawers.")

(defvar drawer* (new-thing drawer nil
                  ((:size 6) (:capacity 5) (:weight 1) (:color lightgreen) (:substance wood)))
  "A drawer of a desk or chest.")

(defvar shelf* (new-thing shelf nil
                 ((:obsmove #t) (:obsview #t) (:size 50) (:capacity 40) (:weight 40)
                  (:color green) (:substance wood)))
  "Shelves, too high to look over.")

(defvar cupboard* (new-thing cupboard nil
                    ((:obsmove #t) (:obsview #t) (:size 40) (:capacity 32) (:weight 35)
                     (:color lightblue) (:substance wood)))
  "A cupboard, open by default.")

(defvar cabinet* (new-thing cabinet nil
                   ((:obsmove #t) (:obsview #t) (:closed #t) (:locked #t)
                    (:size 30) (:capacity 24) (:weight 50) (:color blue) (:substance metal)))
  "A locked steel cabinet. A key with the same :lock-id unlocks it.")

(defvar bed* (new-thing bed nil
               ((:obsmove #t) (:size 60) (:capacity 12) (:weight 50)
                (:color lightblue) (:substance cloth)))
  "A bed, with room under it.")

(defvar sofa* (new-thing sofa nil
                ((:obsmove #t) (:size 55) (:capacity 8) (:weight 40)
                 (:color violet) (:substance cloth)))
  "A sofa; small things can be inside.")

(defvar chair* (new-thing chair nil
                 ((:size 12) (:weight 4) (:color lightgreen) (:substance wood)))
  "A chair. It does not block robots, and a strong hand can carry it.")

(defvar lamp* (new-thing lamp nil
                ((:type :lamp) (:size 2) (:weight 1) (:color lightred) (:substance metal)))
  "A lamp.")

(defvar plant* (new-thing plant nil
                 ((:size 6) (:weight 3) (:color green) (:substance 70)))
  "A potted plant. Its substance is a number without a name.")

;;; A door for the cell of a doorway. Closed, it is like a wall.

(defvar door* (new-thing door nil
                ((:door #t) (:closed #t) (:size 40) (:weight 30)
                 (:color lightgreen) (:substance wood)))
  "A closed door. A key with the same :lock-id locks and unlocks it.")

;;; Containers that can be carried.

(defvar box* (new-thing box nil ((:size 8) (:capacity 8) (:weight 2)))
  "A box without a particular colour or substance (manual 5.3).")

(defvar crate* (new-thing crate nil
                 ((:obsmove #t) (:size 24) (:capacity 20) (:weight 12)
                  (:color lightgreen) (:substance wood)))
  "A crate, too heavy for ROBBIE.")

(defvar waste-basket* (new-thing waste-basket nil
                        ((:size 7) (:capacity 6) (:weight 1)
                         (:color lightviolet) (:substance plastic)))
  "An open basket for waste.")

(defvar suitcase* (new-thing suitcase nil
                    ((:size 14) (:capacity 12) (:weight 3) (:color red) (:substance cloth)))
  "A suitcase.")

(defvar bottle* (new-thing bottle nil
                  ((:size 1.5) (:capacity 1) (:weight 1) (:color green) (:substance glass)))
  "A bottle.")

(defvar cup* (new-thing cup nil
               ((:size 1) (:capacity .8) (:weight .4) (:color lightblue) (:substance stone)))
  "An earthenware cup.")

(defvar tin* (new-thing tin nil
               ((:size 1) (:capacity .8) (:weight .3) (:color lightred) (:substance metal)))
  "A small tin.")

;;; Small things.

(defvar ball* (new-thing ball nil
                ((:size 1.5) (:weight .5) (:color red) (:substance plastic)))
  "A ball.")

(defvar book* (new-thing book nil
                ((:size 1.2) (:weight 1) (:color blue) (:substance paper)))
  "A book.")

(defvar sheet* (new-thing sheet nil
                 ((:size .1) (:weight .01) (:color lightviolet) (:substance paper)))
  "A sheet of paper.")

(defvar pen* (new-thing pen nil
               ((:size .2) (:weight .02) (:color blue) (:substance plastic)))
  "A pen.")

(defvar key* (new-thing key nil
               ((:type :key) (:size .1) (:weight .05) (:color lightgreen) (:substance metal)))
  "A key. A key fits the things with the same :lock-id.")

(defvar toolbox*
  (let ((toolbox (new-thing toolbox nil
                   ((:size 7) (:capacity 6) (:weight 2) (:color red) (:substance metal)))))
    (new-thing hammer toolbox ((:size 1.5) (:weight 1.5) (:color red) (:substance metal)))
    (new-thing pliers toolbox ((:size .8) (:weight .6) (:color blue) (:substance metal)))
    (new-thing screw (new-thing tin toolbox () :prototype tin*)
               ((:size .1) (:weight .01) (:substance metal)))
    toolbox)
  "A toolbox with tools in it.")

;;; People. They block robots and the view, and are too heavy for any hand.

(defvar person* (new-thing person nil
                  ((:obsmove #t) (:obsview #t) (:size 70) (:weight 70)
                   (:color violet) (:substance cloth)))
  "A person. Kickers make people walk.")
