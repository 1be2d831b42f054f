;;;; plans.lisp -- the shipped plans and programs reach their goals.

(in-package :ars-magna.tests)

(def-suite* plans :in ars-magna)

;;; Success is measured by the true state of the world, which plans cannot see.

(defun distance-from (x y thing)
  (multiple-value-bind (thing-x thing-y) (world:thing-position thing)
    (sqrt (+ (expt (- thing-x x) 2) (expt (- thing-y y) 2)))))

(defun brought-p (name x y)
  "True if the thing called NAME lies on the floor within three metres of (X,Y)."
  (let ((thing (world:find-thing name)))
    (and (eq :floor (world:thing-location thing))
         (< (distance-from x y thing) 3))))

(defparameter *office-errands*
  '((globe ((:color world:blue) (:substance world:plastic)) ((109 24)))
    (bucket ((:color world:blue) (:substance world:plastic)) ((108.5 66)))
    (glove-box ((:color world:lightgreen) (:substance world:plastic)) ((95 28)))
    (projector ((:color world:violet) (:substance world:metal)) ((86.5 53))))
  "Things in other rooms than MARVIN's, what they look like, and where to look from.")

(defun fetch-in-office (errand seed &key clean)
  "Let MARVIN fetch the thing of ERRAND. Return whether it did, the plan's value, and a digest."
  (destructuring-bind (name description places) errand
    (run:with-simulation (ars-worlds:marvin :seed seed :clean clean)
      (let ((value (driver:run-plan 'ars-worlds:fetch-thing description places)))
        (values (brought-p name 62 38) value (run:state-digest))))))

(test fetch.always-in-a-noiseless-world
  (dolist (errand *office-errands*)
    (loop for seed from 1 to 3
          do (multiple-value-bind (brought value) (fetch-in-office errand seed :clean t)
               (is-true brought "~A, seed ~D: ~A" (first errand) seed value)))))

(test fetch.across-doorways-in-the-default-office
  (dolist (errand *office-errands*)
    (loop for seed from 11 to 14
          do (multiple-value-bind (brought value) (fetch-in-office errand seed)
               (is-true brought "~A, seed ~D: ~A" (first errand) seed value)))))

(test fetch.is-decided-by-the-seed
  (flet ((digest (seed) (nth-value 2 (fetch-in-office (first *office-errands*) seed))))
    (is (= (digest 21) (digest 21)))
    (is (/= (digest 21) (digest 22)))))

(test fetch.by-other-robots
  (run:with-simulation (ars-worlds:robbie :seed 1)
    (driver:run-plan 'ars-worlds:fetch-thing
                     '((:color world:lightgreen) (:substance world:wood)) '((35.5 22.5)))
    (is-true (brought-p 'broom 10 5)))
  (run:with-simulation (ars-worlds:gofer :seed 1)
    (driver:run-plan 'ars-worlds:fetch-thing
                     '((:color world:blue) (:substance world:plastic)) '((108 66.5)))
    (is-true (brought-p 'bucket 15 24))))

(defun failure-class-of (plan &rest arguments)
  (let ((failure (with-messages (apply #'driver:run-plan plan arguments))))
    (and (typep failure 'rpl:plan-failure) (rpl:failure-class failure))))

(test fetch.says-why-it-failed
  (run:with-simulation (ars-worlds:dot :clean t)
    (is (eq :not-found (failure-class-of 'ars-worlds:fetch-thing '((:color world:violet))
                                         '((5.5 5.5))))))
  (run:with-simulation (ars-worlds:gofer :clean t)
    (is (eq :too-heavy (failure-class-of 'ars-worlds:fetch-thing
                                         '((:color world:red) (:substance world:metal))
                                         '((58 37.5))))))
  (run:with-simulation (ars-worlds:dot :clean t)
    (is (eq :nothing-inside (failure-class-of 'ars-worlds:put-thing-down 0 0 0)))
    (is (null (robot:part-location (robot:robot-camera ars-worlds:dot 0))))
    (is (null (robot:part-location (robot:robot-hand ars-worlds:dot 0))))))

;;; Steps.

(defun next-step-in-office (start goal)
  (ars-worlds:next-step (ars:make-chart 'office) start goal))

(test next-step.leads-to-a-doorway-and-through-it
  (is (equal '(:drive (94.5 37.0)) (next-step-in-office '(85 36.6) '(95 28))))
  (is (equal '(:door (94 34) (94.5d0 33.5d0)) (next-step-in-office '(94.4 36.8) '(95 28))))
  (is (equal '(:drive (95d0 28d0)) (next-step-in-office '(94.5 33.5) '(95 28)))))

(test next-step.there-is-none-without-a-way
  (is (null (next-step-in-office '(-50 3) '(95 28))))
  (let ((chart (ars:make-chart 'office)))
    (ars:bar-cell chart '(94 34))
    (ars:bar-cell chart '(84 24))
    (is (null (ars-worlds:next-step chart '(85 36.6) '(95 28))))))

;;; Reckoning.

(defun believed-error (me robot)
  "Return by how many metres the reckoning ME is wrong."
  (multiple-value-bind (x y) (robot:robot-position robot)
    (destructuring-bind (believed-x believed-y) (ars-worlds:reckon me)
      (sqrt (+ (expt (- x believed-x) 2) (expt (- y believed-y) 2))))))

(rpl:def-interp-proc travel-there (me points)
  (dolist (point points)
    (ars-worlds:travel-to me point)))

(test reckoning.stays-right-on-long-ways
  (loop for seed from 31 to 34
        do (run:with-simulation (ars-worlds:marvin :seed seed)
             (driver:rpl-init-robot ars-worlds:marvin)
             (let ((me (ars-worlds:begin-reckoning '(62 38 0))))
               (is (eq :succeeded (nth-value 1 (driver:run-plan 'travel-there me
                                                                '((108.5 24.5) (20 55) (62 38))))))
               (is (> 1.5 (believed-error me ars-worlds:marvin)))
               (multiple-value-bind (x y) (robot:robot-position ars-worlds:marvin)
                 (is (> 2.5 (sqrt (+ (expt (- x 62) 2) (expt (- y 38) 2))))))))))

(test reckoning.knows-nothing-of-the-truth
  (run:with-simulation (ars-worlds:dot :clean t)
    (driver:rpl-init-robot ars-worlds:dot)
    (let ((me (ars-worlds:begin-reckoning '(3.5 6.5 0))))
      (robot:place-robot ars-worlds:dot 9.5 2.5 1)
      (is (equal '(3.5d0 6.5d0) (ars-worlds:reckon me)))
      (command:robot-go-forward ars-worlds:dot 1)
      (run:run-ticks 10)
      (is (> .01 (abs (- 4.3 (first (ars-worlds:reckon me)))))))))

(test patrol.visits-what-can-be-reached
  (run:with-simulation (ars-worlds:robbie :seed 2)
    (is (= 6 (driver:run-plan 'ars-worlds:patrol-places '((23 10) (34 8) (6 22)) :rounds 2)))
    (multiple-value-bind (x y) (robot:robot-position ars-worlds:robbie)
      (is (> 2 (sqrt (+ (expt (- x 6) 2) (expt (- y 22) 2))))))))

;;; Tidying.

(world:defmap playroom (20 16)
  (rect (0 0) (20 16) plaster 10 20 30 20)
  (obj (table :prototype ars-worlds:table*) (10.5 8.5) ())
  (obj (ball :prototype ars-worlds:ball* :kickers (ars-worlds:roll-away)) (3.5 8.5) ())
  (obj (ball :prototype ars-worlds:ball* :kickers (ars-worlds:roll-away)) (16.5 4.5) ())
  (obj (book :prototype ars-worlds:book*) (5.5 3.5) ())
  (obj (book :prototype ars-worlds:book*) (15.5 11.5) ()))

(robot:defrobot nurse (playroom (10 4) 0)
  :cameras (((/ pi 2) 5)) :hands (10) :bins (20 10))

(defun bin-names (robot index)
  (mapcar #'world:thing-name (robot:storage-bin-contents (robot:robot-storage-bin robot index))))

(test tidy.stows-what-is-kicked-about
  (loop for seed from 1 to 3
        do (run:with-simulation (nurse :seed seed)
             (driver:run-plan 'ars-worlds:tidy-room
                              '(((:color world:red) (:substance world:plastic))
                                ((:color world:blue) (:substance world:paper)))
                              '((6 5) (14 10)))
             (is (equal '(ball ball) (bin-names nurse 0)) "seed ~D" seed)
             (is (equal '(book book) (bin-names nurse 1)) "seed ~D" seed))))

;;; The errand in the other style.

(defun run-errand-of (robot name description seed &key clean (camera 0) (limit 4000))
  "Return whether ROBOT stowed the thing called NAME, and the codes that its continuation got."
  (run:call-with-simulation
   (lambda ()
     (let* ((codes '()) (body (symbol-value robot)) (thing (world:find-thing name)))
       (ars-worlds:run-errand body description
                              (lambda (err robot) (declare (ignore robot)) (push err codes))
                              :camera camera)
       (run:run-until (lambda () codes) :limit limit)
       (run:run-ticks 50)
       (values (and (member thing (robot:storage-bin-contents (robot:robot-storage-bin body 0))) t)
               codes)))
   (list robot) :seed seed :clean clean))

(test errand.always-in-a-noiseless-world
  (loop for seed from 1 to 5
        do (multiple-value-bind (stowed codes)
               (run-errand-of 'ars-worlds:dot 'ball '((:color world:red)) seed :clean t)
             (is-true stowed)
             (is (equal '(nil) codes)))
           (is-true (run-errand-of 'ars-worlds:porter 'lamp
                                   '((:color world:lightred) (:substance world:metal))
                                   seed :clean t :camera 1))))

(test errand.nine-of-ten-with-noise
  (is (<= 9 (loop for seed from 1 to 10
                  count (run-errand-of 'ars-worlds:dot 'ball
                                       '((:color world:red) (:substance world:plastic)) seed))))
  (is (<= 9 (loop for seed from 1 to 10
                  count (run-errand-of 'ars-worlds:porter 'small-box
                                       '((:color world:lightblue) (:substance world:wood))
                                       seed :camera 1)))))

(test errand.gives-up-once
  (with-messages
    (is (equal '(:gave-up) (nth-value 1 (run-errand-of 'ars-worlds:dot 'ball
                                                       '((:color world:violet)) 1 :clean t))))))

(defun take-over (body continuation)
  "Let the robot BODY, or the part of it that carries out a command, do something else. True if
there is such."
  (let ((camera (robot:robot-camera body 0)) (hand (robot:robot-hand body 0)))
    (flet ((busy-p (part) (not (member (command:under-way part) '(nil command:camera-track)))))
      (cond ((busy-p body) (command:robot-turn body 1/2 continuation) t)
            ((busy-p camera) (command:camera-turn camera 1/10 continuation) t)
            ((busy-p hand) (command:hand-ungrasp hand continuation) t)))))

(defun errand-taken-over (moment seed)
  "Take over, at the tick MOMENT, what carries out a command of an errand. If there is such, return
what the errand's continuation has got three ticks later, and in the end, and what the continuation
of the other command has got."
  (let ((codes '()) (others '()))
    (run:with-simulation (ars-worlds:dot :seed seed)
      (ars-worlds:run-errand ars-worlds:dot '((:color world:red))
                             (lambda (err robot) (declare (ignore robot)) (push err codes)))
      (run:run-ticks moment)
      (when (and (null codes)
                 (take-over ars-worlds:dot (lambda (err &rest results)
                                             (declare (ignore results))
                                             (push err others))))
        (run:run-ticks 3)
        (let ((soon codes))
          (run:run-ticks 1000)
          (list soon codes others))))))

(test errand.gives-no-commands-after-an-interrupt
  (with-messages
    (let ((runs (loop for moment from 1 to 150
                      for run = (errand-taken-over moment (mod moment 7))
                      when run collect run)))
      (is (< 30 (length runs)) "~D" (length runs))
      (loop for (soon codes others) in runs
            do (is (equal '(:interrupt) soon))
               (is (equal '(:interrupt) codes))
               (is (= 1 (length others)))
               (is (not (member :interrupt others)))))))

(defun try-key (seed lock-id)
  "Run OPEN-WITH-KEY on a cabinet whose :lock-id is 4, with a key for LOCK-ID. Return a list of
whether the cabinet is closed, and the values of RUN-PLAN."
  (run:with-simulation (ars-worlds:dot :seed seed)
    (let ((cabinet (world:make-new-thing 'cabinet '(ars-worlds:tiny 5.5 2.5) '((:lock-id 4))
                                         :prototype ars-worlds:cabinet*)))
      (world:make-new-thing 'key '(ars-worlds:tiny 9.5 6.5)
                            `((:lock-id ,lock-id) (:color world:violet))
                            :prototype ars-worlds:key*)
      (multiple-value-bind (value state)
          (driver:run-plan 'ars-worlds:open-with-key
                           '((:color world:violet) (:substance world:metal))
                           '((:color world:blue) (:substance world:metal)))
        (list (world:thing-closed-p cabinet) value state)))))

(test open-with-key.opens-a-locked-cabinet
  (is (<= 9 (loop for seed below 10
                  count (destructuring-bind (closed value state) (try-key seed 4)
                          (declare (ignore value))
                          (is (eq closed (eq :failed state)))
                          (not closed))))))

(test open-with-key.fails-with-the-wrong-key
  (destructuring-bind (closed value state) (try-key 3 5)
    (is-true closed)
    (is (eq :failed state))
    (is (eq :will-not-do (rpl:failure-class value)))))
