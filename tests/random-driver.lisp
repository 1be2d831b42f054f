;;;; random-driver.lisp -- a driver that issues random commands, and checks after each tick.

(in-package :ars-magna.tests)

(def-suite* random-driver :in ars-magna)

;;; Two robots are in a room full of things that move, change and vanish. The driver issues all
;;; commands, with valid and invalid arguments, and changes the world directly. After each tick the
;;; world must not contradict itself. Each continuation must be called exactly as often as its
;;; command's description says. No error may leave the simulator.

(world:defmap zoo (9 9)
  (rect (0 0) (8 8) bricks 1 4 8 12) (wall (5 1) (5 2) slate 20)
  (obj trunk (3.5 3.5) ((:size 20) (:capacity 18) (:weight 3))
    (box ((:size 6) (:capacity 5) (:weight 1))
      (tin ((:size 1) (:capacity .8) (:weight .2)) (bead ((:size .1))))
      (cap ((:size .5))))
    (ball ((:size 1) (:weight 1) (:color red))))
  (obj case (3.5 3.5) ((:size 8) (:capacity 7) (:weight 2) (:color blue)) (pin ((:size .1))))
  (obj ball (3.2 3.8) ((:size 1) (:weight 1) (:color red)))
  (obj cat (3.8 3.2) ((:size 2) (:weight 3) (:obsview t)))
  (obj rock (3.4 3.1) ((:size 3) (:weight 80)))
  (obj post (6.5 6.5) ((:obsmove t) (:obsview t) (:size 9)))
  (obj barrel (6.5 4.5) ((:size 20) (:capacity 18) (:closed t)) (apple ((:size 1) (:weight 1)))))

(robot:defrobot keeper (zoo (3.5 3.5) 0)
  :cameras (((/ pi 2) 3) ((* 2 pi) 5)) :hands (10 4) :bins (20 5))
(robot:defrobot helper (zoo (2.5 3.5) 1)
  :cameras (((* 2 pi) 3)) :hands (6) :bins (8))

;;; Kickers. All they need comes from the world they run in.

