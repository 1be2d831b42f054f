;;;; manual-3-6.lisp -- carrying things: grasping, letting go, feeling (manual 3.6).

(in-package :ars-magna.tests)

(def-suite* manual-3-6 :in ars-magna)

;;; JOINER stands amid what it can reach; each thing says by :TAG what it is. A test in which chance
;;; has no part is clean.
(ars:defmap joinery (20 20)
  (rect (0 0) (19 19) bricks 10)
  (obj mallet (10.7 10.3) ((:size 2) (:weight 3) (:tag mallet)))
  (obj anvil (10.2 10.2) ((:size 4) (:weight 50) (:tag anvil)))
  (obj plank (10.5 10.9) ((:size 30) (:weight 1) (:tag plank)))
  (obj shaving (11 11) ((:size .5) (:tag shaving)))
  (obj toolbox (10.2 10.8) ((:size 9) (:capacity 6) (:weight 2) (:tag toolbox))
    (casket ((:size 3) (:capacity 2) (:weight 1) (:tag casket))
      (nail ((:size .1) (:weight .1) (:tag nail))))
    (chisel ((:size 1) (:weight .5) (:tag chisel))))
  (obj jar (10.9 10.9) ((:size 2) (:capacity 3) (:closed t) (:tag jar)))
  (obj crate (15.5 10.5) ((:size 8) (:capacity 7) (:tag crate))))

(ars:defrobot joiner (joinery (10.5 10.5) 0)
  :cameras (((/ pi 2) 5) ((/ pi 2) 5))
  :hands (10 4)
  :bins (20 5))

(defmacro with-joiner ((&rest options) &body body)
  "Run BODY in a headless simulation with a fresh JOINER."
  `(ars:with-simulation (joiner ,@options) ,@body))

(defun arm (index) (ars:robot-hand joiner index))
(defun lamp (index) (ars:robot-camera joiner index))
(defun drawer (index) (ars:robot-storage-bin joiner index))

(defun sight-tag (tag &key (type :local) (camera (lamp 0)))
  "Return the designator that CAMERA, tracking nothing, finds on what has TAG."
  (when (ars:camera-tracks camera) (reply 'ars:camera-untrack camera))
  (third (reply 'ars:camera-get-object-designator camera type `((:tag ,tag)))))

(defun point-out (tag &key (type :local) (camera (lamp 0)))
  "Track the thing with TAG by CAMERA, under the name :TRACK. Return the designator."
  (let ((designator (sight-tag tag :type type :camera camera)))
    (ars:camera-track camera designator (recorder :track))
    (ars:run-ticks 5)
    designator))

(defun take-tag (index tag)
  "Grasp the thing with TAG by hand INDEX. Return the error code."
  (code-of 'ars:hand-grasp-desig (arm index) (lamp 0) (point-out tag)))

(defun held (index)
  "Return the name of what hand INDEX holds."
  (let ((thing (ars:hand-holding (arm index))))
    (and thing (ars:thing-name thing))))

(defun send (location name)
  "Move the thing called NAME to LOCATION."
  (ars:move-thing (thing name) location))

(test manual-3-6.commands-are-those-of-the-headings
  "3.6, reading 156: each command has the arguments, results and error codes that its heading and
text list; inserting borrows three codes for what the text does not say, and removing one."
  (loop for (name . heading)
          in '((ars:hand-grasp-desig ("hand" "camera" "designator") ("designator")
                (:bad-designator :different-location :hand-grasping :insufficient-strength
                 :missed-grasp :non-local-grasp :not-tracked))
               (ars:hand-ungrasp ("hand") () (:not-grasping))
               (ars:hand-grasp-check ("hand") () (:grasping :not-grasping))
               (ars:hand-track ("hand") () (:grasp-lost :not-grasping))
               (ars:hand-insert ("hand" "destination") ("destination")
                (:bad-designator :bin-closed :different-location :hand-bump :holding-thing
                 :insufficient-capacity :non-local-designator))
               (ars:hand-insert-bin ("hand" "storage-bin") ("storage-bin")
                (:bin-closed :different-location :hand-bump :holding-thing :insufficient-capacity))
               (ars:hand-remove ("hand") () (:not-inside))
               (ars:storage-bin-open ("storage-bin") () (:bin-open))
               (ars:storage-bin-close ("storage-bin") ("jammed-part")
                (:bin-closed :bin-jammed :robot-in-bin)))
        do (is (equal heading (command-heading name)) "~A" name)))

