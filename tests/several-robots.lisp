;;;; several-robots.lisp -- runs with several robots: lists of robots, ghosts, names, journals.

(in-package :ars-magna.tests)

(def-suite* several-robots :in ars-magna)

(defpackage :pa (:use))
(defpackage :pb (:use))

(world:defmap corral (30 20)
  (rect (0 0) (29 19) bricks 10))

(robot:defrobot colt (corral (5 5) 0) :cameras ((3 10)) :hands (10))
(robot:defrobot mare (corral (5 9) 0) :cameras ((3 10)))
(robot:defrobot pa::scout (corral (10 5) 0))
(robot:defrobot pb::scout (corral (10 9) 0))

(defun poses-of (robots)
  (loop for robot in robots
        collect (list (robot:robot-x robot) (robot:robot-y robot) (robot:robot-angle robot))))

(defun drive-robots-of (simulation)
  "Let each robot of SIMULATION drive on its own way."
  (loop for robot in (run:simulation-robots simulation)
        for turn from 1
        do (command:robot-turn robot turn)
           (run:run-ticks 5 simulation)
           (command:robot-go-forward robot 9)))

(defun text-of-error (function)
  (handler-case (progn (funcall function) nil)
    (base:ars-magna-error (trouble) (princ-to-string trouble))))

