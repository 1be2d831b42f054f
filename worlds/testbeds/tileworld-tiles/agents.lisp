;;;; agents.lisp -- how to push tiles into holes, and agents that do.

(in-package :ars-testbeds.tiles)
(in-readtable :nisp)

;;; Planning pushes: a breadth-first search over the cells of the agent and of one tile. A cell is
;;; 16 y + x; a state is 256 times the agent's cell plus the tile's. Other tiles are in the way of
;;; both, other holes in the way of the tile. MOVES records how each state was reached: the index
;;; of a direction, plus 1, plus 4 for a push.

(defparameter *directions* '((:north . -16) (:south . 16) (:east . 1) (:west . -1)))

(defun cell-code (thing) (+ (* 16 (floor (thing-y thing))) (floor (thing-x thing))))

(defun mark-cells (cells bits)
  "Set the BITS of CELLS to 1; return BITS."
  (dolist (cell cells bits) (setf (sbit bits cell) 1)))

(defun solid-bits (cells)
  "Return a bit for each cell: 1 for a wall and for CELLS."
  (let ((bits (make-array 272 :element-type 'bit :initial-element 1)))
    (loop for y from 1 to 15
          do (fill bits 0 :start (+ (* 16 y) 1) :end (+ (* 16 y) 16)))
    (mark-cells cells bits)))

(defun pit-bits (cells)
  "Return a bit for each cell: 1 for CELLS."
  (mark-cells cells (make-array 272 :element-type 'bit :initial-element 0)))

(defun search-pushes (agent tile goals solid pits)
  "Search from the cells AGENT and TILE until the tile is in one of GOALS. Return the last state and
how each state was reached, or NIL."
  (declare (type (integer 0 271) agent tile) (type (simple-array bit (272)) solid pits))
  (let* ((moves (make-array 65536 :element-type '(unsigned-byte 8) :initial-element 0))
         (first (+ (* 256 agent) tile)) (fresh (list first)) (queue fresh))
    (declare (type (unsigned-byte 16) first))
    (setf (aref moves first) 255)
    (loop for state of-type (unsigned-byte 16) = (pop queue)
          do (loop for (nil . step) of-type (t . fixnum) in *directions*
                   for move of-type fixnum from 1
                   for to of-type (integer 0 271) = (+ (ash state -8) step)
                   for at of-type (integer 0 271) = (logand state 255)
                   for push = (= to at)
                   for on of-type (integer -16 288) = (if push (+ at step) at)
                   do (when (and (zerop (sbit solid to))
                                 (or (not push)
                                     (and (zerop (sbit solid on)) (zerop (sbit pits on)))))
                        (let ((next (+ (* 256 to) on)))
                          (when (zerop (aref moves next))
                            (setf (aref moves next) (if push (+ move 4) move)
                                  (rest fresh) (list next)
                                  fresh (rest fresh))
                            (unless queue (setf queue fresh))
                            (when (and push (member on goals))
                              (return-from search-pushes (values next moves)))))))
          while queue)))

(defun agent-cell () (+ (* 16 (floor (robot-y pusher))) (floor (robot-x pusher))))

(defun plan-way (tile goals solid pits)
  "Return the shortest list of directions in which the agent must go to push what is in the cell
TILE into one of the cells GOALS, or NIL if there is none."
  (multiple-value-bind (state moves) (search-pushes (agent-cell) tile goals solid pits)
    (when state
      (loop for move = (aref moves state)
            until (= 255 move)
            for (direction . step) = (nth (mod (1- move) 4) *directions*)
            collect direction into way
            do (decf state (+ (* 256 step) (if (< 4 move) step 0)))
            finally (return (nreverse way))))))

(defun plan-push (tile hole)
  "Return the shortest list of directions in which the agent must go to push TILE into a cell of
HOLE, or NIL if there is none."
  (unless (thing-p tile)
    (reject-argument 'plan-push 'tile tile "a tile, a thing, as TILES returns them"))
  (check-hole 'plan-push hole)
  (plan-way (cell-code tile)
            (mapcar #'cell-code (hole-cells hole))
            (solid-bits (mapcar #'cell-code (remove tile (append *tiles* *obstacles*))))
            (pit-bits (loop for other in *holes*
                            unless (= (hole-id other) (hole-id hole))
                              append (mapcar #'cell-code (hole-cells other))))))

;;; Choosing.

(defun cells-between (x y thing)
  (+ (abs (round (- (thing-x thing) x))) (abs (round (- (thing-y thing) y)))))

(defun hole-distance (hole thing)
  "Return how many cells THING is from the nearest cell of HOLE."
  (loop for cell in (hole-cells hole)
        minimize (cells-between (thing-x thing) (thing-y thing) cell)))

(defun agent-distance (hole)
  (loop for cell in (hole-cells hole)
        minimize (cells-between (robot-x pusher) (robot-y pusher) cell)))

(defun nearest-tiles (hole count)
  "Return the COUNT tiles nearest to HOLE, or all if they are fewer."
  (let ((tiles (stable-sort (copy-list *tiles*) #'< :key (lambda (tile)
                                                           (hole-distance hole tile)))))
    (subseq tiles 0 (min count (length tiles)))))

(defun utility (hole)
  "Return the likely value of HOLE, as published: its score, by the distance of the agent from it
plus twice the distances from it of the tiles that it needs; 0 if there are not enough tiles."
  (check-hole 'utility hole)
  (let* ((count (length (hole-cells hole))) (tiles (nearest-tiles hole count)))
    (if (< (length tiles) count)
        0
        (/ (hole-worth hole)
           (+ (agent-distance hole)
              (* 2 (loop for tile in tiles sum (hole-distance hole tile))))))))

(defun way-to-fill (hole)
  "Return the shortest way to push one of the three tiles nearest to HOLE into it, a list of
directions, and then the tile; NIL if there is none."
  (check-hole 'way-to-fill hole)
  (let ((best nil) (best-tile nil))
    (dolist (tile (nearest-tiles hole 3))
      (let ((way (plan-push tile hole)))
        (when (and way (or (null best) (< (length way) (length best))))
          (setf best way best-tile tile))))
    (values best best-tile)))

;;; Acting. CHOICE is a list (value threshold decide): a function of holes that the agent maximizes,
;;; by how much a new hole must score more than its own to be considered, or NIL for never, and a
;;; function to call with the holes to consider.

(defun choice (value threshold)
  (let ((choice (list value threshold nil)))
    (setf (third choice) (lambda (holes) (deliberate holes choice)))
    choice))

(defun think-of (holes then)
  "Pay for thinking about HOLES, then call the function THEN."
  (spend-steps (* deliberation-time* (length holes)) then))

(defun best-first (holes value)
  "Return those of HOLES that are still open, as they are now, the highest VALUE first."
  (let ((open (remove nil (mapcar (lambda (hole) (find-hole (hole-id hole))) holes))))
    (mapcar #'rest (stable-sort (mapcar (lambda (hole) (cons (funcall value hole) hole)) open)
                                #'> :key #'first))))

(defun deliberate (holes choice)
  "Think about HOLES, and work on the best that can be filled."
  (think-of holes (lambda ()
                    (let ((best (find-if #'way-to-fill (best-first holes (first choice)))))
                      (if best
                          (work (hole-id best) choice)
                          (spend-steps 1 (lambda () (start-over choice))))))))

(defun newest () (if *holes* (hole-id (first *holes*)) 0))

(defun start-over (choice) (funcall (third choice) *holes*))

(defun work (id choice)
  "Push a tile into the hole ID, if it is open; then the next."
  (let ((hole (find-hole id)))
    (multiple-value-bind (way tile) (and hole (way-to-fill hole))
      (if way
          (follow way tile id choice (newest))
          (start-over choice)))))

(defun worth-a-thought (id seen threshold)
  "Return the holes newer than SEEN that pass the filter of an agent that works on the hole ID."
  (and threshold
       (loop for hole in *holes*
             while (< seen (hole-id hole))
             when (<= threshold (- (hole-worth hole) (hole-worth (find-hole id))))
               collect hole)))

(defun follow (way tile id choice seen)
  "Go the WAY on which TILE gets into the hole ID, unless something new is to be considered."
  (if (or (null way) (not (find-hole id)) (not (thing-alive-p tile)))
      (work id choice)
      (let ((new (worth-a-thought id seen (second choice))) (newest (newest)))
        (if new
            (funcall (third choice) (cons (find-hole id) new))
            (push-to (first way)
                     (lambda (err)
                       (if err
                           (work id choice)
                           (follow (rest way) tile id choice (max seen newest)))))))))

(defun nearness (hole) (- (agent-distance hole)))

(defun naive () (start-over (choice #'nearness nil)))
(defun by-score () (start-over (choice #'hole-worth -1000)))
(defun by-utility () (start-over (choice #'utility -1000)))
(defun filtered () (start-over (choice #'utility 0)))
(defun bold () (start-over (choice #'utility 100)))

(defun random-walk ()
  "Push in a random direction, again and again."
  (let ((dice (make-dice (world-seed *world*) (format nil "walk at ~D" (simulation-tick)))))
    (push-to (first (roll-element *directions* dice))
             (lambda (err) (declare (ignore err)) (random-walk)))))

;;; Looking ahead. The agent tries holes in forks of the run in which nothing new appears: it fills
;;; the hole, then goes on by utility. Forks are made between ticks, so the agent passes them.

(defun score-ahead (id)
  "Return what the hole ID as the first brings: the sum of readings of the score after 20, 40 and 60
steps, so earlier scores count more."
  (with-fork ()
    (let ((clock (find-thing 'clock)))
      (put-kicker next-hole (thing clock))
      (put-kicker next-tile (thing clock))
      (put-kicker next-obstacle (thing clock)))
    (work id (choice #'utility nil))
    (loop repeat 3
          do (run-ticks 40)
          sum *score*)))

(defun best-ahead ()
  "Return the number of the best of the three holes with the highest utility, or NIL."
  (let* ((open (remove-if-not #'way-to-fill (best-first *holes* #'utility)))
         (best (subseq open 0 (min 3 (length open)))))
    (first (first (if (rest best)
                      (best-first best (lambda (hole) (score-ahead (hole-id hole))))
                      best)))))

(defun look-ahead ()
  "Play to the end of the game."
  (let* ((ready t) (choice (list #'utility -1000 (lambda (holes)
                                                   (declare (ignore holes))
                                                   (setf ready t)))))
    (loop until (game-over-p)
          do (if ready
                 (let ((id (best-ahead)))
                   (setf ready nil)
                   (think-of *holes* (lambda ()
                                       (if id
                                           (work id choice)
                                           (spend-steps 1 (lambda () (start-over choice)))))))
                 (run-ticks 1)))))
