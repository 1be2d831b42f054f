;;;; manipulations.lisp -- manipulations for lids, locks and lamps.

;;; Use them in any world with containers, keys (:type :key) and lamps (:type :lamp):
;;; (manipulate open box-designator (robot-hand robbie 0) continuation). A lock and its keys have
;;; the same :lock-id. The error codes are :FAILED, and those that name the obstacle, such as
;;; :LOCKED. The value is the hand. Manual 5.5.

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
