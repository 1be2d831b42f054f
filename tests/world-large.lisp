;;;; world-large.lisp -- what large worlds store differently, or compute in advance.

(in-package :ars-magna.tests)
(in-suite world)

(defun crowd (world count dice &rest options)
  "Put COUNT things into the 25 cells nearest to the corner of WORLD."
  (dotimes (index count)
    (apply #'thing-in world 'box (base:roll-between 0 5 dice) (base:roll-between 0 5 dice) '()
           options)))

(defun things-by-cell (world)
  "Return a list of the things in each of the 25 cells nearest to the corner of WORLD."
  (loop for y from 0.5d0 below 5
        append (loop for x from 0.5d0 below 5 collect (world:things-at world x y))))

(test things.keep-their-order-when-others-are-destroyed
  (with-own-definitions
    (let ((world (open-world)) (dice (base:make-dice 3)))
      (crowd world 400 dice)
      (loop for thing = (base:roll-element (world:world-thing-list world) dice)
            for count from 399 downto 1
            do (world:move-thing thing (base:roll-between 0 5 dice) (base:roll-between 0 5 dice))
               (let ((expected (mapcar (lambda (things) (remove thing things))
                                       (things-by-cell world))))
                 (world:destroy-thing thing)
                 (unless (equal expected (things-by-cell world)) (fail "~D are left" count)))
               (when (zerop (mod count 40)) (is-sound world)))
      (is (= 1 (world:world-live-count world)))
      (is (>= 66 (world:world-rank-count world)) "ranks of the destroyed are given anew"))))

(defun foretold-kicks (things ticks scale dice)
  "Return the serial numbers of those of so many THINGS that are kicked in TICKS, drawn one by one.
Each third one rolls DICE once more."
  (let ((next (world::draw-gap scale dice)) (kicks '()))
    (dotimes (tick ticks (reverse kicks))
      (loop while (< next things)
            do (push (1+ next) kicks)
               (setf next (+ next 1 (world::draw-gap scale dice)))
               (when (zerop (mod (first kicks) 3)) (base:roll dice)))
      (decf next things))))

(test kicks.of-many-come-as-if-drawn-one-by-one
  "Also if kickers roll the dice from which what follows has been foreseen."
  (with-own-definitions
    (let* ((world (open-world)) (kicks '())
           (dice (base:copy-dice (world:world-dice world :kickers))))
      (world:define-kicker 'hop :prob .1
        :body (lambda (thing)
                (push (world:thing-serial thing) kicks)
                (world:kick-thing thing .1 0 t)
                (when (zerop (mod (first kicks) 3))
                  (base:roll (world:world-dice world :kickers)))))
      (crowd world 6000 (base:make-dice 3) :kickers '(hop))
      (run-without-messages world 4)
      (is (equal (foretold-kicks 6000 4 (world::group-scale
                                         (first (world::world-kicker-groups world)))
                                 dice)
                 (reverse kicks))))))

;;; Kickers that run at a later tick, by request.

(test run-kicker.runs-so-many-ticks-later
  (with-own-definitions
    (let* ((world (open-world)) (runs '()) (tick 0))
      (world:define-kicker 'note :prob 0
        :body (lambda (thing)
                (push (list tick (world:thing-name thing)) runs)
                (when (< tick 3) (world:run-kicker world:self 5))))
      (loop for (name ticks) in '((late 4) (moved 9) (soon 2))
            do (world:run-kicker (world:set-kicker (thing-in world name 1 1) 'note) ticks))
      (world:run-kicker (world:find-attachment (world:find-thing 'moved world) 'note) 4)
      (loop repeat 12 do (incf tick) (world:run-kickers world))
      (is (equal '((2 soon) (4 late) (4 moved) (7 soon)) (reverse runs)))
      (signals base:wrong-argument
        (world:run-kicker (world:find-attachment (world:find-thing 'soon world) 'note) 1/2)))))