(defun zoo-dice () (world:world-dice world:*world* :user))
(defun zoo-chance (probability) (base:chance probability (zoo-dice)))
(defun any-of (list) (and list (base:roll-element list (zoo-dice))))
(defun zoo-robots () (robot::robots-in-order world:*world*))
(defun any-part (reader) (any-of (coerce (funcall reader (any-of (zoo-robots))) 'list)))

(defun any-place-for (thing)
  "Return a place where something might put THING."
  (case (base:roll-index 6 (zoo-dice))
    (0 (any-part #'robot:robot-hands))
    (1 (any-part #'robot:robot-bins))
    (2 (list 3.4 3.6))
    (t (any-of (remove-if (lambda (other) (or (eq other thing)
                                              (zerop (world:thing-capacity other))))
                          (world:world-thing-list world:*world*))))))

(world:defkicker ride-hop (thing) (:prob .02)
  (flet ((step-length () (base:roll-within .8d0 (zoo-dice))))
    (world:kick-thing thing (step-length) (step-length) (zoo-chance .5))))

(world:defkicker ride-be-put-away (thing) (:prob .004)
  (let ((place (any-place-for thing)))
    (when place (world:move-thing thing place))))

(world:defkicker ride-vanish (thing) (:prob .0007)
  (world:destroy-thing thing))

(world:defkicker ride-change (thing) (:prob .004)
  (world:set-attribute thing :closed (zoo-chance .2))
  (when (zoo-chance .2) (world:set-attribute thing :weight (* 12 (base:roll (zoo-dice)))))
  (when (zoo-chance .1) (error "A kicker that fails.")))

;;; What is under way.

(defstruct (ride (:constructor make-ride (dice)))
  "A random drive: its DICE, the designators it has got, the calls that wait for answers, and what
was answered or was wrong; CALLS digests all calls. Once over, answers lead on to nothing more."
  dice
  (calls (base:make-digest))
  (over-p nil)
  (designators '())
  (pending (make-hash-table :test 'eq))
  (issued 0)
  (outcomes (make-hash-table :test 'equal))
  (troubles '()))

(defvar *ride*)

(defvar *commands-to-draw* nil "The commands that rides draw from; NIL: all of the simulator's.")

(defun luck (probability) (base:chance probability (ride-dice *ride*)))
(defun pick (list) (and list (base:roll-element list (ride-dice *ride*))))

(defun complain (control &rest arguments)
  (push (apply #'format nil control arguments) (ride-troubles *ride*)))

(defun keep-designators (results)
  "Remember the designators in RESULTS, the newest 30 of all."
  (dolist (result results)
    (cond ((robot:designator-p result)
           (push result (ride-designators *ride*))
           (when (nthcdr 30 (ride-designators *ride*))
             (setf (cdr (nthcdr 29 (ride-designators *ride*))) '())))
          ((consp result) (keep-designators result)))))

(defun last-answer-p (name code answers)
  "True if CODE ends the command NAME after ANSWERS answers. Tracks tell of starts and looks, too."
  (let ((track-p (member name '(command:camera-track command:camera-track-matching))))
    (not (and track-p (null code) (or (null (rest track-p)) (zerop answers))))))

(defun note-answer (call name results)
  "Note that CALL, of the command NAME, was answered with RESULTS."
  (let ((answers (gethash call (ride-pending *ride*))))
    (incf (gethash (list name (first results)) (ride-outcomes *ride*) 0))
    (base:digest-add (ride-calls *ride*)
                     (list (run:simulation-tick time:*simulation*) name (princ-to-string results)))
    (cond ((null answers) (complain "~A was answered after it had ended: ~S" name results))
          ((last-answer-p name (first results) answers) (remhash call (ride-pending *ride*)))
          (t (incf (gethash call (ride-pending *ride*)))))))

(defun misbehave ()
  "Do what users' code should not: fail, be aborted, or leave the tick."
  (funcall (pick (list #'abort
                       (lambda () (if (luck .5) (error "Broken.") (throw 'ride-out t)))))))

(defun ride-on (ticks)
  "Pass TICKS, or fewer if somebody leaves one."
  (catch 'ride-out (run:run-ticks ticks)))

(defun rider (name)
  "Return a continuation for the command NAME, which notes its calls, sometimes goes on with
another command, and sometimes fails."
  (let ((call (list name)) (ride *ride*))
    (setf (gethash call (ride-pending *ride*)) 0)
    (values (lambda (&rest results)
              (let ((*ride* ride))
                (note-answer call name results)
                (keep-designators (rest results))
                (unless (ride-over-p ride)
                  (if (luck .8) (follow-up name results) (when (luck .1) (command-at-random)))
                  (when (luck .01) (misbehave)))))
            call)))

;;; Arguments.

(defun any-robot () (pick (zoo-robots)))
(defun part-of-any (reader) (pick (coerce (funcall reader (any-robot)) 'list)))

(defun any-designator ()
  (pick (if (luck .2)
            (ride-designators *ride*)
            (or (robot:live-designators (any-robot)) (ride-designators *ride*)))))

(defun any-specification ()
  (pick '(() () ((:size (0 100))) ((:size (0 3))) ((:capacity (.5 100))) ((:capacity (3 100)))
          ((:color (red blue))) ((:closed nil)) ((:weight (0 5) 2)))))

(defun sensible-argument (type)
  "Return something of the argument type called TYPE."
  (ecase (intern (string type) :keyword)
    (:robot (any-robot)) (:camera (part-of-any #'robot:robot-cameras))
    ((:hand :rangefinder) (part-of-any #'robot:robot-hands))
    (:storage-bin (part-of-any #'robot:robot-bins))
    (:designator (any-designator))
    (:destination (if (luck .25) (part-of-any #'robot:robot-bins) (any-designator)))
    (:designator-type (if (luck .7) :local :non-local))
    (:specification (any-specification))
    (:place-type (pick '(doorway convex concave beak "concave" nonsense)))
    (:receiving-part (pick '(:hand :bin)))
    ((:recipient :message) (pick '(:all keeper "helper" nobody (1 (2 at)) #(a #\b))))
    ((:number :speed :distance) (pick '(0 1 .3 .8 -1 5)))
    (:angle (pick '(0 1 -2 .1 3.2d0 1/2)))
    (:direction (pick '(:north east "South-West" :north-west nowhere)))
    ((:ticks :tick-span :duration :part-number) (pick '(0 1 2 5 20)))))

(defun senseless-argument ()
  (pick (list nil t 7 "seven" 'seven :seven -1d6 1d30 (expt 10 400)
              (part-of-any #'robot:robot-hands) (any-robot)
              (pick (world:world-thing-list world:*world*)) '(1 . 2) '((:size . 3)))))

(defun argument-for (spec)
  (if (luck .02)
      (senseless-argument)
      (sensible-argument (command:spec-type spec))))

(defmacro tolerating ((&rest conditions) &body body)
  "Run BODY; that it signals one of CONDITIONS is in order. Return NIL then."
  `(handler-case (progn ,@body t) (,(cons 'or conditions) () nil)))

;;; What the driver does.

(defun issue-command (name &rest arguments)
  "Issue the command NAME with ARGUMENTS, which may be wrong, and a continuation of the rider's."
  (multiple-value-bind (continuation call) (rider name)
    (if (tolerating (base:wrong-argument base:misuse base:unknown-name)
          (apply name (append arguments (list continuation))))
        (incf (ride-issued *ride*))
        (remhash call (ride-pending *ride*)))))

(defun command-at-random ()
  (let* ((all (or *commands-to-draw* (own-commands)))
         (command (pick (if (luck .2)
                            all
                            (remove :moving all :key #'command:command-family)))))
    (apply #'issue-command (command:command-name command)
           (argument-for (command:command-resource command))
           (mapcar #'argument-for (command:command-parameters command)))))

(defun follow-up (name results)
  "Go on in a sensible way after the command NAME, answered with RESULTS, such as to reach for
what has been seen."
  (destructuring-bind (code resource &optional designator &rest more) results
    (declare (ignore more))
    (when (and (null code) (robot:designator-p designator))
      (let ((hand (pick (coerce (robot:robot-hands (robot:designator-robot designator)) 'list))))
        (case name
          (command:camera-get-object-designator
           (issue-command 'command:camera-track resource designator))
          (command:camera-track
           (case (base:roll-index 4 (ride-dice *ride*))
             (0 (issue-command 'command:camera-insert resource designator))
             (1 (issue-command 'command:hand-insert hand designator))
             (t (issue-command 'command:hand-grasp-desig hand resource designator))))
          (command:hand-grasp-desig
           (issue-command 'command:hand-track resource)))))))

(defun manipulate-at-random ()
  (let ((name (pick '(open close switch-on lock))))
    (multiple-value-bind (continuation call) (rider name)
      (unless (tolerating (base:wrong-argument)
                (command:run-manipulation
                 name (any-designator)
                 (if (luck .9) (part-of-any #'robot:robot-hands) (any-robot))
                 (lambda (code value) (funcall continuation code nil value))))
        (remhash call (ride-pending *ride*))))))

(defun make-something ()
  "Make a thing beside where the robots start, perhaps a container."
  (flet ((between (low high) (base:roll-between low high (ride-dice *ride*))))
    (world:make-new-thing
     (pick '(ball box crate pin)) (list world:*world* (between 2.8 4.2) (between 2.8 4.2))
     `((:size ,(between .1 9)) (:weight ,(between 0 3)) (:capacity ,(if (luck .6) 8 0))
       (:color ,(pick '(red blue green)))))))

(defun populate ()
  "Make things if there are few, and give kickers to all that have none."
  (let ((world world:*world*))
    (loop while (< (world:world-live-count world) 14) do (make-something))
    (dolist (thing (world:world-thing-list world))
      (unless (world:thing-kickers thing)
        (dolist (kicker '(ride-hop ride-be-put-away ride-vanish ride-change))
          (world:set-kicker thing kicker))))))

(defun meddle ()
  "Change the world by hand."
  (let ((thing (pick (world:world-thing-list world:*world*))))
    (tolerating (base:misuse base:wrong-argument)
      (case (base:roll-index 10 (ride-dice *ride*))
        (0 (world:move-thing thing (part-of-any #'robot:robot-hands)))
        (9 (dolist (robot (zoo-robots))
             (loop for hand across (robot:robot-hands robot)
                   do (when (world:thing-p (robot:hand-location hand))
                        (world:move-thing (robot:hand-location hand) hand)))))
        (1 (world:move-thing thing (pick (world:world-thing-list world:*world*))))
        (2 (world:move-thing thing 3.5 3.5))
        (3 (dolist (thing (world:world-thing-list world:*world*))
             (when (luck .2) (world:move-thing thing 3.5 3.5))))
        (4 (time:grab-resource (part-of-any #'robot:robot-cameras)))
        (5 (time:grab-resource (part-of-any #'robot:robot-hands)))
        (6 (world:set-attribute thing :closed nil))
        (7 (world:set-attribute thing :obsmove (luck .1)))
        (8 (world:kick-thing thing .3 .3 t))))))

;;; What must hold.

(defun watched-p (hand)
  "True while a HAND-TRACK is under way on HAND."
  (let ((event (time:resource-event hand)))
    (and (command::operation-p event)
         (eq 'command:hand-track
             (command:command-name (command:operation-command event))))))

(defun robot-violations (robot)
  "Return what is wrong with ROBOT, a list of strings."
  (flet ((wrong (test control &rest arguments)
           (and test (list (apply #'format nil control arguments)))))
    (multiple-value-bind (x y) (robot:robot-position robot)
      (append
       (wrong (world:wall-at-p (world:world-map (robot:robot-world robot)) x y)
              "~A is in a wall at ~D, ~D" robot x y)
       (loop for camera across (robot:robot-cameras robot)
             for designator = (robot:camera-tracks camera)
             append (wrong (and designator (not (robot:designator-valid-p designator)))
                           "~A tracks ~A, which is invalid" camera designator)
             append (location-violations camera))
       (loop for hand across (robot:robot-hands robot)
             append (wrong (rest (robot:hand-contents hand)) "~A holds several things" hand)
             append (wrong (and (watched-p hand) (not (robot:hand-holding hand)))
                           "~A has lost its grip and nobody was told" hand)
             append (location-violations hand))
       (loop for bin across (robot:robot-bins robot)
             append (wrong (minusp (world:remaining-capacity bin)) "~A is too full" bin)
             append (wrong (and (robot:storage-bin-closed-p bin) (robot:part-in-bin bin))
                           "~A is closed on a part" bin))
       (loop for designator in (robot:live-designators robot)
             append (wrong (not (eq designator (robot:find-designator
                                                robot (robot:designator-number designator))))
                           "~A has the wrong number" designator))))))

(defun location-violations (part)
  "Return what is wrong with where PART is, a list of strings."
  (let ((location (robot:part-location part)) (robot (robot:part-robot part)))
    (cond ((null location) '())
          ((robot:storage-bin-p location)
           (unless (eq robot (robot:storage-bin-robot location))
             (list (format nil "~A is in another robot's bin" part))))
          ((not (world:thing-alive-p location))
           (list (format nil "~A is in something that has been destroyed" part)))
          (t (multiple-value-bind (x y) (world:thing-position location)
               (unless (and x (robot:within-reach-p robot x y))
                 (list (format nil "~A is in something out of reach" part))))))))

(defun watch-ride (simulation)
  "Note what is wrong in SIMULATION after a tick."
  (dolist (violation (append (world:world-invariant-violations
                              (run:simulation-world simulation))
                             (mapcan #'robot-violations
                                     (run:simulation-robots simulation))))
    (complain "tick ~D: ~A" (run:simulation-tick simulation) violation)))

;;; Driving.

(defun end-ride ()
  "Interrupt everything, and note what then has not been answered."
  (dotimes (i 2)
    (dolist (robot (zoo-robots))
      (time:grab-resource robot)
      (map nil #'time:grab-resource (robot:robot-cameras robot))
      (map nil #'time:grab-resource (robot:robot-hands robot))
      (map nil #'time:grab-resource (robot:robot-bins robot)))
    (ride-on (if (zerop i) 1 100)))
  (loop for (name) being the hash-keys of (ride-pending *ride*)
        do (complain "~A was not answered" name)))

(defun come-home (robot)
  "Put ROBOT into the cell with the things, or beside it if the other robot is there."
  (let* ((x (+ 3.1 (* .8 (base:roll (ride-dice *ride*)))))
         (taken-p (robot:occupant-text (robot:robot-world robot) x 3.5 robot)))
    (robot:place-robot robot (if taken-p (1- x) x) 3.5 1)))

(defun step-ride ()
  "Do one thing, and let some ticks pass, perhaps none."
  (cond ((luck .03) (come-home (any-robot)))
        ((luck .06) (meddle))
        ((luck .06) (manipulate-at-random))
        (t (command-at-random)))
  (when (luck .01) (populate))
  (ride-on (pick '(0 0 1 2 5 12))))

(defun drive (commands)
  "Issue COMMANDS commands at random, or until something is wrong."
  (run:add-observer #'watch-ride)
  (populate)
  (loop while (and (< (ride-issued *ride*) commands)
                   (null (ride-troubles *ride*)))
        do (step-ride)
           (base:take-messages))
  (setf (ride-over-p *ride*) t)
  (end-ride))

(defun drive-at-random (commands seed &key journal)
  "Issue COMMANDS commands at random in a fresh simulation. Return the ride; with JOURNAL, also
the journal and the digest of the state at its end."
  (run:with-simulation ((keeper helper) :seed seed :journal journal)
    (let ((*ride* (make-ride (base:make-dice seed "ride"))))
      (drive commands)
      (values *ride*
              (and journal (run:journal-up-to-now time:*simulation*))
              (run:state-digest)))))

(defun outcomes-of (rides family)
  "Return the lists (name code) of how commands of FAMILY have ended in RIDES."
  (flet ((family-of (name) (command:command-family (command:find-command name))))
    (remove-duplicates
     (loop for ride in rides
           append (loop for outcome being the hash-keys of (ride-outcomes ride)
                        when (and (get (first outcome) 'command::command)
                                  (eq family (family-of (first outcome))))
                          collect outcome))
     :test #'equal)))

(test random-driver.finds-nothing-wrong
  "50,000 commands; most of the error codes of handling come up."
  (let ((rides (loop for seed from 1 to 5 collect (drive-at-random 10000 seed))))
    (loop for ride in rides
          for seed from 1
          do (is (null (ride-troubles ride)) "seed ~D: ~{~A~^; ~}" seed
                 (last (ride-troubles ride) 5)))
    (let ((possible (loop for command in (own-commands)
                          when (eq :handling (command:command-family command))
                            sum (+ 2 (length (command:command-errors command))))))
      (is (< (* 2/3 possible) (length (outcomes-of rides :handling)))))))

(test random-driver.can-be-replayed
  "Stale designators, destroyed things, user code that fails, and all."
  (multiple-value-bind (ride journal digest) (drive-at-random 3000 6 :journal t)
    (is (null (ride-troubles ride)))
    (is (= digest (nth-value 1 (run:replay journal))))))
