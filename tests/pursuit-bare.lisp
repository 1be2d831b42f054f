;;;; pursuit-bare.lisp -- the testbed of pursuit without the simulator: for comparison.

(in-package :ars-magna.tests)

;;; The rules of worlds/testbeds/pursuit, played on cells alone: pairs (x . y), from 1
;;; to 20. Cells and moves are lists, those of the predators, then that of the prey. Moves are
;;; pairs, too. Probabilities are rational, so that equal payoffs are equal.

(defparameter *bare-moves* '((0 . 0) (1 . 0) (0 . 1) (-1 . 0) (0 . -1)))

(defparameter *bare-rules* '(:weight 1 :metric :steps :diagonal :both :stays nil :ties :random)
  "The knobs of the bare program.")

(defun bare-rule (name) (getf *bare-rules* name))

(defun bare-goal (cell move)
  (let ((x (+ (car cell) (car move))) (y (+ (cdr cell) (cdr move))))
    (if (and (<= 1 x 20) (<= 1 y 20)) (cons x y) cell)))

(defun bare-way-free-p (number cells goals path)
  "True if the robot with NUMBER gets to its goal. PATH lists those that wait for it to leave."
  (let* ((goal (elt goals number)) (occupant (position goal cells :test #'equal)))
    (and (not (eql occupant number))
         (= 1 (count goal goals :test #'equal))
         (or (null occupant)
             (and (not (member occupant path))
                  (bare-way-free-p occupant cells goals (cons number path)))))))

(defun bare-moved (cells moves)
  "Return the cells after all robots have made their MOVES at once."
  (let ((goals (mapcar #'bare-goal cells moves)))
    (loop for cell in cells
          for goal in goals
          for number from 0
          collect (if (bare-way-free-p number cells goals (list number)) goal cell))))

(defun bare-steps (from to)
  (let ((dx (abs (- (car from) (car to)))) (dy (abs (- (cdr from) (cdr to)))))
    (if (eq :king (bare-rule :metric)) (max dx dy) (+ dx dy))))

(defun bare-quadrants (cells)
  (let ((target (first (last cells))))
    (loop for (dx . dy) in (rest *bare-moves*)
          count (loop for cell in (butlast cells)
                      for ahead = (+ (* dx (- (car cell) (car target)))
                                     (* dy (- (cdr cell) (cdr target))))
                      for aside = (abs (+ (* dy (- (car cell) (car target)))
                                          (* dx (- (cdr cell) (cdr target)))))
                      thereis (and (plusp ahead)
                                   (if (eq :both (bare-rule :diagonal))
                                       (<= aside ahead)
                                       (< aside ahead)))))))

(defun bare-payoff (number cells moves)
  (let ((after (bare-moved cells moves)))
    (flet ((left (cells) (bare-steps (elt cells number) (first (last cells)))))
      (+ (- (left cells) (left after)) (* (bare-rule :weight) (bare-quadrants after))))))

(defun bare-expectation (number cells mixes &optional (moves '()))
  "Return the mean payoff of the predator with NUMBER if robot I has the mix I of MIXES. MOVES are
those of the last robots."
  (let ((left (- (length cells) (length moves))))
    (if (zerop left)
        (bare-payoff number cells moves)
        (loop for move in *bare-moves*
              for share in (elt mixes (1- left))
              unless (zerop share)
                sum (* share (bare-expectation number cells mixes (cons move moves)))))))

(defun bare-best (payoffs)
  (let* ((best (reduce #'max payoffs)) (share (/ (count best payoffs))))
    (if (eq :first (bare-rule :ties))
        (loop for number below 5
              collect (if (= number (position best payoffs)) 1 0))
        (loop for payoff in payoffs collect (if (= best payoff) share 0)))))

(defun bare-prey-mix ()
  (if (bare-rule :stays) '(1/5 1/5 1/5 1/5 1/5) '(0 1/4 1/4 1/4 1/4)))

(defun bare-mixes (cells level)
  "Return what each predator does at LEVEL."
  (let ((count (1- (length cells))))
    (if (zerop level)
        (make-list count :initial-element '(1/5 1/5 1/5 1/5 1/5))
        (let ((mixes (append (bare-mixes cells (1- level)) (list (bare-prey-mix)))))
          (loop for i below count
                collect (bare-best
                         (loop for move in '((1 0 0 0 0) (0 1 0 0 0) (0 0 1 0 0) (0 0 0 1 0)
                                             (0 0 0 0 1))
                               for fixed = (substitute-if move (constantly t) mixes
                                                          :start i :end (1+ i))
                               collect (bare-expectation i cells fixed))))))))

(defun bare-greedy (cells)
  (loop for cell in (butlast cells)
        collect (bare-best (loop for move in *bare-moves*
                                 collect (- (bare-steps (bare-goal cell move)
                                                        (first (last cells))))))))

(defun bare-draw (name tick seed mix)
  (let ((draw (base:roll (base:make-dice (+ (* 100003 seed) tick) name))))
    (loop for move in *bare-moves*
          for share in mix
          do (decf draw share)
          when (minusp draw) return move)))

(defun bare-name (number count)
  (if (= number count) "PREY" (format nil "PREDATOR-~D" (1+ number))))

(defun bare-start (seed count)
  (let ((taken (list (cons 11 11))))
    (dotimes (i count (append (reverse (butlast taken)) (last taken)))
      (let ((dice (base:make-dice (* 100003 seed) (bare-name i count))))
        (push (loop for (row column) = (multiple-value-list (floor (base:roll-index 400 dice) 20))
                    for cell = (cons (1+ column) (1+ row))
                    unless (member cell taken :test #'equal) return cell)
              taken)))))

(defun bare-captured-p (cells)
  (let ((target (first (last cells))))
    (loop for move in (rest *bare-moves*)
          for beside = (bare-goal target move)
          always (or (equal beside target) (member beside (butlast cells) :test #'equal)))))

(defun bare-choices (agent cells)
  "Return the mixes of all robots. AGENT is :GREEDY or a level; 0 is to move at random."
  (append (if (eq agent :greedy) (bare-greedy cells) (bare-mixes cells agent))
          (list (bare-prey-mix))))

(defun bare-hunt (agent seed &key (count 4) (limit 500) turns)
  "Return the round in which the prey is captured, or LIMIT, and the last cells."
  (loop with cells = (bare-start seed count)
        with slots = (if turns (1+ count) 1)
        for slot from 0
        for round = (ceiling slot slots)
        until (or (bare-captured-p cells) (<= limit round))
        do (let ((moves (loop for mix in (bare-choices agent cells)
                              for i from 0
                              collect (if (and turns (/= i (mod slot slots)))
                                          '(0 . 0)
                                          (bare-draw (bare-name i count) (+ 2 (* 2 slot)) seed
                                                     mix)))))
             (setf cells (bare-moved cells moves)))
        finally (return (values round cells))))
