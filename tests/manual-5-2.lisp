;;;; manual-5-2.lisp -- Robots (manual 5.2).

(in-package :ars-test-manual-5)
(in-readtable :nisp)

(def-suite* manual-5-2 :in ars-magna)

(defvar mast* 3)

(defmap quay (30 20)
  (rect (0 0) (29 19) stone 40)
  (obj bale (10 5) ((:size 2) (:weight 10)))
  (obj cask (10 5) ((:size 2) (:weight 10.01)))
  (obj coil (10 5) ((:size 4) (:weight 4))))

(defrobot docker (quay (10 5) (/ pi 4))
  :cameras (((/ pi 4) 3) ((/ pi 2) (+ 2 mast*)))
  :hands (10 4)
  :bins (20 mast*))

(defrobot clerk (quay (1.25 18.5) -9))

(test manual-5-2.defrobot-binds-its-name-to-a-robot
  "5.2: the name is a special variable whose value is the robot, of type ROBOT."
  (is-true (typep docker 'robot))
  (is (equal '(docker clerk) (list (robot-name docker) (robot-name clerk))))
  (is (eq docker (find-robot 'docker))))

(test manual-5-2.a-robot-is-found-though-its-variable-has-lost-it
  "5.2 (ours): where the variable holds something else, the name finds the robot that stands there."
  (let ((robot docker))
    (setf docker 5)
    (unwind-protect (is (eq robot (find-robot 'docker)))
      (setf docker robot))))

(test manual-5-2.robots-start-where-they-are-defined
  "5.2, readings 50 and 54: in the environment, at (x,y), heading ANG, all just as written:
positions are not moved to cells' centres, angles not reduced."
  (with-simulation (docker)
    (is (eq quay (world-map (robot-world docker))))
    (is (equalp (list 10 5 (/ pi 4))
                (list (robot-x docker) (robot-y docker) (robot-angle docker)))))
  (with-simulation (clerk)
    (is (equalp '(1.25 18.5 -9) (list (robot-x clerk) (robot-y clerk) (robot-angle clerk))))))

(test manual-5-2.cameras-are-a-field-of-view-and-a-resolution
  "5.2: each camera has its field of view, in radians, and so many view pixels, in the order
written."
  (is (equalp (list (/ pi 4) 3) (list (!_field-of-view (robot-camera docker 0))
                                      (camera-resolution (robot-camera docker 0)))))
  (with-simulation (docker :clean t)
    (is (equal '(3 5) (loop for index below 2
                            collect (length (third (call-once 'camera-view
                                                              (robot-camera docker index)))))))
    (is (near (/ pi 2) (camera-field-of-view (robot-camera docker 1))))))

(test manual-5-2.hands-are-strengths-and-bins-capacities
  "5.2: :hands (10 4) are two hands of these strengths, :bins two storage bins of these capacities."
  (is (equalp '(10 4) (list (hand-strength (robot-hand docker 0))
                            (hand-strength (robot-hand docker 1)))))
  (is (equalp '(20 3) (list (storage-bin-capacity (robot-storage-bin docker 0))
                            (storage-bin-capacity (robot-storage-bin docker 1))))))

(defun try-to-lift (hand name)
  "Grasp the thing called NAME by DOCKER's HAND; return the error code."
  (with-simulation (docker :clean t)
    (let ((camera (robot-camera docker 0)) (weight (get-attribute (find-thing name) :weight)))
      (camera-get-object-designator camera :local `((:weight ,weight .001))
        (continuation (err camera designator)
          (camera-track camera designator nil)))
      (run-ticks 10)
      (end-code 'hand-grasp-desig (robot-hand docker hand) camera (camera-tracks camera)))))

(test manual-5-2.hands-lift-up-to-their-strength
  "5.2: two hands, capable of picking up weights of 10 and 4 weight units, and no more."
  (is (equal '(nil :insufficient-strength) (list (try-to-lift 0 'bale) (try-to-lift 0 'cask))))
  (is (equal '(nil :insufficient-strength) (list (try-to-lift 1 'coil) (try-to-lift 1 'bale)))))

(test manual-5-2.capacities-are-size-units
  "5.2, reading 154: things in a bin reduce its free capacity by their size."
  (with-simulation (docker)
    (let ((bin (robot-storage-bin docker 0)))
      (new-thing jug bin ((:size 5) (:weight 90)))
      (is (= 15 (remaining-capacity bin)))
      (is (= 3 (remaining-capacity (robot-storage-bin docker 1)))))))

(test manual-5-2.parts-are-optional
  "5.2: a robot may be without cameras, hands and bins."
  (is (equal '(0 0 0) (list (length !>clerk.cameras) (length (robot-hands clerk))
                            (length (robot-bins clerk)))))
  (signals ars-magna-error (robot-camera clerk 0)))

(test manual-5-2.parts-are-numbered-from-0
  "5.2, C: indices are given by the order in DEFROBOT, starting at 0; there is none beyond."
  (is (equal '(0 1) (list (camera-index (robot-camera docker 0))
                          (hand-index (robot-hand docker 1)))))
  (is (eq (vref !>docker.cameras 1) (robot-camera docker 1)) "reading 216")
  (signals ars-magna-error (robot-hand docker 2))
  (signals ars-magna-error (robot-storage-bin docker -1)))

(test manual-5-2.robots-begin-ready
  "Readings 92 and 164: speed 0.8, turn angle 0.3, bins open, hands empty, cameras straight ahead."
  (with-simulation (docker)
    (is (equal '(.8d0 .3d0) (list (robot-speed docker) (robot-turn-angle docker))))
    (is (every #'null (loop for index below 2
                            append (list (storage-bin-closed-p (robot-storage-bin docker index))
                                         (hand-holding (robot-hand docker index))
                                         (camera-tracks (robot-camera docker index))))))
    (is (equalp '(0 0) (list (camera-angle (robot-camera docker 0))
                             (!_angle (robot-camera docker 1)))))))

(test manual-5-2.each-run-begins-with-the-robot-as-defined
  "5.2: a run does not depend on what the robot did in the one before."
  (flet ((shape () (list (robot-x docker) (robot-angle docker) (robot-speed docker)
                         (storage-bin-closed-p (robot-storage-bin docker 0)))))
    (let ((before (with-simulation (docker) (shape))))
      (with-simulation (docker :clean t)
        (is (null (end-code 'robot-set-speed docker .5)))
        (is (null (end-code 'robot-go-forward docker 3)))
        (is (null (end-code 'storage-bin-close (robot-storage-bin docker 0))))
        (is-false (equal before (shape))))
      (is (equal before (with-simulation (docker) (shape)))))))

(test manual-5-2.environments-are-maps-or-their-names
  "5.2, reading 61: the environment may be given as the map's variable, its name, or a form for it."
  (dolist (environment '(quay (find-map 'quay) 'quay))
    (is (null (first (complaints `(defrobot guest (,environment (3 3) 0)))))))
  (is-true (has-words-p (first (complaints '(defrobot guest (no-such-quay (3 3) 0)))) "map")))

(test manual-5-2.mistakes-are-told
  "5.2: a robot stands in its environment, outside of walls; its parts are numbers of the right
kind."
  (dolist (rest '(((quay (30 5) 0)) ((quay (5 -1) 0)) ((quay (0 5) 0)) ((quay 5 0)) ((quay (5 5)))
                  ((quay (5 5) 0) :cameras (3)) ((quay (5 5) 0) :cameras ((1 0)))
                  ((quay (5 5) 0) :cameras ((1 2.5))) ((quay (5 5) 0) :hands 10)
                  ((quay (5 5) 0) :hands (-1)) ((quay (5 5) 0) :bins (nil))
                  ((quay (5 5) 0) :wheels (4))))
    (is-true (first (complaints `(defrobot guest ,@rest))) "~S" rest)))

(test manual-5-2.robots-can-be-defined-anew
  "5.2: the variable holds the newest robot of its name; the old one takes no more commands."
  (eval '(defrobot guest (quay (3 3) 0)))
  (let ((old (symbol-value 'guest)))
    (eval '(defrobot guest (quay (4 4) 1) :hands (1)))
    (is-false (eq old (symbol-value 'guest)))
    (is (equalp '(4 1) (let ((new (symbol-value 'guest)))
                         (list (robot-x new) (length (robot-hands new))))))
    (signals misuse (robot-turn old 1))))
