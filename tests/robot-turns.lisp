;;;; robot-turns.lisp -- in which order robots act within a tick, and whose dice they use.

(in-package :ars-magna.tests)

(in-suite robot-crowds)

(world:defmap turn-hall (120 9) (rect (0 0) (119 8) bricks 1 4 8 12) (wall (60 0) (60 3) bricks 4)
  (wall (60 5) (60 8) bricks 4))

(defun turn-names (count)
  (loop for number from 1 to count collect (intern (format nil "TURNER-~D" number)
                                                   :ars-magna.tests)))

(defun call-with-turners (function starts &key (seed 1) parameters)
  "Call FUNCTION with the robots, in order, of a run in which robot number N starts at the Nth of
STARTS, lists (x y angle). Their speed is 1."
  (base:with-own-definitions ()
    (let ((names (turn-names (length starts))))
      (loop for name in names
            for (x y angle) in starts
            do (robot:define-robot name 'turn-hall (list x y) angle))
      (run:with-simulation (names :seed seed :parameters parameters)
        (let ((robots (mapcar #'symbol-value names)))
          (dolist (robot robots) (command:robot-set-speed robot 1))
          (run:run-ticks 2)
          (funcall function robots))))))

(defmacro with-turners ((robots starts &rest options) &body body)
  `(call-with-turners (lambda (,robots) ,@body) ,starts ,@options))

(defparameter *still* '((base:motion-noise* 0) (base:robot-turn-max-error* 0)))

(defun go-all (robots ticks)
  "Let ROBOTS go forward for TICKS. Return the codes with which that ended, by robot."
  (let ((codes (make-list (length robots) :initial-element :none)))
    (loop for robot in robots
          for number from 0
          do (let ((number number))
               (command:robot-go-forward robot ticks
                                         (lambda (code &rest results)
                                           (declare (ignore results))
                                           (setf (nth number codes) code)))))
    (run:run-ticks (+ ticks 12))
    codes))

(defun robot-xs (robots) (mapcar #'robot:robot-x robots))

(test robot-turns.convoys-run
  "Robots one behind the other drive at the same speed, however many, also through a doorway."
  (dolist (count '(2 10 40))
    (dolist (speed '(1 3))
      (with-turners (robots (loop for number from 1 to count collect (list (+ number .5d0) 4.5d0 0))
                     :parameters (cons '(base:max-speed* 3) *still*))
        (dolist (robot robots) (command:robot-set-speed robot speed))
        (run:run-ticks 2)
        (is (equal (make-list count) (go-all robots 20)))
        (is (equal (loop for number from 1 to count collect (+ number .5d0 (* speed 20)))
                   (robot-xs robots)))))))

(test robot-turns.a-long-convoy-runs
  "Four hundred robots, each barred by the next."
  (base:with-own-definitions ()
    (handler-bind ((warning #'muffle-warning))
      (world:define-map 'long-hall 1100 3 :clauses '((rect (0 0) (1099 2) bricks 1))))
    (let ((names (turn-names 400)))
      (loop for name in names
            for number from 1
            do (robot:define-robot name 'long-hall (list (+ number .5d0) 1.5d0) 0))
      (run:with-simulation (names :seed 1 :parameters *still*)
        (let ((robots (mapcar #'symbol-value names)))
          (dolist (robot robots) (command:robot-set-speed robot 1))
          (run:run-ticks 2)
          (is (equal (make-list 400) (go-all robots 5)))
          (is (= 6.5d0 (robot:robot-x (first robots)))))))))

(test robot-turns.swaps-and-circles-are-blocked
  "Who would change places, or go round in a circle, is blocked."
  (let ((right 0) (down (/ pi 2)) (left pi) (up (- (/ pi 2))))
    (loop for starts in `(((5.5 4.5 ,right) (6.5 4.5 ,left))
                          ((5.5 4.5 ,right) (6.5 4.5 ,down) (6.5 5.5 ,left) (5.5 5.5 ,up)))
          do (loop for seed from 1 to 10
                   do (with-turners (robots starts :seed seed :parameters *still*)
                        (is (every (lambda (code) (eq code :robot-blocked)) (go-all robots 3)))
                        (loop for robot in robots
                              for (x y) in starts
                              do (is (= (floor x) (floor (robot:robot-x robot))))
                                 (is (= (floor y) (floor (robot:robot-y robot))))))))))

(test robot-turns.one-of-two-gets-the-cell
  "Of two robots that enter the same cell in a tick each comes first about as often."
  (let ((firsts 0))
    (loop for seed from 1 to 200
          do (with-turners (robots `((5.5 4.5 0) (7.5 4.5 ,pi)) :seed seed :parameters *still*)
               (let ((codes (go-all robots 1)))
                 (is (= 1 (count :robot-blocked codes)))
                 (unless (first codes) (incf firsts)))))
    ;; 200 fair coins lie within these bounds with a probability of 0.999.
    (is (<= 77 firsts 123))))

(test robot-turns.diagonal-ways-let-others-go-first
  "A robot that would pass a corner into a cell follows the robot that leaves it."
  (loop for seed from 1 to 10
        do (with-turners (robots `((5.5 4.5 ,(/ pi 4)) (6.5 5.5 ,(/ pi 4))) :seed seed
                          :parameters *still*)
             (is (equal '(nil nil) (go-all robots 1)))
             (is (= 6 (floor (robot:robot-x (first robots)))))
             (is (= 7 (floor (robot:robot-x (second robots))))))))

(defun noisy-ways (starts driving)
  "Return, for each robot of a run with robots at STARTS, where it is after each of 30 ticks and
what its odometer reads. The first DRIVING of them drive, with noise."
  (with-turners (robots starts :seed 7)
    (dolist (robot (subseq robots 0 driving)) (command:robot-go-forward robot 30))
    (let ((ways (make-list (length robots) :initial-element '())))
      (loop repeat 30
            do (run:run-ticks 1)
               (setf ways (loop for robot in robots
                                for way in ways
                                collect (cons (list (robot:robot-x robot)
                                                    (princ-to-string
                                                     (robot:get-odometer-pos
                                                      (robot:robot-main-odometer robot))))
                                              way))))
      ways)))

(test robot-turns.noise-belongs-to-the-robot
  "Another robot in the run, driving or not, changes nobody's noise."
  (let* ((starts '((3.5 2.5 0) (3.5 4.5 0) (3.5 6.5 0)))
         (way (first (noisy-ways (subseq starts 0 2) 1))))
    (is (< 10 (length (remove-duplicates way :test #'equal))))
    (loop for (count driving) in '((2 2) (3 1) (3 3))
          do (is (equal way (first (noisy-ways (subseq starts 0 count) driving)))))
    (destructuring-bind (one other third) (noisy-ways starts 3)
      (is (not (equal one other)))
      (is (not (equal other third))))))