(test manual-3-6.parts-are-numbered-from-0
  "3.6: hands and bins are ordered and got by their index; there is no other index."
  (with-joiner ()
    (is (equal '(10d0 4d0) (loop for i below 2 collect (ars:hand-strength (arm i)))))
    (is (equal '(20d0 5d0) (loop for i below 2 collect (ars:storage-bin-capacity (drawer i)))))
    (is (equal '(0 1) (loop for i below 2 collect (ars:hand-index (arm i)))))
    (dolist (index '(-1 2 1.0 nil))
      (signals ars:wrong-argument (arm index))
      (signals ars:wrong-argument (drawer index)))))

(test manual-3-6.at-first-hands-are-empty-and-bins-open
  "3.6, reading 164."
  (with-joiner ()
    (dotimes (i 2)
      (is (null (ars:hand-holding (arm i))))
      (is (null (ars:hand-location (arm i))))
      (is (null (ars:storage-bin-contents (drawer i))))
      (is-false (ars:storage-bin-closed-p (drawer i))))))

(test manual-3-6.actions-take-their-delays
  "3.6, chapter 4, readings 79, 149: moving a hand takes HAND-MOVE-DELAY*, grasping
HAND-GRASP-DELAY* more, a bin's lid BIN-DELAY*; what has no delay is done in the next tick."
  (loop for (move grasp bin) in '((2 4 2) (5 0 3))
        do (with-joiner (:clean t)
             (setf ars:hand-move-delay* move ars:hand-grasp-delay* grasp ars:bin-delay* bin)
             (loop for (ticks command . arguments)
                     in `((,(+ move grasp) ars:hand-grasp-desig ,(lamp 0) ,(point-out 'mallet))
                          (1 ars:hand-grasp-check) (,move ars:hand-insert-bin ,(drawer 0))
                          (1 ars:hand-ungrasp) (,move ars:hand-remove)
                          (,move ars:hand-insert ,(point-out 'toolbox)))
                   do (is (= ticks (apply #'ticks-of command (arm 0) arguments)) "~A" command))
             (is (= bin (ticks-of 'ars:storage-bin-close (drawer 0))))
             (is (= bin (ticks-of 'ars:storage-bin-open (drawer 0)))))))

;;; Grasping.

(test manual-3-6.grasp-takes-what-is-designated
  "3.6: the hand holds the thing from then on; hand and designator are returned."
  (with-joiner (:clean t)
    (let ((designator (point-out 'mallet)))
      (is (equal (list nil (arm 1) designator)
                 (reply 'ars:hand-grasp-desig (arm 1) (lamp 0) designator)))
      (is (eq 'mallet (held 1)))
      (is-true (ars:in-location (thing 'mallet) (arm 1)))
      (is (null (held 0))))))

(test manual-3-6.grasp-waits-for-the-track
  "3.6, first finding of the readings: a track asked for in the same breath has begun when the
hand grasps, 6 ticks from now, since CAMERA-DESIG-DELAY* is 4."
  (with-joiner (:clean t)
    (let ((designator (sight-tag 'mallet)))
      (ars:camera-track (lamp 0) designator)
      (is (null (code-of 'ars:hand-grasp-desig (arm 0) (lamp 0) designator))))))

(test manual-3-6.only-weight-counts
  "3.6, readings 122, 151: the hand must be strong enough for the weight, contents included; size
does not matter, and what has no weight weighs nothing."
  (with-joiner (:clean t)
    (is (eq :insufficient-strength (take-tag 0 'anvil)))
    (is (null (take-tag 1 'plank)))
    (is (null (take-tag 0 'shaving)))
    (code-of 'ars:hand-ungrasp (arm 1))
    (is (null (take-tag 1 'toolbox)) "2 with 1.6 in it, and the hand lifts 4")
    (code-of 'ars:hand-ungrasp (arm 1))
    (ars:set-attribute (thing 'nail) :weight .75)
    (is (eq :insufficient-strength (take-tag 1 'toolbox)))))

(test manual-3-6.strength-is-enough-for-its-own-weight
  "3.6: a hand of 4 lifts 4 and no more."
  (with-joiner (:clean t)
    (ars:set-attribute (thing 'mallet) :weight 4)
    (is (null (take-tag 1 'mallet)))
    (code-of 'ars:hand-ungrasp (arm 1))
    (ars:set-attribute (thing 'mallet) :weight 4.001)
    (is (eq :insufficient-strength (take-tag 1 'mallet)))))

(defun grasp-errors ()
  "Return a list of (code situation), where a situation is a function that returns camera and
designator for hand 0 to grasp by."
  (flet ((by-lamp-0 (designator) (list (lamp 0) designator)))
    `((:hand-grasping ,(lambda () (take-tag 0 'shaving) (by-lamp-0 (point-out 'mallet))))
      (:different-location ,(lambda ()
                              (prog1 (list (lamp 1) (point-out 'mallet))
                                (reply 'ars:camera-insert (lamp 1) (drawer 0)))))
      (:different-location ,(lambda ()
                              (reply 'ars:hand-insert-bin (arm 0) (drawer 0))
                              (by-lamp-0 (point-out 'mallet))))
      (:bad-designator ,(lambda ()
                          (prog1 (by-lamp-0 (point-out 'mallet))
                            (ars:destroy-thing (thing 'mallet))
                            (ars:run-ticks 1))))
      (:non-local-grasp ,(lambda () (by-lamp-0 (point-out 'crate :type :non-local))))
      (:not-tracked ,(lambda () (by-lamp-0 (sight-tag 'mallet))))
      (:not-tracked ,(lambda () (list (lamp 1) (point-out 'mallet))))
      (:missed-grasp ,(lambda () (setf ars:prob-miss-grasp* 1) (by-lamp-0 (point-out 'anvil))))
      (:insufficient-strength ,(lambda () (by-lamp-0 (point-out 'anvil)))))))

(test manual-3-6.grasp-signals-what-is-wrong
  "3.6: each error condition in a situation of its own; hand and designator are returned with it."
  (loop for (code situation) in (grasp-errors)
        do (with-joiner (:clean t)
             (destructuring-bind (camera designator) (funcall situation)
               (is (equal (list code (arm 0) designator)
                          (reply 'ars:hand-grasp-desig (arm 0) camera designator)))))))

(test manual-3-6.grasp-tests-in-the-printed-order
  "3.6, reading 164: of several errors the one printed first in the manual is reported: a full hand
in another place, with an invalid designator, and so on."
  (with-joiner (:clean t)
    (let ((invalid (sight-tag 'shaving)) (far (sight-tag 'crate :type :non-local)))
      (flet ((code (designator) (code-of 'ars:hand-grasp-desig (arm 0) (lamp 0) designator)))
        (ars:destroy-thing (thing 'shaving))
        (is (eq :non-local-grasp (code far)) "and not tracked")
        (is (eq :bad-designator (code invalid)) "and not tracked")
        (reply 'ars:hand-insert-bin (arm 0) (drawer 0))
        (is (eq :different-location (code invalid)))
        (send (arm 0) 'plank)
        (is (eq :hand-grasping (code invalid)))))))

(test manual-3-6.a-miss-comes-before-weakness
  "3.6, reading 164: a hand that misses does not feel the weight."
  (with-joiner (:clean t :parameters '((ars:prob-miss-grasp* 1)))
    (setf ars:prob-miss-grasp* 1)
    (is (eq :missed-grasp (take-tag 0 'anvil)))))

(test manual-3-6.what-is-not-there-cannot-be-grasped
  "3.6, reading 137: grasping by a false designator misses."
  (with-joiner (:seed 2 :parameters '((ars:false-thing-prob* 1) (ars:prob-lose-false-track* 0)
                                      (ars:prob-grasp-lose-desig* 0)))
    (is (eq :missed-grasp (take-tag 0 'nothing)))
    (is (null (held 0)))))

(test manual-3-6.what-has-gone-meanwhile-is-missed
  "3.6, reading 78: what counts is where the thing is when the hand gets there."
  (with-joiner (:clean t)
    (let ((designator (point-out 'mallet)) (*answers* '()))
      (ars:hand-grasp-desig (arm 0) (lamp 0) designator (recorder :grasp))
      (ars:run-ticks 5)
      (send '(15.5 15.5) 'mallet)
      (ars:run-ticks 1)
      (is (equal (list (list :missed-grasp (arm 0) designator)) (answers-to :grasp)))
      (is (null (held 0))))))

(test manual-3-6.grasping-may-lose-designators-silently
  "3.6, reading 165: bumping the thing loses its designators, after success or failure, without a
message; their tracks end."
  (dolist (tag '(mallet anvil))
    (with-joiner (:clean t)
      (setf ars:prob-grasp-lose-desig* 1)
      (let* ((*answers* '())
             (other (sight-tag tag :camera (lamp 1)))
             (designator (point-out tag)))
        (texts)
        (reply 'ars:hand-grasp-desig (arm 0) (lamp 0) designator)
        (is-false (ars:designator-valid-p designator))
        (is-false (ars:designator-valid-p other))
        (is (= 1 (count #\Newline (texts))) "only what the grasp itself says")
        (is (equal (list (list nil (lamp 0) designator) (list :lost-track (lamp 0) designator))
                   (answers-to :track)))))))

(test manual-3-6.grasping-need-not-lose-designators
  "3.6: where nothing is bumped the camera tracks the thing into the hand."
  (with-joiner (:clean t)
    (let ((designator (point-out 'mallet)))
      (reply 'ars:hand-grasp-desig (arm 0) (lamp 0) designator)
      (is-true (ars:designator-valid-p designator))
      (is (eq designator (ars:camera-tracks (lamp 0)))))))

(test manual-3-6.one-hand-may-take-from-the-other
  "3.6, reading 231: the other hand loses its grip, and its track ends with :GRASP-LOST."
  (with-joiner (:clean t)
    (is (null (take-tag 0 'mallet)))
    (let ((*answers* '()))
      (ars:hand-track (arm 0) (recorder :grip))
      (is (null (take-tag 1 'mallet)))
      (is (equal '(nil mallet) (list (held 0) (held 1))))
      (is (equal (list (list :grasp-lost (arm 0))) (answers-to :grip))))))

;;; Letting go.

(test manual-3-6.ungrasp-drops-where-the-robot-stands
  "3.6, reading 152: in the open the thing falls at the robot's position, whole coordinates or
odd."
  (with-joiner (:clean t)
    (loop for (x y) in '((10.5 10.5) (7 4) (3.37 16.81))
          do (send (arm 0) 'mallet)
             (ars:place-robot joiner x y 1)
             (is (equal (list nil (arm 0)) (reply 'ars:hand-ungrasp (arm 0))))
             (is (eq :floor (ars:thing-location (thing 'mallet))))
             (is (equal (multiple-value-list (ars:robot-position joiner))
                        (multiple-value-list (ars:thing-position (thing 'mallet))))))
    (is (eq :not-grasping (code-of 'ars:hand-ungrasp (arm 0))))
    (is (equal (list :not-grasping (arm 1)) (reply 'ars:hand-ungrasp (arm 1))))))

(test manual-3-6.ungrasp-drops-into-what-the-hand-is-in
  "3.6: into a bin or container, if the hand is inside of that."
  (with-joiner (:clean t)
    (loop for (destination container) in `((,(drawer 0) ,(drawer 0))
                                           (,(sight-tag 'toolbox) ,(thing 'toolbox)))
          do (send (arm 0) 'mallet)
             (is (null (code-of 'ars:hand-insert (arm 0) destination)))
             (is (null (code-of 'ars:hand-ungrasp (arm 0))))
             (is-true (ars:in-location (thing 'mallet) container))
             (is (null (code-of 'ars:hand-remove (arm 0)))))))

(test manual-3-6.ungrasp-leaves-designators-alone
  "3.6, reading 165: the designator stays and is tracked on, so that the thing can be followed."
  (with-joiner (:clean t)
    (let ((designator (point-out 'mallet)))
      (reply 'ars:hand-grasp-desig (arm 0) (lamp 0) designator)
      (reply 'ars:hand-ungrasp (arm 0))
      (is (eq designator (ars:camera-tracks (lamp 0))))
      (is (null (code-of 'ars:hand-grasp-desig (arm 0) (lamp 0) designator))
          "it can be grasped again by it"))))

(test manual-3-6.what-is-carried-comes-along
  "3.6: things in hands and bins move with the robot."
  (with-joiner (:clean t)
    (send (arm 0) 'mallet)
    (send (drawer 1) 'shaving)
    (reply 'ars:robot-go-forward joiner 5)
    (dolist (name '(mallet shaving))
      (multiple-value-bind (x y) (ars:thing-position (thing name))
        (is (near 14.5 x))
        (is (near 10.5 y))))))

;;; Feeling.

(test manual-3-6.grasp-check-answers-by-its-code
  "3.6, reading 150: :GRASPING or :NOT-GRASPING, never NIL; only an interruption says something
else. Its message is no error."
  (with-joiner (:clean t)
    (is (equal (list :not-grasping (arm 0)) (reply 'ars:hand-grasp-check (arm 0))))
    (send (arm 0) 'mallet)
    (texts)
    (is (equal (list :grasping (arm 0)) (reply 'ars:hand-grasp-check (arm 0))))
    (is (string= (format nil "hand-grasp-check: Hand 0 is holding something~%") (texts)))
    (let ((*answers* '()))
      (ars:hand-grasp-check (arm 0) (recorder :check))
      (ars:grab-resource (arm 0))
      (ars:run-ticks 1)
      (is (equal (list (list :interrupt (arm 0))) (answers-to :check))))))

(test manual-3-6.hand-track-tells-of-a-lost-grip
  "3.6, reading 83: it says nothing until the grip is lost, in that very tick, and then
:GRASP-LOST."
  (loop for theft in (list (lambda () (ars:kick-thing (thing 'mallet) 2 1 t))
                           (lambda () (send (drawer 0) 'mallet))
                           (lambda () (ars:destroy-thing (thing 'mallet))))
        do (with-joiner (:clean t)
             (let ((*answers* '()))
               (send (arm 0) 'mallet)
               (ars:hand-track (arm 0) (recorder :grip))
               (ars:schedule (:thief :timer 300) (funcall theft))
               (ars:run-ticks 299)
               (is (null *answers*))
               (ars:run-ticks 1)
               (is (equal (list (list :grasp-lost (arm 0))) (answers-to :grip)))))))

(test manual-3-6.hands-do-not-lose-their-grip-by-themselves
  "3.6, reading 162: not by noise, however far the robot carries the thing."
  (with-joiner (:seed 6)
    (let ((*answers* '()))
      (send (arm 0) 'mallet)
      (ars:hand-track (arm 0) (recorder :grip))
      (loop repeat 40 do (reply 'ars:robot-go-forward joiner 3) (reply 'ars:robot-turn-left joiner))
      (is (null (answers-to :grip)))
      (is (eq 'mallet (held 0))))))

(test manual-3-6.hand-track-needs-a-grip
  "3.6: if the hand is empty to start with, :NOT-GRASPING."
  (with-joiner ()
    (is (equal (list :not-grasping (arm 1)) (reply 'ars:hand-track (arm 1))))))
