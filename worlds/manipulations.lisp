;;;; manipulations.lisp -- manipulations for lids, doors, locks and lamps.

;;; Use them in any world with containers, doors (:door #t), keys (:type :key) and lamps
;;; (:type :lamp): (manipulate open box-designator (robot-hand robbie 0) continuation). A lock and
;;; its keys have the same :lock-id. The error codes are :FAILED, and those that name the obstacle,
;;; such as :LOCKED. The value is the hand. Manual 5.5.

(in-package :ars-worlds)
(in-readtable :nisp)

(defattribute :locked (#t #f)
  :success .9)

(defattribute :lit (#t #f)
  :success .95 :noticed .6)

;;; Obstacles.

(defun beside-hand-p (thing hand)
  "True if THING and HAND are in the same container, or both in none."
  (in-location thing (or (part-location hand) :floor)))

(defun lid-error-code (container hand)
  "Return the error code if HAND cannot move the lid of CONTAINER, else #F."
  (cond ((not (beside-hand-p container hand)) :out-of-reach)
        ((get-attribute container :locked) :locked)))

(defun key-error-code (container key hand)
  "Return the error code if HAND cannot turn KEY in the lock of CONTAINER, else #F."
  (cond ((not (in-location key hand)) :key-not-in-hand)
        ((not (beside-hand-p container hand)) :out-of-reach)
        ((not (get-attribute container :closed)) :lid-open)))

;;; Lids. The last method that fits is used, so the special ones come last.

(defmanipulation open (container - ((:capacity (.01 100000))) :by hand - HAND) ()
  (values :already-open hand))

(defmanipulation open (container - ((:capacity (.01 100000)) (:closed #t)) :by hand - HAND)
    (:success .98 :delay 2)
  (let ((trouble (cond ((hand-holding hand) :hand-full)
                       (t (lid-error-code container hand)))))
    (unless trouble (set-attribute container :closed #f))
    (values trouble hand)))

(defmanipulation close (container - ((:capacity (.01 100000))) :by hand - HAND) ()
  (values :already-closed hand))

(defmanipulation close (container - ((:capacity (.01 100000)) (:closed #f)) :by hand - HAND)
    (:success .98 :delay 2)
  ;; A hand that holds something can close a lid, too.
  (let ((trouble (lid-error-code container hand)))
    (unless trouble (set-attribute container :closed #t))
    (values trouble hand)))

;;; Locks.

(defmanipulation lock (container - ((:capacity (.01 100000)) (:lock-id ?id))
                       key - ((:type :key) (:lock-id ?id))
                       :by hand - HAND)
    (:success .95 :delay 3)
  (let ((trouble (key-error-code container key hand)))
    (unless trouble (set-attribute container :locked #t))
    (values trouble hand)))

(defmanipulation unlock (container - ((:capacity (.01 100000)) (:lock-id ?id))
                         key - ((:type :key) (:lock-id ?id))
                         :by hand - HAND)
    (:success .95 :delay 3)
  (let ((trouble (key-error-code container key hand)))
    (unless trouble (set-attribute container :locked #f))
    (values trouble hand)))

;;; Doors. The hand must be where the door is, beside the robot.

(defun robot-in-cell-of-p (thing robot)
  (and (= (floor (robot-x robot)) (floor (thing-x thing)))
       (= (floor (robot-y robot)) (floor (thing-y thing)))))

(defun doorway-occupied-p (door)
  "True if a robot or a thing other than DOOR is in the cell of DOOR."
  (or (some (lambda (robot) (robot-in-cell-of-p door robot)) (simulation-robots))
      (some (lambda (thing)
              (and (not (eq thing door))
                   (eq :floor (thing-location thing))
                   (= (floor (thing-x thing)) (floor (thing-x door)))
                   (= (floor (thing-y thing)) (floor (thing-y door)))))
            (world-thing-list (thing-world door)))))

(defun door-key-error-code (door key hand)
  "Return the error code if HAND cannot turn KEY in the lock of DOOR, else #F."
  (let ((trouble (key-error-code door key hand)))
    (if (eq :lid-open trouble) :door-open trouble)))

(defmanipulation open (door - ((:door #t)) :by hand - HAND) ()
  (values :already-open hand))

(defmanipulation open (door - ((:door #t) (:closed #t)) :by hand - HAND)
    (:success .98 :delay 2)
  (let ((trouble (cond ((hand-holding hand) :hand-full)
                       (t (lid-error-code door hand)))))
    (unless trouble (set-attribute door :closed #f))
    (values trouble hand)))

(defmanipulation close (door - ((:door #t)) :by hand - HAND) ()
  (values :already-closed hand))

(defmanipulation close (door - ((:door #t) (:closed #f)) :by hand - HAND)
    (:success .98 :delay 2)
  (let ((trouble (cond ((lid-error-code door hand))
                       ((doorway-occupied-p door) :doorway-occupied))))
    (unless trouble (set-attribute door :closed #t))
    (values trouble hand)))

(defmanipulation lock (door - ((:door #t) (:lock-id ?id)) key - ((:type :key) (:lock-id ?id))
                       :by hand - HAND)
    (:success .95 :delay 3)
  (let ((trouble (door-key-error-code door key hand)))
    (unless trouble (set-attribute door :locked #t))
    (values trouble hand)))

(defmanipulation unlock (door - ((:door #t) (:lock-id ?id)) key - ((:type :key) (:lock-id ?id))
                         :by hand - HAND)
    (:success .95 :delay 3)
  (let ((trouble (door-key-error-code door key hand)))
    (unless trouble (set-attribute door :locked #f))
    (values trouble hand)))

;;; Lamps.

(defun switch-lamp (lamp lit hand)
  "Switch LAMP on if LIT is true, else switch it off. Return the error code or NIL, and HAND."
  (cond ((beside-hand-p lamp hand)
         (set-attribute lamp :lit lit)
         (values nil hand))
        (t (values :out-of-reach hand))))

(defmanipulation switch-on (lamp - ((:type :lamp)) :by hand - HAND) (:delay 1)
  (switch-lamp lamp #t hand))

(defmanipulation switch-off (lamp - ((:type :lamp)) :by hand - HAND) (:delay 1)
  (switch-lamp lamp #f hand))
