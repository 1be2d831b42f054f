;;;; agents.lisp -- agents of Truckworld: how they choose where to go.

(in-package :ars-testbeds.trucks)
(in-readtable :nisp)

(defun anything (belief) (declare (ignore belief)) t)

(defun own-dice () (make-dice (+ (* 100003 (world-seed *world*)) (simulation-tick)) "agent"))

(defun random-neighbour () (roll-element (neighbours *place*) (own-dice)))

(defun least (places cost)
  "Return the one of PLACES, not empty, with the least COST."
  (let ((ways (ways-from *place* cost)))
    (first (stable-sort (copy-list places) #'< :key (lambda (place) (second (assoc place ways)))))))

(defun oldest-depot ()
  (first (stable-sort (remove *place* *depots*) #'< :key #'last-scan)))

(defun live-manifest () (remove-if #'worthless-p *manifest*))

(defun choose-nearest ()
  "Return the nearest destination of the cargo, else the depot that was not seen for longest."
  (checked-target (if (live-manifest)
                      (least (mapcar #'third (live-manifest)) #'length-cost)
                      (oldest-depot))))

(defun choose-valuable ()
  "Return the destination of the most valuable parcel aboard, else as CHOOSE-NEAREST."
  (let ((cargo (stable-sort (live-manifest) #'> :key #'fourth)))
    (if cargo (checked-target (third (first cargo))) (choose-nearest))))

(defun in-time-p (belief time)
  (< (+ (simulation-tick) time handling-time*) (fifth belief)))

(defun expected-worth (depot time)
  "Return what the parcels are worth that one expects to load at DEPOT after TIME."
  (let* ((known (loop for belief in *beliefs*
                      when (and (eql depot (second belief)) (in-time-p belief (+ time 30)))
                        collect (fourth belief)))
         (age (min 150 (- (+ (simulation-tick) time) (last-scan depot))))
         (new (/ age parcel-interval* (length *depots*)))
         (room (free-room)))
    (* (+ (reduce #'+ known) (* 4 new)) (min 1 (/ room (+ (length known) new 1/10))))))

(defun prize (place time)
  "Return what it brings to be at PLACE after TIME. What is loaded counts half."
  (+ (loop for belief in *manifest*
           when (and (eql place (third belief)) (in-time-p belief time)) sum (fourth belief))
     (if (member place *depots*) (/ (expected-worth place time) 2) 0)))

(defun discount (ticks)
  "Return how much what comes in so many TICKS is worth now: 3/2 percent less for each tick."
  (exponential (* -.015d0 ticks)))

(defun tour-worth (place time targets depth times)
  "Return what the best tour over DEPTH of TARGETS is worth that begins at PLACE after TIME. TIMES
are lists (place way...), ways as those of WAYS-FROM."
  (if (zerop depth)
      0
      (loop for target in targets
            maximize (tour-worth-first target place time targets depth times))))

(defun tour-worth-first (target place time targets depth times)
  "As TOUR-WORTH, if the tour goes to TARGET first."
  (let ((arrival (+ time 6 (second (assoc target (rest (assoc place times)))))))
    (+ (* (prize target arrival) (discount arrival))
       (tour-worth target arrival (remove target targets) (1- depth) times))))

(defun ranked-targets ()
  "Return depots and destinations of the cargo other than this place, the best to go to first."
  (let* ((targets (remove *place* (union *depots* (mapcar #'third (live-manifest)))))
         (roads (priced-roads #'time-cost))
         (times (loop for place in (cons *place* targets)
                      collect (cons place (ways-from place nil roads))))
         (depth (min 3 (length targets))))
    (mapcar #'second (stable-sort (loop for target in (sort targets #'<)
                                      collect (list (tour-worth-first target *place* 0 targets depth
                                                                      times)
                                                    target))
                                #'> :key #'first))))

(defun choose-by-time ()
  "Return the place that is first on the best tour over three targets, or one with fuel."
  (checked-target (first (ranked-targets))))

(defun worth-loading-p (belief)
  "True if the parcel of BELIEF can be delivered in time if the truck goes there at once."
  (in-time-p belief (+ 10 (cost-between *place* (third belief) #'time-cost))))

(defun idle ())
(defun random-driver () (work #'random-neighbour #'length-cost #'anything))
(defun nearest-first () (work #'choose-nearest #'length-cost #'anything))
(defun valuable-first () (work #'choose-valuable #'length-cost #'anything))
(defun planner () (work #'choose-by-time #'time-cost #'worth-loading-p))

;;; Looking ahead. The agent tries its three best targets in forks of the run, and goes on there as
;;; PLANNER. A fork has another seed, so it knows nothing of the future. But it knows the present:
;;; where parcels and blocks are that the truck has not seen.

(defun worth-ahead (target seed horizon)
  "Return what the truck delivers in HORIZON ticks if it goes to TARGET first, the sum of three
readings, so that earlier counts more, and what it has aboard then."
  (with-fork (:seed seed)
    (let ((before *worth*))
      (drive-to (next-place target #'time-cost) (lambda () (planner)))
      (+ (loop repeat 3
               do (run-ticks (ceiling horizon 3))
               sum (- *worth* before))
         (reduce #'+ (live-manifest) :key #'fourth)))))

(defun choose-ahead (horizon)
  (let* ((targets (ranked-targets))
         (best (subseq targets 0 (min 3 (length targets))))
         (seed (+ 77 (* 1009 (simulation-tick)) (world-seed *world*))))
    (checked-target
     (first (stable-sort best #'> :key (lambda (target) (worth-ahead target seed horizon)))))))

(defun look-ahead (&key (horizon 100))
  "Play to the end of the game. Forks are made between ticks, so the agent passes them itself."
  (let ((ready nil))
    (flet ((rest-a-moment () (setf ready t)))
      (serve #'worth-loading-p #'rest-a-moment)
      (loop until (game-over-p)
            do (if ready
                   (let ((target (choose-ahead horizon)))
                     (setf ready nil)
                     (drive-to (next-place target #'time-cost)
                               (lambda () (serve #'worth-loading-p #'rest-a-moment))))
                   (run-ticks 1))))))
