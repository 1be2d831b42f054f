;;;; events.lisp -- Truckworld: how a country is laid out, and what happens there by itself.

;;; The seed chooses which roads exist, their surfaces, the depots where parcels appear, pumps and
;;; drums. All that happens by itself is drawn by kickers, so all agents meet the same.

(in-package :ars-testbeds.trucks)
(in-readtable :nisp)

;;; Laying out.

(defun dice () (world-dice *world* :user))

(defun roll-ticks (mean)
  "Return ticks, from half to one and a half times MEAN."
  (+ (ceiling mean 2) (roll-index (1+ mean) (dice))))

(defun shuffled (list)
  (loop with rest = list
        while rest
        collect (let ((element (roll-element rest (dice))))
                  (setf rest (remove element rest :test #'equal))
                  element)))

(defun connected-p (roads)
  "True if all places can be reached from the first by ROADS."
  (let ((reached (list 0)))
    (loop for new = (loop for (a b) in roads
                          when (and (member a reached) (not (member b reached))) return b
                          when (and (member b reached) (not (member a reached))) return a)
          while new do (push new reached))
    (= 12 (length reached))))

(defun choose-roads ()
  "Return the lattice without four random roads, if possible: all places stay connected."
  (let ((roads (lattice)) (removed 0))
    (dolist (road (shuffled (lattice)) roads)
      (let ((rest (remove road roads :test #'equal)))
        (when (and (< removed 4) (connected-p rest))
          (setf roads rest removed (1+ removed)))))))

(defun put (name point &rest attributes)
  (make-new-thing name (list* *world* point) (append attributes '((:size 1)))))

(defun between (place other share)
  "Return the point on the way from PLACE to OTHER after SHARE of it."
  (mapcar (lambda (a b) (+ (* a (- 1 share)) (* b share))) (place-point place)
          (place-point other)))

(defun fence-off (place other)
  "Close the road between two places, which does not exist."
  (dolist (share '(1/5 1/2 4/5))
    (put 'fence (between place other share) '(:color red) '(:obsmove t))))

(defkicker lay-roads (clock) (:prob 0)
  (let ((roads (choose-roads)) (places (shuffled (loop for place below 12 collect place))))
    (setf *roads* (loop for (a b) in roads
                        collect (list a b (roll-element '(:paved :paved :gravel :gravel :dirt :dirt)
                                                        (dice))))
          *depots* (subseq places 0 4)
          *pumps* (list (nth 3 places) (nth 4 places))
          *fuel* tank-size*
          ;; CHANGE-WEATHER begins with a change.
          *raining* (not (chance rain-share* (dice))))
    (loop for (a b) in (lattice)
          unless (find-road a b) do (fence-off a b))
    (loop for (a b surface) in *roads*
          do (put 'sign (mapcar #'+ (between a b .5) (if (= 1 (- b a)) '(0 1) '(1 0)))
                  (list :surface surface) (list :color (sign-color surface))))
    (dolist (place *depots*) (put 'depot (mapcar #'+ (place-point place) '(-1 -1)) '(:color blue)))
    (dolist (place *pumps*) (put 'pump (mapcar #'+ (place-point place) '(1 -1)) '(:color green)))
    (loop for place in (subseq places 5 8)
          do (run-kicker (set-kicker (put 'drum (mapcar #'+ (place-point place) '(1 1))
                                          '(:color lightred) '(:fuel 60))
                                     'leak)
                         (roll-ticks 20)))))

;;; What happens by itself.

(defkicker leak (drum) (:prob 0)
  (let ((left (1- (get-attribute drum :fuel))))
    (set-attribute drum :fuel (max 0 left))
    (when (plusp left) (run-kicker self 20))))

(defkicker change-weather (clock) (:prob 0)
  ;; Rain lasts 100 ticks in the mean.
  (setf *raining* (if *raining* (<= 1 rain-share*) (plusp rain-share*)))
  (run-kicker self (if *raining*
                       (roll-ticks 100)
                       (roll-ticks (ceiling (* 100 (- 1 rain-share*)) (max 1/100 rain-share*))))))

(defkicker wet (clock) (:prob 0)
  (setf *wetness* (if *raining*
                      (+ *wetness* (* .15d0 (- 1 *wetness*)))
                      (* .93d0 *wetness*)))
  (dolist (sign (find-things 'sign))
    (let ((color (sign-color (get-attribute sign :surface))))
      (unless (eq color (get-attribute sign :color)) (set-attribute sign :color color))))
  (run-kicker self 5))

(defun parcel-id (parcel) "Return the number of PARCEL, a thing." (get-attribute parcel :parcel))

(defun find-parcel (id) (find id *parcels* :key #'parcel-id))

(defun remove-parcel (parcel)
  (setf *parcels* (remove parcel *parcels*))
  (destroy-thing parcel))

(defkicker expire (parcel) (:prob 0)
  (set-attribute parcel :value 0)
  (when (eq :floor (thing-location parcel)) (remove-parcel parcel)))

(defun spoilt-value (value ticks)
  "Return what milk of VALUE is worth after so many TICKS: it loses a tenth in 20."
  (loop repeat (floor ticks 20) do (setf value (* 9/10 value)))
  value)

(defkicker spoil (parcel) (:prob 0)
  (set-attribute parcel :value (* 9/10 (get-attribute parcel :value)))
  (run-kicker self 20))

(defkicker next-parcel (clock) (:prob 0)
  (run-kicker self (roll-ticks parcel-interval*))
  (let* ((depot (roll-element *depots* (dice)))
         (destination (roll-element (remove depot '(0 1 2 3 4 5 6 7 8 9 10 11)) (dice)))
         (value (1+ (roll-index 10 (dice))))
         (now (simulation-tick)) (deadline (+ now (roll-ticks deadline-time*)))
         (milk (zerop (roll-index 4 (dice)))) (id (1+ (length *offers*)))
         (weight (1+ (roll-index 12 (dice))))
         (point (mapcar (lambda (x) (+ x (roll-index 3 (dice)) -1)) (place-point depot)))
         (parcel (put 'parcel point (list :parcel id) (list :destination destination)
                      (list :value value) (list :deadline deadline)
                      (list :weight weight)
                      (list :color (if milk 'lightblue 'red)))))
    (push (list id depot destination value weight now deadline milk) *offers*)
    (setf *parcels* (append *parcels* (list parcel)))
    (run-kicker (set-kicker parcel 'expire) (- deadline now))
    (when milk (run-kicker (set-kicker parcel 'spoil) 20))))

(defkicker clear-away (thing) (:prob 0) (destroy-thing thing))

(defkicker block-road (clock) (:prob 0)
  (run-kicker self (roll-ticks block-interval*))
  (destructuring-bind (a b surface) (roll-element *roads* (dice))
    (declare (ignore surface))
    (run-kicker (set-kicker (put 'block (between a b .5) '(:color red) '(:obsmove t)) 'clear-away)
                (roll-ticks 100))))

(defkicker ignite (clock) (:prob 0)
  (run-kicker self (roll-ticks fire-interval*))
  (let ((depot (roll-element *depots* (dice))))
    (run-kicker (set-kicker (put 'fire (place-point depot) '(:color red)) 'clear-away) 20)
    (dolist (parcel *parcels*)
      (when (lies-at-p parcel depot) (remove-parcel parcel)))))

(defun lies-at-p (thing place)
  "True if THING lies at PLACE."
  (destructuring-bind (x y) (place-point place)
    (and (eq :floor (thing-location thing))
         (<= (max (abs (- (thing-x thing) x)) (abs (- (thing-y thing) y))) 1.5))))
