;;;; robot-traffic.lisp -- robots in each other's way: convoys, circles, and travels that give way.

(in-package :ars-magna.tests)

(def-suite* robot-traffic :in ars-magna)

;;; Rows of robots, driven by bare commands.

;; Two rooms, joined by a doorway one cell wide at (15,10).
(world:defmap traffic-rooms (30 21)
  (rect (0 0) (29 20) bricks 10)
  (wall (15 1) (15 9) bricks 10) (wall (15 11) (15 19) bricks 10))

;; Two rooms, joined by a corridor one cell wide and eight cells long.
(world:defmap traffic-corridor (30 13)
  (rect (0 0) (29 12) bricks 10)
  (rect (11 1) (18 5) bricks 10) (rect (11 7) (18 11) bricks 10))

;; A long hall with a doorway in the middle.
(world:defmap traffic-hall (60 5)
  (rect (0 0) (59 4) bricks 10)
  (wall (30 1) (30 1) bricks 10) (wall (30 3) (30 3) bricks 10))

(defun define-robots (prefix map poses &rest options)
  "Define a robot in MAP at each of POSES, lists (x y angle). Return their names: PREFIX and a
number."
  (loop for (x y angle) in poses
        for number from 1
        for name = (intern (format nil "~A-~D" prefix number) :ars-magna.tests)
        do (apply #'robot:define-robot name map (list x y) angle options)
        collect name))

(defparameter *convoy-row*
  (define-robots "TRAFFIC-ROW" 'traffic-hall
    (loop for i from 1 to 10 collect (list (+ i .5) 2.5 0))))

(defun robots-named (names)
  (loop for name in names
        collect (find name (run:simulation-robots) :key #'robot:robot-name)))

(defun drive-all (names ticks &key (seed 0) (clean t))
  "Let the robots with NAMES drive ahead for TICKS, all from the same tick. Return a list of (name
code x) in the order of their full names. Claims that each is answered once."
  (let ((answers '()))
    (run:with-simulation (names :seed seed :clean clean)
      (dolist (robot (robots-named names))
        (command:robot-go-forward robot ticks
                                  (lambda (err robot)
                                    (push (list (robot:robot-name robot) err (robot:robot-x robot))
                                          answers))))
      (run:run-ticks (+ ticks 20)))
    (is (= (length names) (length answers)))
    (sort answers #'string< :key #'first)))

(defun in-random-order (list dice)
  (loop with left = (copy-list list)
        while left
        collect (let ((chosen (base:roll-element left dice)))
                  (setf left (remove chosen left))
                  chosen)))

(test convoys.run-through-a-doorway-without-a-block
  "Whatever the order of the robots in the run, and whatever the seed."
  (loop with dice = (base:make-dice 37)
        with first = (drive-all *convoy-row* 55)
        for seed from 1 to 60
        do (let ((answers (drive-all (in-random-order *convoy-row* dice) 55 :seed seed)))
             (is (every #'null (mapcar #'second answers)) "seed ~D: ~S" seed answers)
             (is (equal first answers) "seed ~D: ~S" seed answers)))
  (is (< 45 (loop for (nil nil x) in (drive-all *convoy-row* 55) minimize x)) "all are through"))

(defun orders-of (list)
  (if (null list)
      '(())
      (loop for first in list
            append (loop for rest in (orders-of (remove first list))
                         collect (cons first rest)))))

(test convoys.run-in-every-order-of-five
  (let ((five (subseq *convoy-row* 0 5)))
    (dolist (names (orders-of five))
      (is (every #'null (mapcar #'second (drive-all names 40 :seed (length names))))
          "~S" names))))

(test convoys.end-at-the-robot-that-stands
  "The first five drive on, the last of the row stands; each stops behind the one ahead of it."
  (let ((codes '()))
    (run:with-simulation (*convoy-row* :clean t)
      (let ((robots (robots-named *convoy-row*)))
        (dolist (robot (butlast robots))
          (command:robot-go-forward robot 30 (lambda (err robot) (push (list err robot) codes))))
        (run:run-ticks 60)
        (is (equal '(:robot-blocked) (remove-duplicates (mapcar #'first codes))))
        (is (= 9 (length codes)))
        (is (equal '(1 2 3 4 5 6 7 8 9 10)
                   (mapcar (lambda (robot) (floor (robot:robot-x robot))) robots)))))))

(defparameter *circle*
  (define-robots "TRAFFIC-CIRCLE" 'traffic-rooms
    `((5.5 5.5 0) (6.5 5.5 ,(/ pi 2)) (6.5 6.5 ,pi) (5.5 6.5 ,(/ pi -2)))))

(defparameter *swap*
  (define-robots "TRAFFIC-SWAP" 'traffic-rooms `((5.5 5.5 0) (6.5 5.5 ,pi))))

(test circles.block-all-that-drive-in-them
  "Four robots that follow one another in a circle, and two that would change places."
  (dolist (group (list *circle* *swap*))
    (dolist (names (orders-of group))
      (loop for seed from 1 to 5
            do (let ((codes (mapcar #'second (drive-all names 10 :seed seed))))
                 (is (every (lambda (code) (eq :robot-blocked code)) codes)
                     "~S, seed ~D: ~S" names seed codes))))))

(test circles.with-a-gap-run
  "Without one of the four, each of the others drives into the cell of the one ahead."
  (dolist (names (orders-of (rest *circle*)))
    (is (every #'null (mapcar #'second (drive-all names 1 :seed 3))) "~S" names)))

;;; Travels. The benchmark program of the same name makes a thousand of each.

(defparameter *head-on*
  (define-robots "TRAFFIC-HEAD-ON" 'traffic-rooms `((11.5 10.5 0) (18.5 10.5 ,pi))
                 :cameras '((1 10))))

(defparameter *head-on-goals* '((20.5 10.5) (8.5 10.5)))

(defparameter *in-corridor*
  (define-robots "TRAFFIC-CORRIDOR" 'traffic-corridor `((5.5 6.5 0) (24.5 6.5 ,pi))
                 :cameras '((1 10))))

(defparameter *in-corridor-goals* '((25.5 6.5) (4.5 6.5)))

(defparameter *convoy*
  (define-robots "TRAFFIC-CONVOY" 'traffic-rooms
    (loop for i below 10 collect (list (+ 2.5 (* 2 (mod i 5))) (if (< i 5) 8.5 12.5) 0))
    :cameras '((1 10))))

(defparameter *convoy-goals*
  (loop for i below 10 collect (list (+ 18.5 (* 2 (mod i 5))) (if (< i 5) 5.5 15.5))))

(defparameter *both-ways*
  (define-robots "TRAFFIC-BOTH-WAYS" 'traffic-rooms
    (append (loop for i below 5 collect (list (+ 2.5 (* 2 i)) 8.5 0))
            (loop for i below 5 collect (list (+ 18.5 (* 2 i)) 12.5 pi)))
    :cameras '((1 10))))

(defparameter *both-ways-goals*
  (append (loop for i below 5 collect (list (+ 18.5 (* 2 i)) 5.5))
          (loop for i below 5 collect (list (+ 2.5 (* 2 i)) 15.5))))

(defun trouble-at-goal (err robot goal)
  "Return ERR, :FAR-AWAY if ROBOT is more than three metres from GOAL, or NIL."
  (or err
      (and (< 3 (ars:way-length (list goal (list (robot:robot-x robot) (robot:robot-y robot)))))
           :far-away)))

(defun send-robots (robots goals note)
  "Send each of ROBOTS to its goal, patiently. At the end of each travel, call NOTE with its trouble
or NIL."
  (loop for robot in robots
        for goal in goals
        do (let ((goal goal))
             (ars-worlds:robot-go-to robot (first goal) (second goal)
                                     (lambda (err robot)
                                       (funcall note (trouble-at-goal err robot goal)))
                                     :patience (if (rest (rest robots)) 100 40)))))

(defun travel-troubles (names goals seed &key clean (limit 9000))
  "Let the robots with NAMES travel to GOALS with ROBOT-GO-TO. Return a list of troubles, and the
tick in which the last robot arrived."
  (let ((ends '()))
    (run:with-simulation (names :seed seed :clean clean)
      (send-robots (robots-named names) goals (lambda (trouble) (push trouble ends)))
      (run:run-until (lambda () (= (length ends) (length names))) :limit limit)
      (values (append (remove nil ends)
                      (unless (= (length ends) (length names)) '(:not-ended)))
              (run:simulation-tick)))))

(rpl:def-interp-proc traffic-travel (point)
  (ars-worlds:travel-to (ars-worlds:begin-reckoning (ars-worlds:here (driver:rpl-robot))) point))

(defun plan-travel-troubles (names goals seed &key clean (limit 9000))
  "Do as TRAVEL-TROUBLES, but the first robot travels with the plan TRAVEL-TO."
  (let ((ends '()))
    (run:with-simulation (names :seed seed :clean clean)
      (let ((robots (robots-named names)))
        (driver:rpl-init-robot (first robots))
        (send-robots (rest robots) (rest goals) (lambda (trouble) (push trouble ends)))
        (let ((state (nth-value 1 (driver:run-plan 'traffic-travel (first goals)))))
          (push (unless (eq state :succeeded) state) ends)
          (push (trouble-at-goal nil (first robots) (first goals)) ends)))
      (run:run-until (lambda () (< (length names) (length ends))) :limit limit)
      (append (remove nil ends)
              (unless (< (length names) (length ends)) '(:not-ended))))))

(defun is-travelled (count travel names goals)
  "Check that TRAVEL of the robots with NAMES to GOALS makes no trouble, for COUNT seeds of each."
  (dolist (clean '(nil t))
    (loop for seed from 1 to count
          do (is (null (funcall travel names goals seed :clean clean))
                 "~A, seed ~D~:[~; clean~]" (first names) seed clean))))

(test travels.two-robots-get-through-a-doorway-from-both-sides
  (is-travelled 30 #'travel-troubles *head-on* *head-on-goals*))

(test travels.a-plan-and-a-program-get-through-a-doorway-from-both-sides
  (is-travelled 15 #'plan-travel-troubles *head-on* *head-on-goals*))

(test travels.two-robots-get-through-a-corridor-from-both-sides
  (is-travelled 20 #'travel-troubles *in-corridor* *in-corridor-goals*)
  (is-travelled 5 #'plan-travel-troubles *in-corridor* *in-corridor-goals*))

(test travels.ten-robots-get-through-a-doorway
  (is-travelled 5 #'travel-troubles *convoy* *convoy-goals*)
  (is-travelled 2 #'travel-troubles *both-ways* *both-ways-goals*))

(test travels.do-not-depend-on-the-order-of-robots
  (flet ((ends (order seed)
           (multiple-value-list (travel-troubles (mapcar #'car order) (mapcar #'cdr order) seed))))
    (let ((pairs (mapcar #'cons *convoy* *convoy-goals*)))
      (loop for seed from 1 to 3
            do (is (equal (ends pairs seed) (ends (reverse pairs) seed)) "seed ~D" seed)))))

(defparameter *barred*
  (define-robots "TRAFFIC-BARRED" 'traffic-rooms '((11.5 10.5 0) (15.5 10.5 0))
    :cameras '((1 10))))

(test travels.fail-if-a-robot-stands-in-the-only-doorway
  (let ((codes '()))
    (run:with-simulation (*barred* :seed 3)
      (ars-worlds:robot-go-to (first (robots-named *barred*)) 20.5 10.5
                              (lambda (err robot) (declare (ignore robot)) (push err codes))
                              :patience 6)
      (run:run-ticks 2000))
    (is (equal '(:gave-up) codes)))
  (run:with-simulation (*barred* :seed 3)
    (driver:rpl-init-robot (first (robots-named *barred*)))
    (is (eq :failed (nth-value 1 (driver:run-plan 'traffic-travel '(20.5 10.5)))))
    (is-true (find-if (lambda (message) (search "CANNOT-GET-THERE" (base:message-text message)))
                      (base:take-messages)))))

(test travels.end-when-a-robot-that-waits-is-told-to-stop
  (loop for tick from 10 to 120 by 5
        do (is (equal '((:interrupt) nil)
                      (run:with-simulation (*barred* :seed 2)
                        (let ((robot (first (robots-named *barred*))))
                          (told-to-stop robot
                                        (lambda (continuation)
                                          (ars-worlds:robot-go-to robot 20.5 10.5 continuation))
                                        tick))))
               "tick ~D" tick)))

(test travels.are-the-same-in-forks-and-replays
  (run:with-simulation (*head-on* :seed 4 :journal t)
    (send-robots (robots-named *head-on*) *head-on-goals* #'identity)
    (run:run-ticks 60)
    (let ((ends '()))
      (run:with-fork (:continuations t)
        (run:run-ticks 150)
        (push (run:state-digest) ends))
      (run:run-ticks 150)
      (is (equal ends (list (run:state-digest))) "the fork")
      (is (= (first ends) (nth-value 1 (run:replay (end-journal time:*simulation*))))
          "the replay"))))

;;; Passing places.

(test passing-places.are-off-doorways-and-corridors
  (let ((map (world:find-map 'traffic-corridor)))
    (loop for (x y narrow passing) in '((12 6 t nil) (18 6 t nil) (10 6 nil nil) (9 6 nil t)
                                        (1 1 nil t) (20 6 nil t) (19 5 nil nil))
          do (is (eq narrow (ars-worlds::narrow-cell-p map x y)) "(~D,~D)" x y)
             (is (eq passing (ars-worlds::passing-place-p map (list x y))) "(~D,~D)" x y))
    (is (null (ars-worlds::nearest-passing-places map '(14 6) '(13 6) 0)))
    (let ((places (ars-worlds::nearest-passing-places map '(14 6) '(13 6) 5)))
      (is (<= 5 (length places)))
      (is (every (lambda (cell) (<= 19 (first cell))) places) "~S" places))))
