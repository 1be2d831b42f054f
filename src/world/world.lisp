;;;; world.lisp -- what changes during a run: one world per simulation.

(in-package :ars-magna.world)

(export '(world stock do-cell-things world-rank-count thing-of-rank random-thing do-things
          change-world changing give-dice position-of-dice dice-index +dice-purposes+
          permitting-changes first-warning-for-key-p warning-given-p record-progress-checked
          progress-checked-p warn-once warn-of-angle-in-degrees
          changing-thread-p))

;;; A world is made fresh from its map's recipe. Nothing in it depends on anything but the map
;;; and the seed. Serial numbers count from 1 in order of creation, so that things in order of
;;; creation are things in order of serial number.

(addition world-p)
(define-kind (world :constructor (%make-world (map)))
    "A world on a map: the current state of its things, dice and kickers."
  (:fixed
   (map nil map "the map that the world is of" :addition)
   (robots '() list "the list of the world's robots; the layer above keeps it" :part :addition)
   (ghosts-p nil boolean "the world's robots neither block nor see each other" :addition)
   (dice-names '() list "the full names of the robots that have their own dice, sorted; () if there
is one robot" :export)
   (roster '() list "the world's robots, sorted by full name" :export)
   (kicker-generation 0 fixnum "the *KICKER-GENERATION* of the kicker groups" :export)
   (timeline nil t "the timeline of the world, once there is one; the layer above keeps it" :export)
   (move-watchers '() list
                  "the list of functions (thing old-location new-location) called after a thing has
moved, been made or been destroyed" :export))
  (:state
   (seed 0 integer "the integer that seeds all dice of the world" :addition)
   (flags (make-octets 0) octets
          "the flags of the world's cells by index: walls, and things on the floor" :export)
   (stock (make-stock) stock "the things of the world, and the cells of the floor that they are
in" :part)
   (live-count 0 fixnum "how many things are alive in the world" :export)
   (next-serial 1 fixnum "the serial number of the next thing to be made")
   (dice-set #() simple-vector "a vector of the world's dice, one for each purpose" :part :export)
   (kicker-groups '() list "the groups of kickers with the same probability" :part)
   (kicker-tick 0 tick-count "the number of ticks in which kickers have run")
   (due-kickers '() list "the kickers to run in the next tick by request" :part))
  (:scratch
   (next-due 0 tick-count "no kicker is due by request before this WORLD-KICKER-TICK")
   (noted-names '() list "the keys of the warnings given so far; see FIRST-WARNING-FOR-KEY-P"
                :export)
   (writer nil t "the thread that is changing the world, or NIL" :export))
  ;; While it is NIL, each tick checks.
  (:link
   (settled-p nil boolean "a tick has nothing to settle in the world: no robot has a designator, an
ended track, a part inside of something, a hand with two things in it or with a watched
grip" :export))
  ;; State as well, but only variables that were set are digested, by a method in the layer of runs.
  (:memory
   (run-variables '() t
                  "the run variables of the world's run, lists (name value use), the newest first"
                  :export)))

(defmethod print-object ((world world) stream)
  (print-unreadable-object (world stream :identity t)
    (format stream "WORLD of ~A, ~D things" (map-name (world-map world))
            (world-live-count world))))

;;; Dice.

(define-constant +dice-purposes+
    '(:motion :odometry :place :looking :tracking :handling :kickers :manipulations :user)
  :test #'equal :documentation "The purposes for which each world has dice.")

(defmethod digest-state ((dice dice) digest)
  (digest-add digest (dice-state dice)))

(defun make-dice-of-robot (seed name)
  "Return a vector of dice, one for each purpose. They depend on the integer SEED and on NAME, the
full name of a robot."
  (cl:map 'simple-vector
          (lambda (purpose) (make-dice seed (format nil "~A of ~A" purpose name)))
          +dice-purposes+))

(defun make-dice-set (seed names)
  "Return the dice of a world with SEED: one for each purpose, then those of the robots NAMES."
  (apply #'concatenate 'simple-vector
         (cl:map 'simple-vector (lambda (purpose) (make-dice seed purpose)) +dice-purposes+)
         (loop for name in names collect (make-dice-of-robot seed name))))

(defun position-of-dice (name names)
  "Return where the dice of the robot NAME begin in the dice set of a world with dice for NAMES."
  (* (length +dice-purposes+) (1+ (position name names :test #'string=))))

(defun give-dice (world names)
  "Give each of NAMES, full names of robots, its own dice in WORLD. Names that have dice keep them."
  (let ((count (length +dice-purposes+)) (known (make-hash-table :test 'equal))
        (set (world-dice-set world)))
    (loop for name in (world-dice-names world)
          for start from count by count
          do (setf (gethash name known) (subseq set start (+ start count))))
    (setf (world-dice-set world)
          (apply #'concatenate 'simple-vector (subseq set 0 count)
                 (loop for name in names
                       collect (or (gethash name known)
                                   (make-dice-of-robot (world-seed world) name))))
          (world-dice-names world) names)))

(declaim (inline dice-index world-dice))
(defun dice-index (purpose)
  "Return the position of the dice for PURPOSE among the dice of a world or robot."
  (ecase purpose
    (:motion 0) (:odometry 1) (:place 2) (:looking 3) (:tracking 4)
    (:handling 5) (:kickers 6) (:manipulations 7) (:user 8)))

(addition world-dice)
(defun world-dice (world purpose)
  "Return the dice of WORLD for PURPOSE: :motion, :odometry, :place, :looking, :tracking, :handling,
:kickers, :manipulations or :user. Use only the dice for :user, and only in code that runs within
ticks: kickers, manipulations and events. Numbers drawn elsewhere, as in continuations and plans,
are not repeated in a replay."
  (the dice (svref (world-dice-set world) (dice-index purpose))))

(addition *world*)
(defvar *world* nil
  "The world of the current simulation, headless or live. NIL without a simulation; then code works
in the resident world of each map.")

;;; Things.

(defmacro do-things ((thing world) &body body)
  "Run BODY for each living THING in WORLD, in order of creation, except things that BODY makes and
bodies of robots."
  `(call-with-things (lambda (,thing) ,@body) ,world))

(defun call-with-things (function world)
  (declare (type function function))
  (let* ((stock (world-stock world)) (things (stock-things stock)))
    (dotimes (rank (stock-count stock))
      (let ((thing (svref things rank)))
        (when (and thing (thing-alive-p thing) (not (robot-body-p thing)))
          (funcall function thing))))))

(defun world-rank-count (world)
  "Return the number of ranks in WORLD, which includes the ranks of some destroyed things."
  (stock-count (world-stock world)))

(defun thing-of-rank (rank world)
  "Return the thing of WORLD that has RANK, or NIL if it has been destroyed."
  (svref (stock-things (world-stock world)) rank))

(defun random-thing (world dice)
  "Return a random thing in WORLD, or NIL if there are none or a random rank has none."
  (let* ((stock (world-stock world)) (count (thing-rank-count stock)))
    (cond ((zerop count) nil)
          ((zerop (stock-bodies stock)) (thing-of-rank (roll-index count dice) world))
          (t (loop with left = (roll-index count dice)
                   for rank from 0
                   for thing = (thing-of-rank rank world)
                   do (unless (body-p thing)
                        (when (zerop left) (return thing))
                        (decf left)))))))

(addition world-thing-list)
(defun world-thing-list (world)
  "Return a fresh list of the things alive in WORLD, in order of creation, without robots' bodies."
  (let ((things '()))
    (do-things (thing world) (push thing things))
    (nreverse things)))

(declaim (inline thing-cell-index))
(defun thing-cell-index (thing)
  (the cell-index (point-index (world-map (thing-world thing)) (thing-x thing) (thing-y thing))))

(defun remove-thing (thing world)
  "Remove THING from WORLD. If many things have been destroyed, renumber the ranks without gaps."
  (let ((stock (world-stock world)))
    (setf (svref (stock-things stock) (thing-rank thing)) nil)
    (decf (world-live-count world))
    (when (> (thing-rank-count stock) (+ 64 (* 2 (world-live-count world))))
      (close-rank-gaps stock (lambda (other)
                               (and (eq :floor (thing-location other))
                                    (thing-cell-index other)))))))

(defmacro do-cell-things ((thing index world) &body body)
  "Run BODY with THING bound to each thing on the floor of the cell INDEX of WORLD, in order of
arrival. BODY must not move things."
  (with-gensyms (visit)
    `(flet ((,visit (,thing) ,@body))
       (declare (inline ,visit))
       (visit-things-in-cell #',visit ,index (world-stock ,world)))))

(addition things-at)
(defun things-at (world x y)
  "Return a fresh list of the things on the floor of the cell of WORLD that holds the point (X, Y),
in order of arrival, without robots' bodies. Return NIL if the point is outside the map. Signals
WRONG-ARGUMENT."
  (check-argument things-at world (world-p world) "a world, as (robot-world ROBOT) returns")
  (check-point 'things-at x y)
  (let ((index (map-index (world-map world) x y)) (things '()))
    (when index
      (do-cell-things (thing index world) (unless (robot-body-p thing) (push thing things))))
    (nreverse things)))

;;; Code within ticks (kickers, events, commands) changes the world directly. Changes by users from
;;; elsewhere go to the world's timeline by one generic function: the layer above sends them to the
;;; thread that owns the world, and records them in the journal. A world records which thread is
;;; changing it, so callers need not.

(defgeneric change-world (timeline world function operator arguments)
  (:documentation
   "Change WORLD by calling FUNCTION without arguments, in the thread and at the time in which
TIMELINE, the world's timeline, allows changes. Return the values of FUNCTION. The journal records
the change as OPERATOR, a symbol, with the list ARGUMENTS.")
  (:method ((timeline null) world function operator arguments)
    (declare (ignore world operator arguments))
    (funcall function)))

(declaim (inline changing-thread-p))
(defun changing-thread-p (world)
  "True if this thread is changing WORLD, or there is no world to change."
  (or (null world)
      (eq (world-writer (the world world)) (current-thread))))

(defun call-permitting-changes (function world)
  "Call FUNCTION, which may change WORLD. Only the thread that owns WORLD may call this function."
  (let ((before (world-writer world)))
    (setf (world-writer world) (current-thread))
    (unwind-protect (funcall function)
      (setf (world-writer world) before))))

(defmacro permitting-changes ((world) &body body)
  "Run BODY, which may change WORLD. Only the thread that owns WORLD may use this macro."
  (form-calling 'call-permitting-changes body world))

(defun world-of-living-thing (thing)
  "Return the world that a change of THING affects: NIL if THING is a prototype or destroyed."
  (and (thing-alive-p thing) (thing-world thing)))

(defmacro changing ((world operator &rest arguments) &body body)
  "Run BODY, which changes WORLD, in the thread and at the time in which changes are allowed. WORLD
is NIL for prototypes. The journal records the symbol OPERATOR, unevaluated, and ARGUMENTS: a call
of OPERATOR with them does the same as BODY. Conses nothing inside ticks."
  (once-only (world)
    `(flet ((change-it () ,@body))
       (if (changing-thread-p ,world)
           (change-it)
           ;; A separate closure, so that none is made above.
           (change-world (world-timeline ,world) ,world (lambda () (change-it))
                         ',operator (list ,@arguments))))))

;;; A call that is allowed, but most likely a mistake, gets a warning once: more about the same name
;;; would only hide others. Saved runs refer to a world's slots by name, so the slot is still called
;;; NOTED-NAMES, though it now holds all warnings given, not only names of attributes.

;;; Plans of live runs warn in their own thread: NOTED-NAMES is read and changed under a lock.

(defvar *noted-names-lock* (make-lock "noted names"))

(defun warning-given-p (key world)
  "True if a warning about KEY has been queued in the run of WORLD."
  (with-lock (*noted-names-lock*)
    (and (member key (world-noted-names world) :test #'equal) t)))

(defun first-warning-for-key-p (key world)
  "True if no warning about KEY has been given in the run of WORLD. Record that one is given now."
  (with-lock (*noted-names-lock*)
    (unless (member key (world-noted-names world) :test #'equal)
      (push key (world-noted-names world))
      t)))

(defun record-progress-checked (world)
  "Record that the program itself has checked which commands are in progress in the run of WORLD."
  (first-warning-for-key-p '(:looked-after) world))

(defun progress-checked-p (world)
  "True if the program itself has checked which commands are in progress in the run of WORLD."
  (warning-given-p '(:looked-after) world))

(defun warn-once (key world items &key (notable t))
  "Queue a warning made of ITEMS, a list or a string, unless the run of WORLD has had a warning
about KEY. KEY is, for example, a list of a topic and a name. If no program reads the warning, it is
shown like an error, provided that NOTABLE is true or is a function that returns true at that time.
Return true if the warning was queued."
  (when (first-warning-for-key-p key world)
    (queue-message-items :warning (ensure-list items) :notable-p notable)
    t))

(defun warn-of-angle-in-degrees (operator world angle)
  "Warn once for OPERATOR, a symbol or string, in WORLD if ANGLE may be in degrees, not radians."
  (when (perhaps-degrees-p angle)
    (warn-once (list :angle operator) world
               (format nil "~(~A~): ~A" operator (degrees-advice angle)))))