(defmacro herd-refusal (&body body)
  "Return the text of the error in BODY, or NIL."
  `(text-of-error (lambda () ,@body)))

(defmacro with-stopped-run ((robot &rest options) &body body)
  "Run BODY in a live run of the map of ROBOT, a name, which is stopped after a few ticks."
  `(with-messages
     (unwind-protect (progn (run:simulator ',robot :rate :free :seed 5 :display nil ,@options)
                            (run:stop-simulator)
                            ,@body)
       (setf time:*simulation* nil world:*world* nil))))

;;; Lists of robots.

(test list.names-another-robot-of-a-kind
  (let ((y 9))
    (run:with-simulation ((colt (colt :as colt-2 :at (3 (+ 2 2.5)))
                                (colt :as colt-3 :at (20 y) :angle (/ pi 2)))
                          :clean t)
      (is (equal '(colt colt-2 colt-3)
                 (mapcar #'robot:robot-name (run:simulation-robots))))
      (is (equal (list '(5d0 5d0 0d0) '(3d0 4.5d0 0d0) (list 20d0 9d0 (/ pi 2)))
                 (poses-of (list colt colt-2 colt-3))))
      (is (= 1 (length (robot:robot-cameras colt-3)) (length (robot:robot-hands colt-3))))
      (is (eq colt-2 (robot:find-robot 'colt-2)))
      (is (eq colt-2 (robot:find-robot "colt-2")))
      (is (eq 'colt-2 (getf (run:status 'colt-2) :robot)))
      (command:robot-go-distance colt-2 3)
      (run:run-ticks 20)
      (is (= 6 (round (robot:robot-x colt-2)))))
    (is (null (robot:find-robot 'colt-2 nil)))))

;;; Messages.

(test messages.name-the-robot-in-a-run-of-several
  (flet ((text-of-blocked (robots)
           (run:with-simulation (robots :clean t)
             (command:robot-go-distance (robot:find-robot 'colt) 100)
             (run:run-ticks 100)
             (with-output-to-string (out) (base:error-display out)))))
    (let ((alone (text-of-blocked '(colt))) (with-another (text-of-blocked '(colt mare))))
      (is (equal (format nil "*ERROR* -> Robot is blocked~%") alone))
      (is (equal (format nil "*ERROR* -> colt: Robot is blocked~%") with-another)))))

(test messages.at-the-end-of-a-run-name-the-robots
  (let ((text (with-output-to-string (*error-output*)
                (run:with-simulation ((colt mare) :clean t)
                  (dolist (robot (run:simulation-robots))
                    (command:robot-go-forward robot 100)
                    (command:robot-turn robot 1 (lambda (&rest all) (error "Oh, ~D" (length all)))))
                  (run:run-ticks 100)
                  (dolist (robot (run:simulation-robots)) (command:robot-go-forward robot 100))
                  (run:run-ticks 100)))))
    (is (has-words-p text "colt: robot-go-forward: Robot is blocked"
                     "mare: robot-go-forward: Robot is blocked"
                     "continuation of robot-turn of COLT" "continuation of robot-turn of MARE"))))

(test list.may-be-one-robot-at-another-start
  (run:with-simulation ((colt :at (8 8)))
    (is (equal '((8d0 8d0 0d0)) (poses-of (list colt)))))
  (run:with-simulation (((colt :angle 2)))
    (is (equal '((5d0 5d0 2d0)) (poses-of (list colt))))))

(test list.may-be-computed
  (flet ((x-of (number) (+ 3 (* 2 (mod number 10))))
         (y-of (number) (+ 3 (* 2 (floor number 10)))))
    (run:with-simulation ((loop for i below 70
                                collect (list 'colt :as (intern (format nil "COLT-~D" i)
                                                                :ars-magna.tests)
                                                    :at (list (x-of i) (y-of i)))))
      (is (= 70 (length (run:simulation-robots))))
      (is (equal '((21d0 9d0 0d0)) (poses-of (list (robot:find-robot "colt-39"))))))
    (let ((robots `(mare (colt :as ,(make-symbol "LONE") :at (9 9)))))
      (run:with-simulation (robots)
        (is (equal '((9d0 9d0 0d0)) (poses-of (list (robot:find-robot "lone")))))))))

(test list.takes-robots-of-the-run-around
  (run:with-simulation ((colt (colt :as twin :at (9 9))))
    (run:with-simulation ((list 'twin colt))
      (is (equal '((9d0 9d0 0d0) (5d0 5d0 0d0)) (poses-of (run:simulation-robots)))))))

(test list.with-a-mistake-is-refused
  (macrolet ((says (robots &rest words)
               `(is-true (has-words-p (or (herd-refusal (run:with-simulation (,robots))) "")
                                      ,@words))))
    (says (list) "the list of robots is empty")
    (says (colt colt) "twice" "(colt :as colt-2 :at (X Y))")
    (says (colt (colt :as colt)) "twice")
    (says (colt (colt :as colt-2)) "COLT and COLT-2 would start in one cell" ":ghosts t")
    (says (colt (mare :at (5.5 5.5))) "one cell")
    (says (colt (colt :name colt-2 :at (3 3))) "no keyword :name" "(SCOUT :as SCOUT-2 :at (X Y)")
    (says (colt (colt :as colt-2 :at)) ":at")
    (says (colt (colt :at (3 3) :at (4 4))) ":at is given twice")
    (says (colt (colt :as colt-2 :at (0.5 3))) "inside a wall")
    (says (colt (colt :as colt-2 :at (300 3))) "outside the map, which is 30 by 20")
    (says (colt (colt :as colt-2 :at 3)) ":at takes a position (x y)")
    (says (colt (colt :as colt-2 :at (3 3) :angle nil)) ":angle takes an angle in radians")
    (says (colt (colt :as "colt-2" :at (3 3))) ":as takes a symbol")
    (says (colt (colt :as :colt-2 :at (3 3))) ":as takes a symbol")
    (says (colt (colt :as t :at (3 3))) "no variable can hold the robot" ":as my-t")
    (says (colt (colr :as colt-2 :at (3 3))) "no robot" "did you mean colt?")))

(test list.is-taken-by-experiments
  (eval '(experiment:defexperiment herds
          (:robots colt (colt :as colt-2 :at (20 (+ 2 3))))
          (:clean)
          (:run (command:robot-go-distance colt-2 3) (run:run-ticks 40) t)
          (:measure (x (robot:robot-x colt-2)))))
  (is (equal '(23 23) (mapcar #'round
                              (measured (experiment:run-experiment 'herds :trials 2 :stream nil)
                                        "x"))))
  (is-true (has-words-p (herd-refusal (eval '(experiment:defexperiment herds
                                         (:robots colt (colt :as colt-2))
                                         (:run t))))
                        "(:ROBOTS" "one cell")))

;;; Runs with such lists.

(defun digest-of-herd (then)
  "Return the digest at the end of a run of three robots, and the value of THEN after 60 ticks."
  (run:with-simulation ((mare (mare :as filly :at (12 12) :angle 1) (colt :at (20 5)))
                        :seed 8 :journal t :keep t)
    (drive-robots-of time:*simulation*)
    (run:run-ticks 30)
    (let ((value (funcall then)))
      (run:run-ticks (- 80 (run:simulation-tick)))
      (values (run:state-digest) value))))

(test herd.is-repeated-by-forks-rewinds-saves-and-replays
  (let ((digest (digest-of-herd (constantly nil))))
    (is (= digest (digest-of-herd (lambda () (run:run-ticks 9) (run:rewind 20)))))
    (is (= digest (nth-value 1 (digest-of-herd (lambda ()
                                                 (let ((fork (run:fork-simulation)))
                                                   (run:run-ticks
                                                    (- 80 (run:simulation-tick)) fork)
                                                   (run:state-digest fork)))))))
    (with-temporary-file (file)
      (digest-of-herd (lambda () (uiop:delete-file-if-exists file) (run:save-simulation file)))
      (run:with-loaded-simulation (file)
        (is (equal '(mare filly colt) (mapcar #'robot:robot-name (run:simulation-robots))))
        (run:run-ticks (- 80 (run:simulation-tick)))
        (is (= digest (run:state-digest)))
        (is (= digest (nth-value 1 (run:replay (run:journal-up-to-now time:*simulation*)))))
        (uiop:delete-file-if-exists file)
        (run:save-journal file)
        (is (= digest (nth-value 1 (run:replay file))))))))

(test herd.has-its-starts-in-the-head-of-its-journal
  (run:with-simulation ((colt (colt :as colt-2 :at (9 9))) :journal t)
    (let ((header (run:journal-header (run:simulation-journal time:*simulation*))))
      (is (equal '("ARS-MAGNA.TESTS::COLT" "ARS-MAGNA.TESTS::COLT-2") (getf header :robots)))
      (is (equal '(("ARS-MAGNA.TESTS::COLT-2" "ARS-MAGNA.TESTS::COLT" 9d0 9d0 0d0))
                 (getf header :starts)))
      (is (null (getf header :ghosts :none)))))
  (run:with-simulation (colt :journal t)
    (is (equal '(:map :robots :seed :thinking :parameters :definitions)
               (loop for key in (run:journal-header (run:simulation-journal time:*simulation*))
                       by #'cddr
                     collect key)))))

(test herd.needs-only-the-definition-of-the-kind
  "The name of the other robot is made when a saved run is loaded or a journal is replayed."
  (with-temporary-file (file)
    (let ((digest (run:with-simulation ((list 'colt (list 'colt :as (intern "FOAL" :pa) :at '(9 9)))
                                        :journal t)
                    (drive-robots-of time:*simulation*)
                    (run:save-journal file)
                    (run:state-digest))))
      (unintern (find-symbol "FOAL" :pa) :pa)
      (is (= digest (nth-value 1 (run:replay file))))
      (run:with-replay (file)
        (is (eq (find-symbol "FOAL" :pa)
                (robot:robot-name (second (run:simulation-robots)))))))))

;;; Ghosts.

(defun meeting-places (&rest options)
  "Return where two robots that drive towards each other end, and the digest of a replay and run."
  (apply #'run:call-with-simulation
         (lambda ()
           (destructuring-bind (one other) (run:simulation-robots)
             (command:robot-go-distance one 12)
             (command:robot-go-distance other 12)
             (run:run-ticks 60)
             (list (robot:robot-x one) (robot:robot-x other)
                   (= (run:state-digest)
                      (nth-value 1 (run:replay
                                    (run:journal-up-to-now time:*simulation*)))))))
         `(colt (colt :as colt-2 :at (15 5) :angle ,pi))
         :clean t :journal t options))

(test ghosts.drive-through-each-other
  (destructuring-bind (x other-x same-p) (meeting-places :ghosts t)
    (is (= 17 (round x)))
    (is (< 2.99 other-x 3.01))
    (is-true same-p))
  (destructuring-bind (x other-x same-p) (meeting-places)
    (is (< x other-x))
    (is-true same-p)))

(test ghosts.may-start-in-one-cell-and-stay-ghosts
  (run:with-simulation ((colt (colt :as colt-2)) :ghosts t :keep t)
    (is-true (world:world-ghosts-p world:*world*))
    (robot:place-robot colt 9 9 0)
    (robot:place-robot colt-2 9 9 0)
    (run:run-ticks 5)
    (run:rewind 3)
    (is-true (world:world-ghosts-p world:*world*))
    (run:with-fork () (is-true (world:world-ghosts-p world:*world*)))
    (with-temporary-file (file)
      (uiop:delete-file-if-exists file)
      (run:save-simulation file)
      (run:with-loaded-simulation (file)
        (is-true (world:world-ghosts-p world:*world*))
        (is (null (robot:robot-body (first (run:simulation-robots)))))))))

(test ghosts.are-an-option-of-simulator-for-one-run
  (with-stopped-run (colt :ghosts t)
    (is (null (robot:robot-body colt)))
    (is-true (getf (run:journal-header (run:simulation-journal time:*simulation*)) :ghosts)))
  (with-stopped-run (colt)
    (is-true (robot:robot-body colt))
    (is (null (getf (run:journal-header (run:simulation-journal time:*simulation*)) :ghosts
                    :none)))))

(test ghosts.are-an-option-of-experiments
  (dolist (clause '((:ghosts) (:ghosts nil)))
    (eval `(experiment:defexperiment spirits
             (:robots colt (colt :as colt-2 :at (9 5)))
             (:clean) ,clause
             (:run (command:robot-go-distance colt 10) (run:run-ticks 40) t)
             (:measure (x (robot:robot-x colt)))))
    (let ((x (first (measured (experiment:run-experiment 'spirits :trials 1 :stream nil) "x"))))
      (is (eq (equal clause '(:ghosts)) (= 15 (round x)))))))

;;; Places with another robot in them.

(test places.of-other-robots-are-refused
  (run:with-simulation ((colt mare))
    (is-true (has-words-p (herd-refusal (robot:place-robot colt 5.2 9.3 0))
                          "MARE is in the cell of (5.2 9.3)"))
    (robot:place-robot colt 5.3 5.3 2)
    (is (equal '((5.3d0 5.3d0 2d0)) (mapcar (lambda (place) (mapcar #'to-tenths place))
                                            (poses-of (list colt)))))))

(defun to-tenths (number)
  (/ (fround (* 10 number)) 10))

;;; Names that differ only in their packages.

(test names.of-two-packages-are-told-apart
  (let (digest place)
    (with-temporary-file (journal)
      (with-temporary-file (saved)
        (run:with-simulation ((pb::scout pa::scout) :seed 3 :journal t :keep t)
          (command:robot-turn pa::scout 1)
          (command:robot-go-forward pb::scout 5)
          (run:run-ticks 9)
          (run:rewind 4)
          (command:robot-go-forward pa::scout 3)
          (run:run-ticks 20)
          (uiop:delete-file-if-exists saved)
          (run:save-simulation saved)
          (run:save-journal journal)
          (setf digest (run:state-digest)
                place (poses-of (list pa::scout)))
          (is (equal '((0 command:robot-turn (:the :robot "PA::SCOUT") 1)
                       (0 command:robot-go-forward (:the :robot "PB::SCOUT") 5))
                     (subseq (run:journal-entries (run:simulation-journal time:*simulation*))
                             0 2)))
          (is-true (has-words-p (herd-refusal (run:internalize '(:the :robot "SCOUT")
                                                          time:*simulation*))
                                "PA::SCOUT" "PB::SCOUT" "full name")))
        (is (= digest (nth-value 1 (run:replay journal))))
        (run:with-replay (journal) (is (equal place (poses-of (list pa::scout)))))
        (run:with-loaded-simulation (saved)
          (is (= digest (run:state-digest)))
          (is (equal place (poses-of (list pa::scout)))))))))

(test names.of-two-packages-are-told-apart-in-tables
  (eval '(experiment:defexperiment scouts
          (:vary (:robots 'pa::scout 'pb::scout 'colt))
          (:run (run:run-ticks 1) t)))
  (is (equal '("robots=PA::SCOUT" "robots=PB::SCOUT" "robots=colt")
             (mapcar #'experiment::condition-name
                     (experiment::experiment-conditions (experiment::find-experiment 'scouts)))))
  (with-temporary-file (file)
    (uiop:delete-file-if-exists file)
    (run:with-simulation ((pa::scout pb::scout) :journal t)
      (run:run-ticks 1)
      (ars:save-trajectory file)
      (is (equal '("robot" "pa::scout" "pb::scout" "pa::scout" "pb::scout")
                 (mapcar (lambda (line) (second (uiop:split-string line :separator ",")))
                         (uiop:read-file-lines file)))))))
