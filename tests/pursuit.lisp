;;;; pursuit.lisp -- predators and prey: the simulator and a bare turn-based program agree.

(in-package :ars-magna.tests)

(in-suite robot-crowds)

;;; Four greedy predators hunt a prey that moves at random, on 30 x 30 cells. Each predator goes to
;;; its own side of the prey; the prey is caught when a predator or wall is on each side. The bare
;;; program knows cells only. In the simulator a round takes two ticks: one to turn, one to drive
;;; a cell. Both use the same draws, and in a tick robots move in the order of a hash of the seed,
;;; the tick and their full names.

(defconstant +field-size+ 30)
(defconstant +longest-pursuit+ 2000)

(world:define-map 'pursuit-field (+ 2 +field-size+) (+ 2 +field-size+)
  :clauses `((rect (0 0) (,(1+ +field-size+) ,(1+ +field-size+)) bricks 1)))

(robot:defrobot predator-1 (pursuit-field (2.5 2.5) 0))
(robot:defrobot predator-2 (pursuit-field (29.5 2.5) 0))
(robot:defrobot predator-3 (pursuit-field (29.5 29.5) 0))
(robot:defrobot predator-4 (pursuit-field (2.5 29.5) 0))
(robot:defrobot prey (pursuit-field (15.5 15.5) 0))

(defun start-cells ()
  (vector (cons 2 2) (cons 29 2) (cons 29 29) (cons 2 29) (cons 15 15)))

(defun cell-beside (cell direction)
  "Return the cell beside CELL in DIRECTION, in quarter turns from the x axis."
  (destructuring-bind (dx . dy) (svref #((1 . 0) (0 . 1) (-1 . 0) (0 . -1)) direction)
    (cons (+ (car cell) dx) (+ (cdr cell) dy))))

(defun field-cell-p (cell)
  (and (<= 1 (car cell) +field-size+) (<= 1 (cdr cell) +field-size+)))

(defun caught-p (cells)
  (let ((prey (svref cells 4)))
    (loop for direction below 4
          for cell = (cell-beside prey direction)
          always (or (not (field-cell-p cell)) (find cell cells :end 4 :test #'equal)))))

(defun chosen-direction (number cells draw)
  "Return the direction in which the robot with NUMBER wants to move, or NIL. The prey is number 4."
  (if (= number 4)
      (let ((direction (floor (* 5 draw)))) (and (< direction 4) direction))
      (let* ((own (svref cells number)) (goal (cell-beside (svref cells 4) number))
             (dx (- (car goal) (car own))) (dy (- (cdr goal) (cdr own))))
        (cond ((and (zerop dx) (zerop dy)) nil)
              ((or (zerop dy) (and (/= 0 dx) (< draw 1/2))) (if (plusp dx) 0 2))
              (t (if (plusp dy) 1 3))))))

(defun chosen-directions (cells dice)
  (coerce (loop for number below 5 collect (chosen-direction number cells (base:roll dice)))
          'simple-vector))

;;; The bare program.

(defun order-in-tick (seed tick)
  "Return the numbers of the robots in the order in which they act in TICK."
  (flet ((turn (number)
           (base:mixed-word
            (ldb (byte 62 0)
                 (base:text-hash (format nil "ARS-MAGNA.TESTS::~[PREDATOR-1~;PREDATOR-2~;~
                                              PREDATOR-3~;PREDATOR-4~;PREY~]" number)))
            (base:mixed-word seed tick))))
    (sort (list 0 1 2 3 4) #'< :key #'turn)))

(defun move-in-round (order cells directions)
  "Move the robots in ORDER by a cell in DIRECTIONS. A robot whose way is barred lets the other go
first if that has yet to move, and does not itself wait."
  (let ((left (copy-list order)))
    (labels ((move (number)
               (setf left (remove number left))
               (when (svref directions number)
                 (let ((goal (cell-beside (svref cells number) (svref directions number))))
                   (when (and (field-cell-p goal)
                              (let ((other (position goal cells :test #'equal)))
                                (when (member other left) (move other))
                                (not (find goal cells :test #'equal))))
                     (setf (svref cells number) goal))))))
      (loop while left do (move (first left))))))

(defun bare-pursuit (seed)
  "Return the round in which the prey is caught, or NIL; and the last cells."
  (let ((dice (base:make-dice seed "pursuit")) (cells (start-cells)))
    (values (loop for round from 1 to +longest-pursuit+
                  do (move-in-round (order-in-tick seed (+ 2 (* 2 round))) cells
                                    (chosen-directions cells dice))
                  when (caught-p cells) return round)
            cells)))

;;; The simulator.

(defun robot-cells (robots)
  (map 'simple-vector (lambda (robot)
                        (cons (floor (robot:robot-x robot)) (floor (robot:robot-y robot))))
       robots))

(defun drive-a-cell (robot)
  "Let ROBOT drive for a tick. Put it back into the middle of its cell if it is blocked: at the side
of a cell it would slip past corners."
  (command:robot-go-forward
   robot 1
   (lambda (code robot)
     (when code
       (multiple-value-bind (x y) (robot:robot-position robot)
         (robot:place-robot robot (+ .5d0 (floor x)) (+ .5d0 (floor y))
                            (robot:robot-angle robot)))))))

(defun drive-round (robots directions)
  "Let ROBOTS turn in DIRECTIONS, in one tick, and drive for a tick."
  (loop for robot in robots
        for direction across directions
        for angle = (geo:angle-difference (* (or direction 0) (/ pi 2)) (robot:robot-angle robot))
        do (when (and direction (> (abs angle) 1d-9)) (command:robot-turn robot angle)))
  (run:run-ticks 1)
  (loop for robot in robots
        for direction across directions
        do (when direction (drive-a-cell robot)))
  (run:run-ticks 1))

(defun simulated-pursuit (seed)
  "Return the round in which the prey is caught, or NIL; and the last cells."
  (run:with-simulation ((predator-1 predator-2 predator-3 predator-4 prey)
                        :seed seed :clean t
                        :parameters '((base:max-turn-angle* 4) (base:robot-turn-delay* 0)
                                      (base:robot-move-delay* 0)))
    (let ((dice (base:make-dice seed "pursuit"))
          (robots (list predator-1 predator-2 predator-3 predator-4 prey)))
      (dolist (robot robots)
        (command:robot-set-speed robot 1)
        (command:robot-set-turn-angle robot 4))
      (run:run-ticks 2)
      (values (loop for round from 1 to +longest-pursuit+
                    do (drive-round robots (chosen-directions (robot-cells robots) dice))
                       (base:take-messages)
                    when (caught-p (robot-cells robots)) return round)
              (robot-cells robots)))))

(defun pursuits-that-differ (seeds)
  "Return a list of those SEEDS for which the two programs differ, and the mean time of capture."
  (let ((times '()))
    (values (loop for seed in seeds
                  for bare = (multiple-value-list (bare-pursuit seed))
                  do (push (or (first bare) +longest-pursuit+) times)
                  unless (equalp bare (multiple-value-list (simulated-pursuit seed)))
                    collect seed)
            (/ (reduce #'+ times) (length times)))))

(test robot-crowds.pursuit-as-a-bare-program-has-it
  "Capture times and last positions are equal, seed by seed."
  (multiple-value-bind (wrong mean) (pursuits-that-differ (loop for seed from 1 to 20 collect seed))
    (is (null wrong) "seeds ~A" wrong)
    (is (< 10 mean +longest-pursuit+))))
