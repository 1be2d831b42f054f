;;;; lisps-dice.lisp -- CL:RANDOM in users' code depends on the seed.

(in-package :ars-magna.tests)

(def-suite* lisps-dice :in ars-magna)

;;; A world in which a ball jumps and a robot dances, both as CL:RANDOM says.

(defvar *jumps* '() "What the kicker of the ball has rolled, newest first.")

(defun define-jumping-world ()
  (world:define-kicker 'jump
    :prob 3/10
    :body (lambda (ball)
            (push (random 1000) *jumps*)
            (world:kick-thing ball (- (random 1d0) 1/2) (- (random 1d0) 1/2) nil)))
  (eval '(world:defmap jumping-map (10 10)
          (rect (0 0) (10 10) wood 1)
          (obj (ball :kickers (jump)) (5 5) ())))
  (eval '(robot:defrobot jumping-robot (jumping-map (3 3) 0))))

(defmacro with-jumping ((&rest options) &body body)
  "Run BODY in the world in which the ball jumps."
  `(base:with-own-definitions ()
     (define-jumping-world)
     (let ((*jumps* '()))
       (run:call-with-simulation (lambda () ,@body) '(jumping-robot) ,@options))))

(defun the-dancer () (robot:find-robot 'jumping-robot))

(defun dance-on ()
  "Let the robot turn by chance, again and again."
  (command:robot-turn (the-dancer) (+ 1/10 (random 2d0))
                      (lambda (err &rest results)
                        (declare (ignore results))
                        (unless err (dance-on)))))

(defun after-ticks (ticks)
  "Pass TICKS. Return what decides how it goes on, and what the kicker has rolled in them."
  (let ((*jumps* '()))
    (run:run-ticks ticks)
    (list (run:state-digest) *jumps*)))

(defun what-comes (seed)
  (with-jumping (:seed seed)
    (dance-on)
    (list (random 1000) (after-ticks 60))))

(test random.goes-by-the-seed
  (let ((first (what-comes 4)))
    (is (< 5 (length (second (second first)))))
    (is (equal first (what-comes 4)))
    (is (equal first (let ((*random-state* (make-random-state t))) (what-comes 4))))
    (is (not (equal first (what-comes 5))))))

(defun numbers-of (state)
  "Return the next 2,000 numbers of the random state STATE, of some sorts."
  (loop repeat 500
        collect (random 1000 state)
        collect (random 1d0 state)
        collect (random 1.0 state)
        collect (random (expt 10 30) state)))

(test random.is-what-sbcl-says-for-the-seed
  "Seeding is put off until the first roll, which changes nothing; copies made before are alike."
  (dolist (seed '(0 1 -1 4 123456789012345678901234567890))
    (let* ((state (base:seeded-random-state seed))
           (copy (make-random-state state))
           (short (ldb (byte 32 0) (basics::mix-bits (ldb (byte 64 0) seed))))
           (numbers (numbers-of (sb-ext:seed-random-state short))))
      (is (equal numbers (numbers-of state)))
      (is (equal numbers (numbers-of copy)))
      (is (equal numbers (let ((*random-state* (make-random-state copy)))
                           (base:reseed-random-state seed)
                           (numbers-of *random-state*)))))))

(test random.says-something-else-in-each-tick
  (with-jumping (:seed 1)
    (let ((jumps (second (after-ticks 100))))
      (is (< 15 (length jumps)))
      (is (< (- (length jumps) 3) (length (remove-duplicates jumps)))))))

(test random.is-uniform-in-kickers
  "The first number of each tick, over many ticks."
  (with-jumping (:seed 2)
    (let ((jumps (second (after-ticks 6000))))
      (is (uniform-p (mapcar (lambda (jump) (/ jump 1000)) jumps) 0 1)))))

(test random.of-runs-side-by-side-does-not-mix
  (let* ((alone (with-jumping (:seed 4) (after-ticks 60)))
         (beside (with-jumping (:seed 4)
                   (let ((outer time:*simulation*) (all '()))
                     (run:call-with-simulation
                      (lambda ()
                        (loop repeat 60
                              do (run:run-ticks 3)
                                 (random 10)
                                 (let ((*jumps* '()))
                                   (run:run-ticks 1 outer)
                                   (setf all (append *jumps* all)))))
                      '(jumping-robot) :seed 9)
                     (list (run:state-digest outer) all)))))
    (is (equal alone beside))))

(test random.goes-on-in-forks-as-it-would-have
  (with-jumping (:seed 4)
    (dance-on)
    (run:run-ticks 20)
    (let ((fork (run:fork-simulation :continuations t))
          (seeded (loop repeat 2 collect (run:fork-simulation :seed 8 :continuations t)))
          (original (after-ticks 40)))
      (is (equal original (run:call-in-fork fork (lambda () (after-ticks 40)))))
      (destructuring-bind (one other)
          (loop for fork in seeded
                collect (run:call-in-fork fork (lambda () (after-ticks 40))))
        (is (equal one other))
        (is (not (equal original one)))))))

(test random.goes-on-after-a-rewind-as-it-did
  (with-jumping (:seed 4 :keep t)
    (run:run-ticks 20)
    (let ((once (after-ticks 40)))
      (run:rewind 40)
      (is (equal once (after-ticks 40))))))

(test random.is-repeated-by-replay-whatever-programs-rolled
  (with-jumping (:seed 4 :journal t)
    (dance-on)
    (run:run-ticks 30)
    (loop repeat 7 do (random 10))
    (let ((jumps (second (after-ticks 30)))
          (digest (run:state-digest))
          (*jumps* '()))
      (is (= digest (nth-value 1 (run:replay (end-journal time:*simulation*)))))
      (is (equal jumps (subseq *jumps* 0 (length jumps)))))))

(test random.goes-on-in-a-run-that-was-saved
  (uiop:with-temporary-file (:pathname file :type "saved")
    (with-jumping (:seed 4)
      (run:run-ticks 20)
      (run:save-simulation file)
      (let ((once (after-ticks 40)))
        (is (equal once (run:call-with-loaded-simulation (lambda () (after-ticks 40)) file)))))))
