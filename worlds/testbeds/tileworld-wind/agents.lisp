;;;; agents.lisp -- what agents of NASA Tileworld can do, and agents that carry tiles.

(in-package :ars-testbeds.wind)
(in-readtable :nisp)

;;; What agents can do.

(defun continuing (then)
  "Return a continuation that calls the function THEN, unless the command was interrupted."
  (lambda (err &rest results)
    (declare (ignore results))
    (unless (eq err :interrupt) (funcall then))))

(defun rest-a-step (then)
  "Let the robot wait for a step, then call the function THEN."
  (think carrier 2 (continuing then)))

(defun step-to (place then)
  "Let the robot take a step towards PLACE, a cell (x y), first along x; then call THEN."
  (unless (typep place '(cons real (cons real null)))
    (reject-argument 'step-to 'place place "a cell, a list (x y), such as TILE-TARGET returns"))
  (destructuring-bind (x y) place
    (let ((dx (- x (floor (robot-x carrier)))) (dy (- y (floor (robot-y carrier)))))
      (cond ((plusp dx) (robot-step carrier :east (continuing then)))
            ((minusp dx) (robot-step carrier :west (continuing then)))
            ((plusp dy) (robot-step carrier :south (continuing then)))
            ((minusp dy) (robot-step carrier :north (continuing then)))
            (t (rest-a-step then))))))

(defun grasp-tile (tile then)
  "Let the hand grasp TILE if its first cell is where the robot is; then call THEN."
  (check-tile 'grasp-tile tile)
  (let ((camera (robot-camera carrier 0)))
    (flet ((give-up () (camera-untrack camera (continuing then)))
           (grasp (designator)
             (hand-grasp-desig (robot-hand carrier 0) camera designator
                               (continuing (lambda () (camera-untrack camera (continuing then)))))))
      (camera-get-object-designator
       camera :local `((:tile ,(first tile)) (:handle t))
       (continuation (err camera designator)
         (cond ((eq err :interrupt))
               (err (give-up))
               (t (camera-track camera designator
                                (continuation (err camera designator)
                                  (cond ((eq err :interrupt))
                                        (err (give-up))
                                        (t (grasp designator))))))))))))

(defun put-down (then)
  "Let the hand put down what it holds, if all of the tile fits on the floor here; then call THEN."
  (let ((tile (held-tile)))
    (if (and tile (not (on-floor-p (cells-at (robot-cell) (third tile)))))
        (rest-a-step then)
        (hand-ungrasp (robot-hand carrier 0) (continuing then)))))

;;; Agents with full knowledge carry the tile that takes the fewest steps, to its place and down.

(defun effort (tile)
  (+ (steps-between (robot-cell) (anchor tile)) (steps-between (anchor tile) (tile-target tile))))

(defun next-tile ()
  "Return the tile that is not in its place with the least effort, or NIL."
  (let ((tiles (remove-if #'tile-in-place-p *tiles*)))
    (first (stable-sort tiles #'< :key #'effort))))

(defun carry (then)
  "Carry the tile in the hand, if any, to its place and put it down; then call THEN."
  (let ((tile (held-tile)))
    (cond ((null tile) (funcall then))
          ((equal (robot-cell) (tile-target tile)) (put-down then))
          (t (step-to (tile-target tile) (lambda () (carry then)))))))

(defun fetch (tile place-of then)
  "Go to the place that PLACE-OF returns for TILE, grasp it and carry it away; then call THEN."
  (let ((place (funcall place-of tile)))
    (if (equal place (robot-cell))
        (grasp-tile tile (lambda () (carry then)))
        (step-to place (lambda () (fetch tile place-of then))))))

(defun blind ()
  (let ((tile (next-tile)))
    (if tile
        (fetch tile (constantly (anchor tile)) #'blind)
        (rest-a-step #'blind))))

(defun watchful ()
  (let ((tile (next-tile)))
    (if tile (fetch tile #'anchor #'watchful) (rest-a-step #'watchful))))

(defun flexible ()
  (let ((tile (next-tile)))
    (cond ((null tile) (rest-a-step #'flexible))
          ((equal (anchor tile) (robot-cell))
           (grasp-tile tile (lambda () (carry #'flexible))))
          (t (step-to (anchor tile) #'flexible)))))

(defun idle ())

(defun random-walk ()
  "Step in a random direction, or grasp or put down a tile, again and again."
  (let ((dice (make-dice (+ (world-seed *world*) (simulation-tick)) "walk"))
        (here (find (robot-cell) *tiles* :key #'anchor :test #'equal)))
    (cond ((or (null here) (plusp (roll-index 4 dice)))
           (step-to (roll-element (remove-if-not (lambda (cell) (on-floor-p (list cell)))
                                                 (cells-at (robot-cell)
                                                           '((1 0) (-1 0) (0 1) (0 -1))))
                                  dice)
                    #'random-walk))
          ((held-tile) (put-down #'random-walk))
          (t (grasp-tile here #'random-walk)))))

;;; Looking ahead. The agent tries each tile in a fork of the run: it carries this tile first, then
;;; goes on as FLEXIBLE. In the forks of a fair agent no wind blows, so it does not learn of gusts.
;;; Forks are made between ticks, so the agent passes them.

(defun time-in-place-ahead (id steps wind)
  "Return for how many ticks tiles are in place in STEPS steps if tile ID is carried first. If WIND
is true, the gusts are those that will blow; else there are none."
  (with-fork ()
    (unless wind (put-kicker gust (thing (find-thing 'clock))))
    (let ((before *in-place*))
      (fetch (find-tile id) #'anchor #'flexible)
      (run-ticks (* 2 steps))
      (- *in-place* before))))

(defun best-ahead (steps wind)
  "Return the tile to carry first, or NIL if all are in place."
  (let ((tiles (sort (remove-if #'tile-in-place-p *tiles*) #'< :key #'effort)))
    (if (rest tiles)
        (let ((times (mapcar (lambda (tile) (time-in-place-ahead (first tile) steps wind)) tiles)))
          (nth (position (reduce #'max times) times) tiles))
        (first tiles))))

(defun go-after (tile blown then)
  "Fetch TILE and carry it to its place. Call THEN at the end, or when the wind has moved tiles by
more than BLOWN cells."
  (cond ((< blown *blown*) (funcall then))
        ((equal (anchor tile) (robot-cell)) (grasp-tile tile (lambda () (carry then))))
        (t (step-to (anchor tile) (lambda () (go-after tile blown then))))))

(defun look-ahead (&key (steps 80) wind)
  "Play to the end of the game."
  (let ((ready t))
    (flet ((decide () (setf ready t)))
      (loop until (game-over-p)
            do (if ready
                   (let ((tile (best-ahead steps wind)))
                     (setf ready nil)
                     (if tile (go-after tile *blown* #'decide) (rest-a-step #'decide)))
                   (run-ticks 1))))))

(defun clairvoyant () (look-ahead :wind t))

;;; Agents with a camera. They know the places of tiles, but not where tiles are: this they see. A
;;; look takes some ticks, one more for each tile that it finds. A sighting is a list (tile place).

(defun look-for-tiles (type then)
  "Look for tiles, :LOCAL or :NON-LOCAL, and call THEN with a list of sightings."
  (camera-get-all-object-designators
   (robot-camera carrier 0) type '((:tile (0 7)) (:handle t))
   (continuation (err camera designators)
     (unless (eq err :interrupt) (funcall then (mapcar #'sighting designators))))))

(defun sighting (designator)
  (let ((angle (+ (robot-angle carrier) (designator-angle designator)))
        (distance (designator-distance designator)))
    (list (find-tile (second (assoc :tile (designator-data designator))))
          (list (floor (+ (robot-x carrier) (* distance (cosine angle))))
                (floor (+ (robot-y carrier) (* distance (sine angle))))))))

(defun look-round (then)
  "Call THEN with a list of sightings of all tiles."
  (look-for-tiles :non-local
                  (lambda (far)
                    (look-for-tiles :local (lambda (near) (funcall then (append near far)))))))

(defun effort-by-sight (sighting)
  (destructuring-bind (tile place) sighting
    (+ (steps-between (robot-cell) place) (steps-between place (tile-target tile)))))

(defun choose-by-sight (boldness)
  "Look, choose the tile with the least effort, go there for BOLDNESS steps, and so on."
  (flet ((again () (choose-by-sight boldness))
         (in-place-p (sighting) (equal (second sighting) (tile-target (first sighting)))))
    (look-round (lambda (sightings)
                  (let ((best (sort (remove-if #'in-place-p sightings) #'<
                                    :key #'effort-by-sight)))
                    (if best
                        (go-by-sight (first best) boldness #'again)
                        (rest-a-step #'again)))))))

(defun go-by-sight (sighting left then)
  "Go to where SIGHTING is of, for LEFT steps if that is a number. There, grasp the tile and carry
it to its place. Then call THEN."
  (destructuring-bind (tile place) sighting
    (cond ((equal place (robot-cell)) (grasp-tile tile (lambda () (carry then))))
          ((eql 0 left) (funcall then))
          (t (step-to place (lambda () (go-by-sight sighting (and left (1- left)) then)))))))

(defun blind-camera () (choose-by-sight nil))
(defun flexible-camera () (choose-by-sight 4))
