;;;; work.lisp -- what agents of Truckworld believe, find ways, and do at a place.

(in-package :ars-testbeds.trucks)
(in-readtable :nisp)

;;; What an agent believes. It knows the roads, depots and pumps, the weather and its fuel; parcels,
;;; drums and blocks it must see. A belief is a list (id place destination value deadline weight).

(define-run-variable *beliefs* '() "Beliefs about parcels that lie somewhere.")
(define-run-variable *manifest* '() "Beliefs about parcels aboard.")
(define-run-variable *visits* '() "Lists (place tick): the last scan of each place.")
(define-run-variable *drums* '() "Lists (place fuel): beliefs about drums.")
(define-run-variable *blocked* '() "Lists (place place tick): roads that were found blocked.")
(define-run-variable *tasks* '() "What the arms are to do: lists (:load id tries), (:unload id).")
(define-run-variable *arms-done* 0 "How many arms have nothing left to do.")

(defun continuing (then)
  "Return a continuation that calls the function THEN with the error code and the result, unless the
command was interrupted."
  (lambda (err resource &optional result)
    (declare (ignore resource))
    (unless (eq err :interrupt) (funcall then err result))))

(defun note-scan (place reports tick)
  "Believe that there are REPORTS at PLACE, and no other parcels."
  (setf *visits* (cons (list place tick) (remove place *visits* :key #'first))
        *drums* (append (loop for (kind fuel) in reports
                              when (eq :drum kind) collect (list place fuel))
                        (remove place *drums* :key #'first))
        *beliefs* (append (loop for (kind id . more) in reports
                                when (eq :parcel kind) collect (list* id place more))
                          (remove place *beliefs* :key #'second))))

(defun note-loaded (id)
  (let ((belief (assoc id *beliefs*)))
    (when belief
      (setf *manifest* (cons belief *manifest*) *beliefs* (remove id *beliefs* :key #'first)))))

(defun note-unloaded (id) (setf *manifest* (remove id *manifest* :key #'first)))

(defun beliefs ()
  "Return a new list of what WORK believes of parcels that lie somewhere: lists (id place
destination value deadline weight)."
  (copy-list *beliefs*))

(defun last-scan (place) "Return the tick at which WORK last scanned PLACE, or 0."
  (check-argument last-scan place (place-number-p place) *place-text*)
  (or (second (assoc place *visits*)) 0))

(defun found-blocked-p (road)
  "True if WORK has found ROAD blocked in the last 30 ticks."
  (check-road road)
  (loop for (a b tick) in *blocked*
          thereis (and (member a (subseq road 0 2)) (member b (subseq road 0 2))
                       (< (- (simulation-tick) tick) 30))))

;;; Ways. A cost is a function of a road.

(defun length-cost (road) (+ (road-length road) (if (found-blocked-p road) 100 0)))

(defun time-cost (road)
  "Return how many ticks ROAD takes in the present weather with the present cargo."
  (check-road road)
  (let ((surface (third road)))
    (* (road-length road)
       (+ (/ (road-speed surface *wetness* (cargo-weight)))
          (* *time-stuck* (slip-chance surface *wetness*))
          (if (found-blocked-p road) 10 0)))))

(defun fuel-cost (road)
  (* (road-length road) (road-fuel (third road) *wetness* (cargo-weight))))

(defun priced-roads (cost)
  "Return a list (place place price) for each road in each direction."
  (loop for road in *roads*
        for (a b) = road
        for price = (funcall cost road)
        do (check-argument truckworld price (typep price '(real 0))
             "a number, 0 or more, as the cost of a road")
        collect (list a b price)
        collect (list b a price)))

(defun ways-from (start cost &optional (roads (priced-roads cost)))
  "Return a list (place total step) for each place: the least COST to go there, and the first place
on the way."
  (let ((best (list (list start 0 nil))))
    (loop with changed = t
          while (shiftf changed nil)
          do (loop for (a b price) in roads
                   for from = (assoc a best)
                   for known = (assoc b best)
                   do (when (and from
                                 (or (null known) (< (+ (second from) price) (second known))))
                        (setf best (cons (list b (+ (second from) price) (or (third from) b))
                                         (remove known best))
                              changed t))))
    best))

(defun cost-between (place other cost)
  "Return the least COST, a function of a road, to go from PLACE to OTHER."
  (check-argument cost-between place (place-number-p place) *place-text*)
  (check-argument cost-between other (place-number-p other) *place-text*)
  (check-begun)
  (second (assoc other (ways-from place cost))))

(defun next-place (target &optional (cost #'road-length))
  "Return the neighbour of this place that comes first on the way of least COST to TARGET; NIL if
the truck is at TARGET."
  (check-argument next-place target (place-number-p target) *place-text*)
  (check-begun)
  (unless *place*
    (reject-use "The truck is on a road, and has no way to go. MOVE-TRUCK takes it to one of both ~
                 ends, ~{~A or ~A~}." *leg*))
  (third (assoc target (ways-from *place* cost))))

(defun nearest-fuel (place)
  "Return the pump or full drum to which the least fuel is needed from PLACE, and this fuel."
  (let ((ways (remove-if-not (lambda (way)
                               (or (member (first way) *pumps*)
                                   (and (/= (first way) *place*)
                                        (< 40 (or (second (assoc (first way) *drums*)) 0)))))
                             (ways-from place #'fuel-cost))))
    (values-list (first (sort ways #'< :key #'second)))))

(defun checked-target (target)
  "Return TARGET or, if the fuel may not suffice to get there and then to more, where more is."
  (let ((needed (+ (cost-between *place* target #'fuel-cost) (nth-value 1 (nearest-fuel target)))))
    (if (and (< *fuel* (+ 40 (* 5/4 needed))) (not (member *place* *pumps*)))
        (nearest-fuel *place*)
        target)))

;;; Working at a place.

(defun free-room () (loop for bin across (robot-bins truck) sum (floor (remaining-capacity bin))))

(defun free-bay (bay)
  "Return BAY, 0 or 1, if it has room, else the other bay."
  (if (plusp (remaining-capacity (robot-storage-bin truck bay))) bay (- 1 bay)))

(defun worthless-p (belief) (<= (fifth belief) (simulation-tick)))

(defun use-arms (tasks then)
  "Let both arms do TASKS at the same time, then call the function THEN."
  (setf *tasks* tasks *arms-done* 0)
  (dotimes (index 2) (use-arm (robot-hand truck index) then)))

(defun use-arm (hand then)
  (destructuring-bind (&optional kind id (tries 0)) (first *tasks*)
    (setf *tasks* (rest *tasks*))
    (ecase kind
      (:unload (unload-parcel hand id (continuing (lambda (err result)
                                                    (declare (ignore err result))
                                                    (note-unloaded id)
                                                    (use-arm hand then)))))
      (:load (load-parcel hand id (free-bay (hand-index hand))
                          (continuing (lambda (err result)
                                        (declare (ignore result))
                                        (note-load id err tries)
                                        (use-arm hand then)))))
      ((nil) (when (= 2 (incf *arms-done*)) (funcall then))))))

(defun note-load (id err tries)
  (cond ((null err) (note-loaded id))
        ((and (member err '(:parcel-dropped :bay-full)) (< tries 2))
         (setf *tasks* (append *tasks* (list (list :load id (1+ tries))))))
        (t (setf *beliefs* (remove id *beliefs* :key #'first)))))

(defun unloading-tasks ()
  (loop for belief in *manifest*
        when (or (eql *place* (third belief)) (worthless-p belief))
          collect (list :unload (first belief))))

(defun loading-tasks (wanted)
  "Return tasks to load the parcels here that are WANTED, the most valuable first, if they fit."
  (let ((parcels (remove-if-not (lambda (belief)
                                  (and (eql *place* (second belief))
                                       (/= *place* (third belief))
                                       (<= (sixth belief) arm-strength*)
                                       (not (worthless-p belief))
                                       (funcall wanted belief)))
                                *beliefs*)))
    (loop for belief in (stable-sort parcels #'> :key #'fourth)
          repeat (free-room)
          collect (list :load (first belief) 0))))

(defun serve (wanted then)
  "Unload what is for this place, scan it, load the parcels that are WANTED, and refuel. Then call
the function THEN."
  (use-arms (unloading-tasks)
            (lambda ()
              (scan (lambda () (use-arms (loading-tasks wanted) (lambda () (refuel then))))))))

(defun worth-scanning-p (place)
  "True if PLACE has not been scanned, or is a depot and has not been scanned for 5 ticks."
  (let ((visit (assoc place *visits*)))
    (or (null visit)
        (and (member place *depots*) (< (+ 5 (second visit)) (simulation-tick))))))

(defun scan (then)
  "Scan this place if that is worth while. Then call the function THEN."
  (if (worth-scanning-p *place*)
      (scan-place (robot-camera truck 0)
                  (continuing (lambda (err reports)
                                (declare (ignore err))
                                (note-scan *place* reports (simulation-tick))
                                (funcall then))))
      (funcall then)))

(defun worth-refuelling-p (place)
  "True if the tank should be filled at PLACE, by a pump or a drum that the truck has seen."
  (or (and (member place *pumps*) (< *fuel* (* 4/5 tank-size*)))
      (< 30 (min (or (second (assoc place *drums*)) 0) (- tank-size* *fuel*)))))

(defun refuel (then)
  (if (worth-refuelling-p *place*)
      (refuel-truck truck (continuing (lambda (err result)
                                        (declare (ignore err result))
                                        (setf *drums* (remove *place* *drums* :key #'first))
                                        (funcall then))))
      (funcall then)))

(defun drive-to (place then)
  "Drive to PLACE, a neighbour, or back if the road is blocked. Then call the function THEN. Without
fuel, the truck stays."
  (move-truck truck place
              (continuing (lambda (err result)
                            (declare (ignore result))
                            (case err
                              ((nil) (funcall then))
                              (:stuck (drive-to place then))
                              (:road-closed (turn-back place then))
                              (:no-road (wait 5 then)))))))

(defun turn-back (place then)
  "The road to PLACE is blocked: drive back. Then call the function THEN."
  (push (append *leg* (list (simulation-tick))) *blocked*)
  (drive-to (first (remove place *leg*)) then))

(defun work (choose cost wanted)
  "Serve the place where the truck is, choose where to go and drive a road towards it, and so on.
CHOOSE is a function without arguments that returns the number of the place to go to; if the truck
is there, it waits for 10 ticks. COST is a function of a road, a list (place place surface), that
returns a number. WANTED is a test of parcels here that fit and are not overdue: lists (id place
destination value deadline weight)."
  (serve wanted (lambda () (set-out choose cost wanted))))

(defun set-out (choose cost wanted)
  (let* ((target (funcall choose))
         (step (next-place target cost)))
    (if (or (null step) (found-blocked-p (find-road *place* step)))
        (wait 10 (lambda () (set-out choose cost wanted)))
        (drive-to step (lambda () (work choose cost wanted))))))

(defun wait (ticks then)
  (spend-time truck ticks (continuing (lambda (err result)
                                        (declare (ignore err result))
                                        (funcall then)))))
