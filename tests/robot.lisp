;;;; robot.lisp -- robots, their odometers and their simulations.

(in-package :ars-magna.tests)

(def-suite* robot :in ars-magna)

;;; A room with a wall that leaves a doorway, and a pillar that blocks.
(world:defmap arena (20 20)
  (rect (0 0) (19 19) bricks 1 4 8 12)
  (wall (10 1) (10 8) slate 20)
  (wall (10 10) (10 18) slate 20)
  (obj pillar (15.5 5.5) ((:obsmove t) (:size 9)))
  (obj crate (4.5 15.5) ((:size 6) (:capacity 5)) (coin ((:size 1) (:weight 1)))))

(robot:defrobot rover (arena (5.5 9.5) 0)
  :cameras (((/ pi 4) 3) ((/ pi 2) 5))
  :hands (10 4)
  :bins (20 5))

(defmacro with-rover ((&rest options) &body body)
  "Run BODY in a headless simulation with a fresh ROVER."
  `(run:with-simulation (rover ,@options) ,@body))

;;; Definition.

(test defrobot.makes-what-it-says
  (with-rover ()
    (is (equal '(5.5d0 9.5d0) (multiple-value-list (robot:robot-position rover))))
    (is (= 2 (length (robot:robot-cameras rover))))
    (is (= (/ pi 2) (robot:camera-field-of-view (robot:robot-camera rover 1))))
    (is (= 5 (robot:camera-resolution (robot:robot-camera rover 1))))
    (is (= 4 (robot:hand-strength (robot:robot-hand rover 1))))
    (is (= 20 (robot:storage-bin-capacity (robot:robot-storage-bin rover 0))))
    (is (= 0.8d0 (robot:robot-speed rover)))
    (is (= 0.3d0 (robot:robot-turn-angle rover)))
    (signals base:wrong-argument (robot:robot-camera rover 2))
    (signals base:wrong-argument (robot:robot-hand 'rover 0))
    (is (string= "Camera 1" (princ-to-string (robot:robot-camera rover 1))))
    (is (string= "Storage-bin 0" (princ-to-string (robot:robot-storage-bin rover 0))))))

(defun expands-badly-p (form)
  "True if FORM is refused as malformed when it is expanded or evaluated."
  (handler-case (progn (handler-bind ((warning #'muffle-warning)) (eval form)) nil)
    ((or base:malformed-definition base:unknown-name) (trouble)
      (plusp (length (princ-to-string trouble))))))

(test defrobot.refuses-what-makes-no-sense
  (dolist (form '((robot:defrobot bad (arena (0.5 0.5) 0))
                  (robot:defrobot bad (arena (5 5)))
                  (robot:defrobot bad (no-such-map (5 5) 0))
                  (robot:defrobot bad (arena (5 5) 0) :wheels (3))
                  (robot:defrobot bad (arena (5 5) 0) :cameras ((7 3)))
                  (robot:defrobot bad (arena (5 5) 0) :cameras (1))
                  (robot:defrobot bad (arena (5 5) 0) :hands (-1))
                  (robot:defrobot bad (arena (5 5) 0) :bins 3)
                  (robot:defrobot 7 (arena (5 5) 0))))
    (is-true (expands-badly-p form) "~S" form)))

;;; Odometers (manual 3.2.2).

(defun relative-position (x y origin-x origin-y heading)
  "Return (X,Y) in the frame of a robot at the origin with HEADING, as two values."
  (let ((dx (- x origin-x)) (dy (- y origin-y)) (c (cos heading)) (s (sin heading)))
    (values (+ (* dx c) (* dy s)) (- (* dy c) (* dx s)))))

(defun odometer-right-p (odometer robot origin-x origin-y heading)
  "True if ODOMETER, reset there, contains where ROBOT is."
  (multiple-value-bind (x y) (relative-position (robot:robot-x robot) (robot:robot-y robot)
                                                origin-x origin-y heading)
    (and (geo:in-interval (geo:make-pt x y)
                          (geo:grow-interval (robot:get-odometer-pos odometer) 1d-12))
         (geo:in-interval (- (robot:robot-angle robot) heading)
                          (geo:grow-interval (robot:get-odometer-ang odometer) 1d-12)))))

(defun wander (robot dice)
  "Let ROBOT drive about for ever, turning by rolls of DICE whenever a command ends."
  (labels ((next (&rest ignore)
             (declare (ignore ignore))
             (if (base:chance 1/2 dice)
                 (command:robot-turn robot (base:roll-within pi dice) #'next)
                 (command:robot-go-forward robot (base:roll-index 9 dice) #'next))))
    (next)))

(test odometer.always-contains-the-truth
  "Long random drives, from several resets, in noise and without."
  (dolist (clean '(nil t))
    (dotimes (seed 5)
      (with-rover (:seed seed :clean clean)
        (wander rover (base:make-dice seed :wander))
        (let ((main (robot:robot-main-odometer rover)) (late nil) (wrong 0) where)
          (loop for tick from 1 to 3000
                do (run:run-ticks 1)
                   (when (= tick 700)
                     (setf late (robot:make-odometer rover 'late)
                           where (list (robot:robot-x rover) (robot:robot-y rover)
                                       (robot:robot-angle rover))))
                   (unless (odometer-right-p main rover 5.5 9.5 0) (incf wrong))
                   (when late
                     (unless (apply #'odometer-right-p late rover where) (incf wrong))))
          (is (= 0 wrong) "seed ~D clean ~A" seed clean))))))

(test odometer.is-exact-in-a-clean-world
  (with-rover (:clean t)
    (command:robot-turn rover 1)
    (run:run-ticks 20)
    (command:robot-go-forward rover 3)
    (run:run-ticks 20)
    (let ((odometer (robot:robot-main-odometer rover)))
      (is (< (geo:interval-width (robot:get-odometer-ang odometer)) 1d-9))
      (is (< (geo:interval-width (robot:get-odometer-pos odometer)) 1d-9))
      (is (< (abs (- 1 (geo:nominal (robot:get-odometer-ang odometer)))) 1d-9))
      (is (< (abs (- 2.4 (geo:norm (geo:nominal (robot:get-odometer-pos odometer))))) 1d-6)))))

(test odometer.estimate-is-where-the-robot-is-in-a-clean-world
  "For displays: true after resets here and there; after POS it stays where the odometer counts."
  (with-rover (:clean t)
    (let ((main (robot:robot-main-odometer rover)))
      (flet ((off ()
               (multiple-value-bind (x y heading) (robot:odometer-estimate main)
                 (max (abs (- x (robot:robot-x rover))) (abs (- y (robot:robot-y rover)))
                      (abs (- heading (robot:robot-angle rover)))))))
        (loop repeat 3
              do (command:robot-turn rover 0.7)
                 (run:run-ticks 20)
                 (command:robot-go-forward rover 3)
                 (run:run-ticks 20)
                 (is (< (off) 1d-9))
                 (robot:reset-odometer main)
                 (is (< (off) 1d-9)))
        (robot:place-robot rover 3 3 0)
        (is (> (off) 1))))))

(test odometer.names-and-resets
  (with-rover ()
    (let ((first (robot:make-odometer rover 'home)))
      (is (eq first (robot:robot-odometer rover :home)))
      (is (null (robot:robot-odometer rover 'nowhere)))
      (let ((second (robot:make-odometer rover 'home)))
        (is (equal (list (robot:robot-main-odometer rover) second)
                   (robot:robot-odometers rover)))
        (command:robot-turn rover 1)
        (run:run-ticks 20)
        (command:robot-go-forward rover 2)
        (run:run-ticks 20)
        (flet ((far (odometer)
                 (list (plusp (geo:interval-max (robot:get-odometer-ang odometer)))
                       (plusp (geo:norm (geo:nominal (robot:get-odometer-pos odometer)))))))
          (is (equal '(nil nil) (far first)) "a replaced odometer stands still")
          (is (equal '(t t) (far second)))
          (is (equal '(t nil) (far (robot:reset-odometer-pos second))))
          (is (equal '(nil nil) (far (robot:reset-odometer-ang second))))
          (is (equal '(nil nil)
                     (far (robot:reset-odometer (robot:robot-main-odometer rover))))))))
    (signals base:wrong-argument (robot:reset-odometer rover))
    (signals base:wrong-argument (robot:make-odometer rover 5))))

(test odometer.reading-into-an-interval-conses-nothing
  (with-rover ()
    (let* ((odometer (robot:robot-main-odometer rover))
           (position (geo:make-pt-interval (geo:make-interval 0 1) (geo:make-interval 0 1)))
           (angle (geo:make-interval 0 1)))
      (is (eq position (robot:get-odometer-pos odometer position)))
      (is (eq angle (robot:get-odometer-ang odometer angle)))
      (let ((before (sb-ext:get-bytes-consed)))
        (dotimes (i 10000)
          (robot:get-odometer-pos odometer position)
          (robot:get-odometer-ang odometer angle))
        (is (< (- (sb-ext:get-bytes-consed) before) 100000))))))

;;; Motion.

(test motion.noise-is-uniform-about-the-speed
  "Distances in 20,000 ticks: bounds, mean and variance of the uniform law."
  (with-rover (:seed 11)
    (base:call-with-parameters
     '((motion-noise* 0.1))
     (lambda ()
       (let ((distances
               (loop repeat 20000
                     do (robot:set-robot-pose rover 5 9)
                        (robot:drive-tick rover)
                     collect (robot:robot-moved rover))))
         (is (every (lambda (d) (<= 0.72d0 d 0.88d0)) distances))
         (let* ((mean (/ (reduce #'+ distances) 20000))
                (variance (/ (loop for d in distances sum (expt (- d mean) 2)) 20000)))
           (is (< (abs (- mean 0.8d0)) 0.001d0))
           (is (< (abs (- variance (/ (expt 0.16d0 2) 12))) 5d-5))))))))

(test motion.turns-err-by-a-fraction
  (with-rover (:seed 12)
    (let ((turns (loop repeat 5000
                       for before = (robot:robot-angle rover)
                       do (robot:turn-tick rover -0.3d0)
                       collect (- before (robot:robot-angle rover)))))
      (is (every (lambda (turn) (<= 0.297d0 turn 0.303d0)) turns))
      (is (< (reduce #'min turns) 0.2975d0))
      (is (> (reduce #'max turns) 0.3025d0)))))

(test motion.never-passes-through-walls
  "However fast, a robot stays in open cells and is stopped short of what it meets."
  (let ((dice (base:make-dice 13)))
    (with-rover (:parameters '((max-speed* 60)))
      (let ((map (world:world-map (robot:robot-world rover))) (wrong 0))
        (dotimes (i 4000)
          (setf (robot:robot-speed rover) (base:roll-between 0 50 dice))
          (robot:set-robot-angle rover (base:roll-within pi dice))
          (let ((x (robot:robot-x rover)))
            (robot:drive-tick rover)
            (when (or (world:wall-at-p map (robot:robot-x rover) (robot:robot-y rover))
                      ;; From one side of the wall to the other only by the doorway.
                      (and (minusp (* (- x 10.5) (- (robot:robot-x rover) 10.5)))
                           (> (abs (- x (robot:robot-x rover))) 60)))
              (incf wrong))))
        (is (= 0 wrong))))))

(test motion.stops-just-short
  (with-rover (:clean t)
    (robot:set-robot-pose rover 5.5 9.5 (/ pi 2))
    (setf (robot:robot-speed rover) 1d0)
    (is (eq :wall (loop thereis (robot:drive-tick rover))))
    (is (< 18.99999 (robot:robot-y rover) 19))
    (robot:set-robot-pose rover 12.5 5.5 0)
    (is (eq :thing (loop thereis (robot:drive-tick rover))))
    (is (< 14.99999 (robot:robot-x rover) 15))
    (robot:set-robot-pose rover 15.5 5.5 0)
    (is (null (robot:drive-tick rover)) "its own cell never traps it")))

(test motion.goes-backwards-where-limits-are-negative
  "In 2,000 random steps back: as far as forwards, odometers tell truly, and walls stop it."
  (let ((dice (base:make-dice 14)) (wrong 0))
    (with-rover (:seed 14 :parameters '((motion-noise* 0.3)))
      (let ((odometer (robot:robot-main-odometer rover)))
        (dotimes (i 2000)
          (let ((angle (base:roll-within pi dice)) (limit (base:roll-between 0.01 2 dice)))
            (robot:set-robot-pose rover 5 9 angle)
            (robot:reset-odometer odometer)
            (robot:drive-tick rover (- limit))
            (unless (and (odometer-right-p odometer rover 5 9 angle)
                         (<= (* -1.3 (min limit 0.8)) (robot:robot-moved rover)
                             (* -0.7 (min limit 0.8))))
              (incf wrong))))))
    (is (= 0 wrong)))
  (with-rover (:clean t)
    (robot:set-robot-pose rover 5.5 9.5 (/ pi -2))
    (is (eq :wall (loop thereis (robot:drive-tick rover -1d0))))
    (is (< 18.99999 (robot:robot-y rover) 19))))

;;; Simulations.

(test with-simulation.is-fresh-each-time
  (let ((outside rover))
    (with-rover ()
      (is (not (eq rover outside)))
      (robot:place-robot rover 3 3 1)
      (world:destroy-thing (world:find-thing 'pillar)))
    (with-rover ()
      (is (= 5.5d0 (robot:robot-x rover)))
      (is-true (world:find-thing 'pillar)))
    (is (eq rover outside))
    (signals base:unknown-name (run:call-with-simulation (constantly nil) '(nobody)))))

(test with-simulation.binds-parameters
  (with-rover (:parameters '((braking* 9)))
    (is (= 9 base:braking*))
    (setf base:max-speed* 0.5))
  (is (= 2 base:braking*))
  (is (= 1 base:max-speed*))
  (with-rover (:clean t) (is-true base:no-sensor-error*))
  (is-false base:no-sensor-error*))

(test simulation.seed-decides-chance
  (flet ((digest (seed)
           (with-rover (:seed seed)
             (wander rover (base:make-dice 1))
             (run:run-ticks 500)
             (run:state-digest))))
    (is (= (digest 1) (digest 1)))
    (is (/= (digest 1) (digest 2)))))

(test simulation.set-seed-changes-the-rest
  (flet ((digest (again)
           (with-rover (:seed 1)
             (wander rover (base:make-dice 1))
             (run:run-ticks 100)
             (when again (run:set-seed again))
             (run:run-ticks 100)
             (run:state-digest))))
    (is (/= (digest nil) (digest 5)))
    (is (= (digest 5) (digest 5)))))

(world:defmap annex (8 8) (rect (0 0) (7 7) bricks 1))

(test resident-robots.can-be-changed-before-anything-runs
  "What is done first makes the simulation, whose journal then knows of it."
  (with-messages
    (dolist (change (list (lambda (robot) (robot:place-robot robot 3 3 1))
                          (lambda (robot) (robot:make-odometer robot 'early))
                          (lambda (robot)
                            (robot:reset-odometer (robot:robot-main-odometer robot)))))
      (setf (world::map-resident annex) nil)
      (let ((robot (robot:define-robot 'lodger 'annex '(2 2) 0)))
        (funcall change robot)
        (let ((simulation (run:robot-simulation robot)))
          (is (plusp (run:journal-length (run:simulation-journal simulation))))
          (robot:define-robot 'latecomer 'annex '(5 5) 0)
          (run:run-ticks 5 simulation)
          (is (= (run:state-digest simulation)
                 (nth-value 1 (run:replay (run:journal-up-to-now simulation))))))))))

(test place-robot.checks-and-keeps-odometers
  (with-rover ()
    (robot:place-robot rover 3 4 0.5)
    (is (equal '(3d0 4d0) (multiple-value-list (robot:robot-position rover))))
    (is (= 0 (geo:norm (geo:nominal (robot:get-odometer-pos
                                     (robot:robot-main-odometer rover))))))
    (signals base:wrong-argument (robot:place-robot rover 3 40 0))
    (signals base:wrong-argument (robot:place-robot rover 3 'x 0))))

;;; Places.

(test place-sensing.errs-as-its-parameters-say
  "Rates of missing and of imagining a place type, against binomial bounds (4 sigma)."
  (with-rover (:seed 14)
    (robot:set-robot-pose rover 10.5 9.5)
    (is (same-type-p 'world:doorway (world:place-type (robot:robot-place-here rover))))
    (let ((missed (loop repeat 10000 count (null (robot:sense-place-type rover)))))
      (is (< (abs (- missed 500)) 88)))
    (robot:set-robot-pose rover 5.5 5.5)
    (is (null (robot:robot-place-here rover)))
    (let ((imagined (loop repeat 10000 count (robot:sense-place-type rover))))
      (is (< (abs (- imagined 100)) 40)))
    (base:clean-simulation)
    (is-false (loop repeat 1000 thereis (robot:sense-place-type rover)))))

(defun same-type-p (name type)
  (base:same-name-p name (world:place-type-name type)))
