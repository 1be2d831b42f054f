;;;; manual-c.lisp -- The RPL interface: fluents and functions (manual appendix C).

(in-package :ars-test-manual-5)
(in-readtable :nisp)

(def-suite* manual-c :in ars-magna)

(defmap pantry (16 11)
  (rect (0 0) (15 10) bricks 5)
  (wall (8 1) (8 4) slate 20)
  (wall (8 6) (8 9) slate 20)
  (obj tub (4 5) ((:size 6) (:capacity 5) (:weight 1) (:color red)))
  (obj plum (4.5 5.5) ((:size .5) (:weight .5) (:color violet)))
  (obj ham (4.5 5.5) ((:size 3) (:weight 40) (:color lightred)))
  (obj jam (12 5) ((:size 1) (:color green)))
  (obj sack (4 8) ((:size 9) (:obsmove #t) (:color blue))))

(defrobot cook (pantry (4 5) 0)
  :cameras ((6.28 200) (1 3)) :hands (5 7 9) :bins (10 2))

(defrobot maid (pantry (12 8.5) 0) :hands (3))

(defmacro in-pantry ((&rest options) &body body)
  "Run BODY with COOK, ready for plans, in a fresh pantry without noise."
  `(with-simulation (cook :clean t ,@options)
     (rpl-init-robot cook)
     ,@body))

(defmacro planned (&body body)
  "Run BODY as a plan; return its value. It must succeed."
  `(multiple-value-bind (value state) (run-plan (interp-lambda () ,@body))
     (is (eq :succeeded state) "~A" value)
     value))

(defmacro told ((pulse error &rest more) call &body before)
  "Run in a fresh pantry the plan BEFORE, and then CALL. Return a list: whether PULSE, a fluent, was
pulsed, the value of the fluent ERROR, which was :STALE before, and the values of MORE, forms. CALL
may use IT, the value of BEFORE."
  `(in-pantry ()
     (planned
       (let ((heard nil) (it (seq ,@before)))
         (declare (ignorable it))
         (set-value ,error :stale)
         (par (setf heard (wait-for ,pulse :timeout 99))
              ,call)
         (list (and heard t) (fluent-value ,error) ,@more)))))

;;; What comes before.

(def-interp-proc spotted (color &optional (type :local))
  (rpl-camera-get-object-designator 0 type (list (list :color color)))
  (wait-for (vref camera-input* 0))
  (first (fluent-value (vref camera-designators* 0))))

(def-interp-proc tracked (color &optional (type :local))
  (let ((designator (spotted color type)))
    (rpl-camera-track 0 designator)
    (wait-for (vref camera-tracking* 0))
    designator))

(def-interp-proc grasped (color)
  (let ((designator (tracked color)))
    (rpl-hand-grasp-desig 0 0 designator)
    (wait-for (vref hand-moved* 0))
    designator))

;;; Beginning.

(test manual-c.rpl-init-robot-comes-first
  "C: it must be called before anything else, and says which robot all functions are about."
  (with-simulation ((cook maid))
    (signals misuse (rpl-robot-turn 1))
    (signals misuse (rpl-robot-num-hands))
    (rpl-init-robot cook)
    (is (= 3 (rpl-robot-num-hands)))
    (rpl-init-robot maid)
    (is (= 1 (rpl-robot-num-hands)))))

(test manual-c.fluent-vectors-have-one-fluent-for-each-part
  "C, reading 183: (vref fluent-vector i) is the fluent for part i, in the order of DEFROBOT; they
are made by RPL-INIT-ROBOT, all empty."
  (in-pantry ()
    (loop for (count . vectors)
            in `((2 ,camera-input* ,camera-views* ,camera-designators* ,camera-error* ,camera-moved*
                    ,camera-tracking* ,camera-tracking-error* ,camera-movement-error*)
                 (3 ,hand-moved* ,hand-error* ,hand-lost* ,hand-inside* ,hand-grasping*
                    ,hand-input*)
                 (2 ,storage-bin-moved* ,storage-bin-error* ,storage-bin-jammer*))
          do (dolist (vector vectors)
               (is (= count (length vector)))
               (is-true (every #'fluent-p vector))
               (is-false (some #'fluent-value vector))))
    (dolist (fluent (list robot-stopped* robot-movement-error* robot-angle-diff* robot-arrived-at*
                          robot-place-input* robot-place*))
      (is-true (fluent-p fluent)))))

(test manual-c.names-are-in-nisp
  "C: all functions are in the package NISP and begin with rpl-; the fluents are there, too."
  (dolist (name '("RPL-INIT-ROBOT" "RPL-ROBOT-TURN" "RPL-HAND-GRASP-DESIG" "RPL-GRAB-BIN"
                  "RPL-STORAGE-BIN-CLOSED?" "ROBOT-STOPPED*" "CAMERA-DESIGNATORS*" "HAND-INSIDE*"
                  "STORAGE-BIN-JAMMER*"))
    (is (eq :external (nth-value 1 (find-symbol name "NISP"))) "~A" name)
    (is-false (find-symbol name "ARS"))))

;;; Accessors.

(test manual-c.accessors-tell-how-the-robot-is-made
  "C: numbers of parts, speed and turn angle; optical parameters, angles and views of cameras;
strength of hands; capacities of bins. They return values, not fluents."
  (in-pantry ()
    (is (equal '(2 3 2) (list (rpl-robot-num-cameras) (rpl-robot-num-hands) (rpl-robot-num-bins))))
    (is (equal '(.8d0 .3d0) (list (rpl-robot-speed) (rpl-robot-turn-angle))))
    (is (equalp '(1 3 0 nil) (list (rpl-camera-field-of-view 1) (rpl-camera-resolution 1)
                                   (rpl-camera-angle 1) (rpl-camera-last-view 1))))
    (is (equalp '(5 7 9) (list (rpl-hand-strength 0) (rpl-hand-strength 1) (rpl-hand-strength 2))))
    (new-thing pea (robot-storage-bin cook 1) ((:size .5)))
    (is (equalp '(2 1.5 nil) (list (rpl-storage-bin-capacity 1) (rpl-storage-bin-real-capacity 1)
                                   (rpl-storage-bin-closed? 1))))
    (planned (rpl-storage-bin-close 1) (wait-for (vref storage-bin-moved* 1)))
    (is-true (rpl-storage-bin-closed? 1))))

(test manual-c.accessors-tell-how-the-robot-is-now
  "C: the current speed, turning angle, camera angle, and last view."
  (in-pantry ()
    (planned (rpl-robot-set-speed .5) (wait-time 2) (rpl-robot-set-turn-angle .1) (wait-time 2)
             (rpl-camera-turn 1 .25) (wait-for (vref camera-moved* 1))
             (rpl-camera-view 1) (wait-for (vref camera-input* 1)))
    (is (equalp (list .5 .1d0 .25) (list (rpl-robot-speed)
                                         (/ (round (rpl-robot-turn-angle) .001d0) 1000d0)
                                         (rpl-camera-angle 1))))
    (is (equal (rpl-camera-last-view 1) (fluent-value (vref camera-views* 1))))
    (is (= 3 (length (rpl-camera-last-view 1))))))

;;; The robot.

(test manual-c.speeds-are-set
  "C: error codes of the two commands are put into robot-movement-error*; success puts NIL there."
  (in-pantry ()
    (flet ((code (function value)
             (planned (set-value robot-movement-error* :stale)
                      (funcall function value) (wait-time 2)
                      (fluent-value robot-movement-error*))))
      (is (equal '(nil :too-high-speed :negative-speed)
                 (mapcar (lambda (speed) (code 'rpl-robot-set-speed speed)) '(.5 3 -1))))
      (is (equal '(nil :too-low-turn-angle :too-high-turn-angle)
                 (mapcar (lambda (angle) (code 'rpl-robot-set-turn-angle angle)) '(.2d0 0 3)))))))

(defmacro turned (call &body before)
  "Return the results of CALL, a turn: pulse, error and the estimated angle, rounded."
  `(let ((answer (told (robot-stopped* robot-movement-error* (fluent-value robot-angle-diff*))
                       ,call ,@before)))
     (list (first answer) (second answer)
           (and (third answer) (/ (round (third answer) .01) 100.0)))))

(test manual-c.turns
  "C: when a turn is completed robot-stopped* is pulsed, robot-movement-error* is the code, and
robot-angle-diff* the estimated angle turned."
  (is (equalp '(t nil 1.2) (turned (rpl-robot-turn 1.2))))
  (is (equalp '(t nil 3.14) (turned (rpl-robot-about-face))))
  (is (equalp '(t nil -1.57) (turned (rpl-robot-turn-left))))
  (is (equalp '(t nil 1.57) (turned (rpl-robot-turn-right))))
  (is (equalp '(t nil -.4) (turned (rpl-robot-align-place) (place-robot cook 8.5 5.5 .4))))
  (is (equalp '(t nil 1.57) (turned (rpl-robot-turn-corner) (place-robot cook 1.5 9.5 pi))))
  (is (equal '(t :no-place-type nil) (turned (rpl-robot-align-place))))
  (is (equal '(t :no-corner nil) (turned (rpl-robot-turn-corner)))))

(test manual-c.moves
  "C: when a movement is done robot-stopped* is pulsed, whether or not it succeeded, and
robot-movement-error* is the code."
  (macrolet ((ends (call &body before)
               `(told (robot-stopped* robot-movement-error*) ,call ,@before)))
    (is (equal '(t nil) (ends (rpl-robot-go-forward 2))))
    (is (equal '(t :robot-blocked) (ends (rpl-robot-go-forward 30))))
    (is (equal '(t nil) (ends (rpl-robot-goto-wall))))
    (is (equal '(t :robot-blocked) (ends (rpl-robot-goto-wall) (place-robot cook 4 5 (/ pi 2)))))
    (is (equal '(t nil) (ends (rpl-robot-follow-wall) (place-robot cook 1.5 4 (/ pi 2)))))
    (is (equal '(t :not-moving) (ends (rpl-robot-go-forward 2) (rpl-robot-set-speed 0)
                                      (wait-time 2))))
    (is (equal '(t nil) (ends (rpl-robot-stop))))
    (is (equal '(t :not-tracking) (ends (rpl-robot-goto-designator 0))))))

(test manual-c.arriving
  "C, reading 177: rpl-robot-goto-designator sets robot-arrived-at* to the designator arrived at,
before it pulses robot-stopped*."
  (in-pantry ()
    (destructuring-bind (there designator)
        (planned
          (place-robot cook 9.5 5.5 0)
          (let ((jam (tracked 'green :non-local)))
            (rpl-robot-goto-designator 0)
            (wait-for (and robot-stopped* robot-arrived-at*) :timeout 60)
            (list (fluent-value robot-arrived-at*) jam)))
      (is-true (designator-p there))
      (is (eq there designator)))
    (is (< (abs (- (robot-x cook) 12)) 1.5))))

(test manual-c.places
  "C: rpl-robot-place puts the place type into robot-place* and pulses robot-place-input*."
  (flet ((place (x y)
           (in-pantry ()
             (place-robot cook x y 0)
             (planned (rpl-robot-place) (wait-for robot-place-input*)
                      (fluent-value robot-place*)))))
    (is (equal '(doorway nil concave) (list (place 8.5 5.5) (place 4 5) (place 1 1.5))))))

;;; Cameras.

(test manual-c.cameras-turn
  "C: a turn pulses (vref camera-moved* c) and sets (vref camera-movement-error* c)."
  (macrolet ((ends (call &body before)
               `(told ((vref camera-moved* 1) (vref camera-movement-error* 1)
                       (round (rpl-camera-angle 1) .1))
                      ,call ,@before)))
    (is (equal '(t nil 5) (ends (rpl-camera-turn 1 .5))))
    (is (equal '(t nil 0) (ends (rpl-camera-align-robot 1)
                            (rpl-camera-turn 1 1) (wait-for (vref camera-moved* 1)))))
    (is (equal '(t nil -2) (ends (rpl-camera-align-place 1) (place-robot cook 8.5 5.5 .2))))
    (is (equal '(t :no-place-type 0) (ends (rpl-camera-align-place 1))))))

(test manual-c.views
  "C: rpl-camera-view puts the view into camera-views* and then pulses camera-input*."
  (is (equalp '(t nil (20 20 5))
              (told ((vref camera-input* 1) (vref camera-error* 1)
                     (fluent-value (vref camera-views* 1)))
                    (rpl-camera-view 1)
                (place-robot cook 5 4.5 0)))))

(defmacro searched (call &body before)
  "Return the results of CALL, a search by camera 0: pulse, error, and the number of designators."
  `(told ((vref camera-input* 0) (vref camera-error* 0)
          (length (fluent-value (vref camera-designators* 0))))
         ,call ,@before))

(test manual-c.searches-for-things
  "C, reading 178: camera-designators* is a list of what was found, camera-error* the code, then
camera-input* is pulsed. After a failure the list is empty."
  (is (equal '(t nil 1) (searched (rpl-camera-get-object-designator 0 :local '((:color violet))))))
  (is (equal '(t nil 3) (searched (rpl-camera-get-all-object-designators 0 :local '()))))
  (is (equal '(t :designator-not-found 0)
             (searched (rpl-camera-get-object-designator 0 :local '((:color lightblue)))
               (set-value (vref camera-designators* 0) '(1 2)))))
  (is (equal '(t :already-tracking 0)
             (searched (rpl-camera-get-all-object-designators 0 :local '()) (tracked 'violet)))))

(test manual-c.searches-for-places
  "C: so do the searches for places."
  (is (equal '(t nil 1) (searched (rpl-camera-get-place-designator 0 'doorway))))
  (is-true (< 1 (third (searched (rpl-camera-get-all-place-designators 0 'concave)))))
  (is (equal '(t :invalid-place-type 0) (searched (rpl-camera-get-place-designator 0 'door)))))

(test manual-c.tracks
  "C: camera-tracking* is pulsed when tracking starts; camera-tracking-error* is the code if it does
not, or when it ends (reading 83)."
  (is (equal '(t nil) (told ((vref camera-tracking* 0) (vref camera-tracking-error* 0))
                            (rpl-camera-track 0 it)
                        (spotted 'violet))))
  (is (equal '(nil :already-tracking)
             (told ((vref camera-tracking* 0) (vref camera-tracking-error* 0))
                   (rpl-camera-track 0 it)
               (tracked 'violet))))
  (in-pantry ()
    (is (equal '(nil :lost-track)
               (planned
                 (place-robot cook 9.5 5.5 0)
                 (tracked 'green :non-local)
                 (let ((before (fluent-value (vref camera-tracking-error* 0))))
                   (destroy-thing (find-thing 'jam))
                   (wait-for (vref camera-tracking-error* 0))
                   (list before (fluent-value (vref camera-tracking-error* 0)))))))))

(test manual-c.untracks
  "C: rpl-camera-untrack stops tracking; its own code is put into camera-tracking-error*."
  (in-pantry ()
    (flet ((code ()
             (planned (rpl-camera-untrack 0) (wait-time 2)
                      (fluent-value (vref camera-tracking-error* 0)))))
      (planned (tracked 'violet))
      (is (null (code)))
      (is (null (camera-tracks (robot-camera cook 0))))
      (is (eq :not-tracking (code))))))

(test manual-c.cameras-go-in-and-out
  "C, reading 181: insertion and removal pulse camera-moved* and set camera-movement-error*; the
destination is a designator, a bin or its index."
  (macrolet ((ends (call &body before)
               `(told ((vref camera-moved* 0) (vref camera-movement-error* 0)
                       (princ-to-string (camera-location (robot-camera cook 0))))
                      ,call ,@before)))
    (is (equal '(t nil "Storage-bin 1") (ends (rpl-camera-insert 0 1))))
    (is (equal '(t nil "Storage-bin 0") (ends (rpl-camera-insert 0 (robot-storage-bin cook 0)))))
    (is (equal '(t nil "NIL") (ends (rpl-camera-remove 0)
                                (rpl-camera-insert 0 1) (wait-for (vref camera-moved* 0)))))
    (is (equal '(t :not-inside "NIL") (ends (rpl-camera-remove 0))))
    (is (equal '(t nil "TUB#1") (ends (rpl-camera-insert 0 it) (tracked 'red))))
    (is (equal '(t :not-tracking "NIL") (ends (rpl-camera-insert 0 it) (spotted 'red))))))

;;; Hands.

(defmacro handled (call &body before)
  "Return the results of CALL, a movement of hand 0: pulse, error, container and thing grasped."
  `(told ((vref hand-moved* 0) (vref hand-error* 0)
          (princ-to-string (fluent-value (vref hand-inside* 0)))
          (princ-to-string (fluent-value (vref hand-grasping* 0))))
         ,call ,@before))

(test manual-c.hands-go-in-and-out
  "C, reading 180: insertion and removal pulse hand-moved* and set hand-error*; after success
hand-inside* is the bin or designator, until the hand is out again."
  (is (equal '(t nil "Storage-bin 0" "NIL") (handled (rpl-hand-insert-bin 0 0))))
  (is (equal '(t nil "Storage-bin 0" "NIL")
             (handled (rpl-hand-insert 0 (robot-storage-bin cook 0)))))
  (is (equal '(t nil "Designator 0" "NIL") (handled (rpl-hand-insert 0 it) (spotted 'red))))
  (is (equal '(t :bin-closed "NIL" "NIL")
             (handled (rpl-hand-insert-bin 0 0)
               (rpl-storage-bin-close 0) (wait-for (vref storage-bin-moved* 0)))))
  (is (equal '(t nil "NIL" "NIL")
             (handled (rpl-hand-remove 0)
               (rpl-hand-insert-bin 0 0) (wait-for (vref hand-moved* 0)))))
  (is (equal '(t :not-inside "NIL" "NIL") (handled (rpl-hand-remove 0)))))

(test manual-c.hands-grasp
  "C, reading 24: grasping pulses hand-moved* and sets hand-error*; after success hand-grasping* is
the designator, until it is let go."
  (is (equal '(t nil "NIL" "Designator 0")
             (handled (rpl-hand-grasp-desig 0 0 it) (tracked 'violet))))
  (is (equal '(t :insufficient-strength "NIL" "NIL")
             (handled (rpl-hand-grasp-desig 0 0 it) (tracked 'lightred))))
  (is (equal '(t nil "NIL" "NIL") (handled (rpl-hand-ungrasp 0) (grasped 'violet))))
  (is (equal '(t :not-grasping "NIL" "NIL") (handled (rpl-hand-ungrasp 0)))))

(test manual-c.grips-are-checked
  "C, reading 150: rpl-hand-grasp-check pulses hand-input* and puts its answer, :GRASPING or
:NOT-GRASPING, into hand-error*."
  (is (equal '(t :not-grasping) (told ((vref hand-input* 0) (vref hand-error* 0))
                                      (rpl-hand-grasp-check 0))))
  (is (equal '(t :grasping) (told ((vref hand-input* 0) (vref hand-error* 0))
                                  (rpl-hand-grasp-check 0)
                              (grasped 'violet)))))

(test manual-c.grips-are-watched
  "C, readings 23 and 180: while rpl-hand-track watches, a lost grasp pulses hand-lost*, sets
hand-error* to :GRASP-LOST, and hand-grasping* to NIL."
  (is (equal '(t :grasp-lost nil)
             (told ((vref hand-lost* 0) (vref hand-error* 0) (fluent-value (vref hand-grasping* 0)))
                   (seq (rpl-hand-track 0) (wait-time 3)
                        (kick-thing (find-thing 'plum) 1 0 nil))
               (grasped 'violet))))
  (is (equal '(nil :not-grasping) (told ((vref hand-lost* 0) (vref hand-error* 0))
                                        (rpl-hand-track 0)))))

;;; Bins.

(test manual-c.bins-open-and-close
  "C: opening and closing pulse storage-bin-moved* and set storage-bin-error*."
  (macrolet ((ends (call &body before)
               `(told ((vref storage-bin-moved* 1) (vref storage-bin-error* 1)
                       (rpl-storage-bin-closed? 1))
                      ,call ,@before)))
    (is (equal '(t nil t) (ends (rpl-storage-bin-close 1))))
    (is (equal '(t :bin-open nil) (ends (rpl-storage-bin-open 1))))
    (is (equal '(t nil nil) (ends (rpl-storage-bin-open 1)
                              (rpl-storage-bin-close 1) (wait-for (vref storage-bin-moved* 1)))))))

(test manual-c.bins-jammed-by-a-part
  "C, readings 163 and 182: if a robot part keeps the bin open, storage-bin-jammer* is that part."
  (is (equal '(t :robot-in-bin t)
             (told ((vref storage-bin-moved* 0) (vref storage-bin-error* 0)
                    (eq (robot-hand cook 0) (fluent-value (vref storage-bin-jammer* 0))))
                   (rpl-storage-bin-close 0)
               (rpl-hand-insert-bin 0 0) (wait-for (vref hand-moved* 0))))))
