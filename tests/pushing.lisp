;;;; pushing.lisp -- pushing things from cell to cell.

(in-package :ars-magna.tests)

(def-suite* pushing :in ars-magna)

(world:defmap shoved (12 12) (rect (0 0) (11 11) bricks 10)
  (obj near (6.25 5.5) ((:obsmove t) (:weight 2)))
  (obj next (7.5 5.75) ((:obsmove t) (:weight 3)))
  (obj flat (7.5 5.5) ((:obsmove nil)))
  (obj north (5.5 4.5) ((:obsmove t) (:weight 101)))
  (obj door (5.5 7.5) ((:door t) (:closed t)))
  (obj south (5.5 6.5) ((:obsmove t) (:weight 1))))
(robot:defrobot pusher (shoved (5.5 5.5) 0))
(robot:defrobot bystander (shoved (7.5 5.5) 0))

(defun push-code (robot direction)
  "Let ROBOT push in DIRECTION. Return the error code, and how many ticks it took."
  (let ((code :none) (start (run:simulation-tick)))
    (command:robot-push robot direction (lambda (err robot) (declare (ignore robot))
                                          (setf code err)))
    (run:run-until (lambda () (not (eq code :none))) :limit 100)
    (values code (- (run:simulation-tick) start))))

(defun place-of (name)
  (let ((thing (world:find-thing name))) (list (world:thing-x thing) (world:thing-y thing))))

(test push.slides-a-row-one-cell-on-and-leaves-what-bars-no-movement
  (run:with-simulation (pusher :clean t)
    (is (equal '(nil 15) (multiple-value-list (push-code pusher 'east))))
    (is (equal '((7.25d0 5.5d0) (8.5d0 5.75d0) (7.5d0 5.5d0))
               (mapcar #'place-of '(near next flat))))
    (is (within-p 6.5 (robot:robot-x pusher)))
    (is (eq nil (push-code pusher 'east)))
    (is (eq nil (push-code pusher :east)))
    (is (equal '(10.5d0 5.75d0) (place-of 'next)))
    (is (eq :push-stuck (push-code pusher 'east)))
    (is (equal '(9.25d0 5.5d0) (place-of 'near)) "nothing moves if the row cannot")
    (is (within-p 8.5 (robot:robot-x pusher)))))

(test push.is-a-step-where-nothing-bars-the-way
  (run:with-simulation (pusher :clean t)
    (is (equal '(nil 15) (multiple-value-list (push-code pusher 'south-west))))
    (is (within-p 4.5 (robot:robot-x pusher)))
    (is (within-p 6.5 (robot:robot-y pusher)))
    (loop repeat 3 do (push-code pusher 'west))
    (is (eq :robot-blocked (push-code pusher 'west)) "a wall")))

(test push.has-strength
  (run:with-simulation (pusher :clean t)
    (is (eq :too-heavy (push-code pusher 'north)))
    (is (equal '(5.5d0 4.5d0) (place-of 'north)))
    (setf base:push-strength* 101)
    (is (eq nil (push-code pusher 'north)))
    (is (equal '(5.5d0 3.5d0) (place-of 'north))))
  (run:with-simulation (pusher :clean t :parameters '((base:push-strength* 4)))
    (is (eq :too-heavy (push-code pusher 'east)) "a row of 2 and 3")
    (world:move-thing (world:find-thing 'next) 9.5 9.5)
    (is (eq nil (push-code pusher 'east)))))

(test push.moves-no-doors-and-no-robots
  (run:with-simulation (pusher :clean t)
    (is (eq :push-stuck (push-code pusher 'south)))
    (world:move-thing (world:find-thing 'south) 9.5 9.5)
    (is (eq nil (push-code pusher 'south)))
    (is (eq :robot-blocked (push-code pusher 'south)))
    (is (equal '(5.5d0 7.5d0) (place-of 'door))))
  (run:with-simulation ((pusher bystander) :clean t)
    (is (eq :push-stuck (push-code pusher 'east)))
    (world:move-thing (world:find-thing 'near) 9.5 9.5)
    (is (eq nil (push-code pusher 'east)))
    (is (eq :robot-blocked (push-code pusher 'east)))))

(test push.is-forked-rewound-and-replayed-on-its-way
  (loop for tick in '(1 2 8 14)
        do (run:with-simulation (pusher :seed 5 :journal t :keep t)
             (command:robot-push pusher 'east)
             (run:run-ticks tick)
             (let ((fork (run:fork-simulation)))
               (run:run-ticks (- 20 tick))
               (run:run-ticks (- 20 tick) fork)
               (is (= (run:state-digest) (run:state-digest fork)))
               (is (= (run:state-digest) (replayed-digest)))
               (is (< 6.9 (first (place-of 'near)) 7.5))
               (let ((digest (run:state-digest)))
                 (run:rewind (- 20 tick))
                 (run:run-ticks (- 20 tick))
                 (is (= digest (run:state-digest))))))))
