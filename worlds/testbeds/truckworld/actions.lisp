;;;; actions.lisp -- what the truck can do: commands that take time, cost fuel and fail.

;;; An action is a command of the simulator: for the prompt, for continuations and, as RPL-..., for
;;; plans. If ATOMIC* is true, an action has its effect when it begins; then the clock is skipped,
;;; and no other action begins. All chance is that of the truck's dice.

(in-package :ars-testbeds.trucks)
(in-readtable :nisp)

(define-knob atomic* nil "" boolean
  "True if an action has its effect at once, and the world goes on for its time afterwards.")
(define-knob handling-time* 4 "ticks" (integer 1 1000)
  "How long it takes to load or unload a parcel with one arm.")
(define-knob scan-time* 2 "ticks" (integer 1 1000) "How long a scan takes.")

;;; An EFFECT is the name of a function of an operation that returns an error code or NIL, a result
;;; and, for a trip, its duration.

(defun begin-action (operation effect ticks)
  (setf (operation-subject operation) (list effect ticks))
  (if atomic*
      (act-at-once operation)
      (go-on operation 'act-at-end ticks)))

(defun act-at-end (operation)
  (multiple-value-call #'end-action operation
    (funcall (first (operation-subject operation)) operation)))

(defun end-action (operation &optional code result duration)
  (declare (ignore duration))
  (end-operation operation code result))

(defun act-at-once (operation)
  (let ((left (- *busy* (simulation-tick))))
    (if (plusp left)
        (go-on operation 'act-at-once left)
        (destructuring-bind (effect ticks) (operation-subject operation)
          (multiple-value-bind (code result duration) (funcall effect operation)
            (setf *busy* (+ (simulation-tick) (or duration ticks))
                  (operation-subject operation) (list code result))
            (go-on operation 'skip-over (or duration ticks)))))))

(defun skip-over (operation)
  (apply #'end-action operation (operation-subject operation)))

;;; Trips. On a road, the truck is at X or Y between its ends.

(defun left-to (robot place)
  "Return how many cells ROBOT has to go to PLACE along its road, negative if it has passed it."
  (destructuring-bind (x y) (place-point place)
    (destructuring-bind (from-x from-y)
        (place-point (or (first (remove place *leg*)) place))
      (+ (* (signum (- x from-x)) (- x (robot-x robot)))
         (* (signum (- y from-y)) (- y (robot-y robot)))))))

(defun face (robot place)
  (destructuring-bind (x y) (place-point place)
    (let ((dx (- x (robot-x robot))) (dy (- y (robot-y robot))))
      (set-robot-angle robot (* (/ pi 2) (round (atan2 dy dx) (/ pi 2)))))))

(defun arrive (place)
  (setf *place* place *leg* '())
  place)

(defun road-tick (robot left)
  "Let ROBOT burn the fuel of a tick, with LEFT cells to go. Return how many cells it goes at most,
or an error code."
  (let* ((surface (third (apply #'find-road *leg*))) (weight (cargo-weight))
         (cells (min left (road-speed surface *wetness* weight)))
         (fuel (min *fuel* (* cells (road-fuel surface *wetness* weight)))))
    (cond ((<= *fuel* 0) :no-fuel)
          (t (decf *fuel* fuel)
             (incf *fuel-used* fuel)
             (if (chance (* cells (slip-chance surface *wetness*)) (robot-dice robot :motion))
                 :stuck
                 cells)))))

(defparameter *time-stuck* 10 "How many ticks it takes to dig out the wheels.")

(defun drive-on (operation)
  "Drive for a tick."
  (let* ((robot (operation-resource operation)) (place (first (operation-arguments operation)))
         (left (left-to robot place)))
    (if (<= left .05)
        (end-operation operation nil (arrive place))
        (let ((cells (road-tick robot left)))
          (case cells
            (:no-fuel (fail-with operation :no-fuel))
            (:stuck (go-on operation 'dig-out *time-stuck*))
            (t (if (drive-tick robot cells)
                   (fail-with operation :road-closed)
                   (go-on operation 'drive-on))))))))

(defun dig-out (operation) (fail-with operation :stuck))

(defun blocked-after-p (robot place cells)
  "True if something blocks the way of ROBOT to PLACE within so many CELLS."
  (destructuring-bind (x y) (place-point place)
    (let ((dx (signum (- x (robot-x robot)))) (dy (signum (- y (robot-y robot)))))
      (loop for step from 1 to (ceiling cells)
              thereis (some #'thing-obsmove-p
                            (things-at *world* (+ (robot-x robot) (* dx (min step cells)))
                                       (+ (robot-y robot) (* dy (min step cells)))))))))

(defun jump (operation)
  "Drive to the end at once. Return the error code, the place and the ticks that it takes."
  (let* ((robot (operation-resource operation)) (place (first (operation-arguments operation)))
         (all (left-to robot place)) (left all) (ticks 1) (code nil))
    (flet ((stop-here ()
             (destructuring-bind (x y) (place-point place)
               (place-robot robot
                            (- x (* (cosine (robot-angle robot)) (max 0 left)))
                            (- y (* (sine (robot-angle robot)) (max 0 left)))
                            (robot-angle robot)))))
      (loop while (and (null code) (< .05 left))
            do (let ((cells (road-tick robot left)))
                 (cond ((symbolp cells) (setf code cells))
                       ((blocked-after-p robot place (- all left (- cells)))
                        (setf code :road-closed))
                       (t (decf left (* cells (+ 1 (roll-within motion-noise*
                                                                (robot-dice robot :motion)))))))
                 (incf ticks (if (eq :stuck code) *time-stuck* 1))))
      (stop-here)
      (values code (if code nil (arrive place)) ticks))))

(defun check-truck (part &rest arguments)
  "Return ARGUMENTS. Signal WRONG-ARGUMENT unless PART is the truck or one of its parts, and MISUSE
before a game."
  (let ((robot (if (robot-p part) part (part-robot part))))
    (unless (eq truck robot)
      (error 'wrong-argument :operator "an action of Truckworld" :name 'robot :value robot
                             :expected "the robot TRUCK of the world COUNTRY"))
    (check-begun)
    arguments))

(define-argument-type 'place-number (lambda (value) (typep value '(integer 0 11)))
  "the number of a place, from 0 to 11")
(define-argument-type 'bay (lambda (value) (typep value '(integer 0 1))) "a bay, 0 or 1")

(define-command move-truck (operation (robot robot) (place place-number "where to go"))
    ((place "the place, or NIL"))
    ((:family :moving) (:delay 1) (:arguments check-truck) (:traits :drives)
     (:errors (:no-road "There is no road to that place" "The truck is not at the end of a road to
the place." "Go to a neighbouring place.")
              (:road-closed "Something blocks the road" "Something stands on the road."
                             "Go back and around it, or wait.")
              (:stuck "The truck was stuck" "Wheels slipped, and had to be dug out." "Go on.")
              (:no-fuel "The tank is empty" "There is no fuel." "Refuel in time."))
     (:report (place) (format nil "Truck is at place ~D" place)))
    "Drive the truck ROBOT along a road to PLACE. On a road, both of its ends can be reached."
  (let ((legal (if *place* (find-road *place* place) (member place *leg*))))
    (cond ((eql place *place*) (end-operation operation nil place))
          ((not legal) (fail-with operation :no-road))
          (t (when *place* (setf *leg* (list *place* place) *place* nil))
             (face robot place)
             (if atomic* (begin-action operation 'jump 1) (drive-on operation))))))

;;; Arms.

(defun drop-p (hand parcel)
  "True if HAND drops PARCEL, which loses a quarter of its value."
  (when (chance (drop-chance (get-attribute parcel :weight))
                (robot-dice (hand-robot hand) :handling))
    (incf *drops*)
    (set-attribute parcel :value (* 3/4 (get-attribute parcel :value)))
    t))

(defun stow (operation)
  (destructuring-bind (id bay) (operation-arguments operation)
    (let* ((hand (operation-resource operation)) (parcel (find-parcel id))
           (bin (robot-storage-bin (hand-robot hand) bay)))
      (cond ((not (and parcel *place* (lies-at-p parcel *place*))) :not-here)
            ((< arm-strength* (get-attribute parcel :weight)) :parcel-too-heavy)
            ((< (remaining-capacity bin) 1) :bay-full)
            ((drop-p hand parcel) :parcel-dropped)
            (t (move-thing parcel bin)
               nil)))))

(define-command load-parcel (operation (hand hand) (id integer "the number of a parcel")
                             (bay bay "the bay to put it into, 0 or 1"))
    ()
    ((:family :handling) (:delay 1) (:arguments check-truck)
     (:errors (:not-here "There is no such parcel here" "The parcel is elsewhere." "Scan again.")
              (:parcel-too-heavy "The parcel is too heavy" "No arm can lift it." "Leave it.")
              (:bay-full "The bay is full" "A bay has room for 4 parcels." "Use the other bay.")
              (:parcel-dropped "The arm dropped the parcel" "The parcel is damaged." "Try again.")))
    "Let the arm HAND lift a parcel at this place into a bay."
  (begin-action operation 'stow handling-time*))

(defun receive (parcel)
  "Take PARCEL, which lies at this place, if it is for here or worth nothing."
  (let ((value (get-attribute parcel :value))
        (here (= *place* (get-attribute parcel :destination))))
    (when (and here (plusp value))
      (incf *worth* value)
      (incf *delivered*))
    (when (or here (zerop value)) (remove-parcel parcel))))

(defun put-out (operation)
  (let* ((hand (operation-resource operation))
         (parcel (find-parcel (first (operation-arguments operation)))))
    (cond ((not (and parcel (member parcel (cargo)))) :not-aboard)
          ((null *place*) :not-at-place)
          (t (drop-p hand parcel)
             (move-thing parcel (place-point *place*))
             (receive parcel)
             nil))))

(define-command unload-parcel (operation (hand hand) (id integer "the number of a parcel"))
    ()
    ((:family :handling) (:delay 1) (:arguments check-truck)
     (:errors (:not-aboard "The parcel is not aboard" "No bay has the parcel." "Load it.")
              (:not-at-place "The truck is on a road" "Parcels are unloaded at places."
                             "Go to a place.")))
    "Let the arm HAND take a parcel out of a bay. It is delivered if this is its destination."
  (begin-action operation 'put-out handling-time*))

;;; Scans.

(defun report-of (thing misread)
  (case (get-attribute thing :parcel)
    ((nil) (list :drum (get-attribute thing :fuel)))
    (t (list :parcel (parcel-id thing)
             (if misread (mod (+ (get-attribute thing :destination) misread) 12)
                 (get-attribute thing :destination))
             (get-attribute thing :value) (get-attribute thing :deadline)
             (get-attribute thing :weight)))))

(defun look-round (operation)
  (let ((dice (robot-dice (part-robot (operation-resource operation)) :looking)))
    (values nil
            (when *place*
              (loop for thing in (append *parcels* (find-things 'drum))
                    when (lies-at-p thing *place*)
                      append (let ((miss (miss-chance (distance-of thing))))
                               (unless (chance miss dice)
                                 (list (report-of thing (and (chance (/ miss 2) dice)
                                                             (1+ (roll-index 11 dice))))))))))))

(defun distance-of (thing)
  (norm (make-pt (- (thing-x thing) (robot-x truck)) (- (thing-y thing) (robot-y truck)))))

(define-command scan-place (operation (camera camera))
    ((reports "lists (:parcel id destination value deadline weight) and (:drum fuel)"))
    ((:family :looking) (:delay 1) (:arguments check-truck) (:traits :asks)
     (:report (reports) (format nil "Scan found ~D thing~:P" (length reports))))
    "Let CAMERA scan the place where the truck is. Things farther from the truck, and in rain, are
missed more often, and the destinations of parcels are misread half as often."
  (begin-action operation 'look-round scan-time*))

;;; Fuel and time.

(defun fill-up (operation)
  (declare (ignore operation))
  (let ((drum (and *place* (find-if (lambda (drum) (lies-at-p drum *place*)) (find-things 'drum)))))
    (cond ((and *place* (member *place* *pumps*)) (setf *fuel* tank-size*) nil)
          ((null drum) :no-fuel-here)
          (t (let ((amount (min (get-attribute drum :fuel) (- tank-size* *fuel*))))
               (incf *fuel* amount)
               (set-attribute drum :fuel (- (get-attribute drum :fuel) amount))
               nil)))))

(define-command refuel-truck (operation (robot robot))
    ()
    ((:family :handling) (:delay 1) (:arguments check-truck)
     (:errors (:no-fuel-here "There is no fuel here" "Neither a pump nor a drum is here."
                             "Go to a pump.")))
    "Let the truck ROBOT fill its tank at a pump, or by what is left in a drum."
  (begin-action operation 'fill-up 5))

(defun do-nothing (operation) (declare (ignore operation)) nil)

(define-command spend-time (operation (robot robot) (ticks tick-span "for how long"))
    ()
    ((:family :moving) (:delay 1) (:arguments check-truck))
    "Let the truck ROBOT stand for TICKS."
  (begin-action operation 'do-nothing (max 1 ticks)))

;;; For plans.

(define-fluents robot
  (truck-moved* "Pulsed when the truck has ended a trip, refuelled or waited.")
  (truck-error* "The error code of the last of these actions; NIL after success."))
(define-fluents hand
  (arm-moved* "Pulsed when the arm has loaded or unloaded a parcel, or failed to.")
  (arm-error* "The error code of the last of these actions; NIL after success."))
(define-fluents camera
  (scan-ended* "Pulsed when a scan has ended.")
  (scan-reports* "What the last scan has found."))

(define-outcome (move-truck refuel-truck spend-time) (result)
  (:error truck-error*) (:pulse truck-moved*))
(define-outcome (load-parcel unload-parcel) () (:error arm-error*) (:pulse arm-moved*))
(define-outcome (scan-place) (reports) (:set scan-reports* reports) (:pulse scan-ended*))
