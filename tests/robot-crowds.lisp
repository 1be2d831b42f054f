;;;; robot-crowds.lisp -- many robots under random commands: bodies, order and dice.

(in-package :ars-magna.tests)

(def-suite* robot-crowds :in ars-magna)

;;; The random driver of random-driver.lisp in a hall of two rooms with a doorway, where robots are
;;; in each other's way. After each tick no two bodies may be in one cell, each body must be where
;;; its robot is, and world and robots must be consistent. When the driver has stopped, the run goes
;;; on with the commands under way: forks, saved runs, rewound runs and replays must do the same.

(world:defmap crowd-hall (24 10)
  (rect (0 0) (23 9) bricks 1 4 8 12) (wall (12 1) (12 4) slate 20) (wall (12 6) (12 9) slate 20)
  (obj crate (5.5 2.5) ((:size 9) (:obsmove t) (:capacity 8)) (bead ((:size .1))))
  (obj screen (18.5 7.5) ((:size 8) (:obsview t)))
  (obj post (10.5 3.5) ((:size 9) (:obsmove t) (:obsview t)))
  (obj ball (3.5 3.5) ((:size 1) (:weight 1) (:color red))))

(defun crowd-places ()
  "Return the centres of the free cells of the hall, the nearest to the doorway first."
  (stable-sort
   (loop for x from 1 to 22
         append (loop for y from 1 to 8
                      unless (or (= x 12) (and (= x 5) (= y 2)) (and (= x 10) (= y 3)))
                        collect (list (+ x .5d0) (+ y .5d0))))
   #'< :key (lambda (place) (+ (abs (- 12.5 (first place))) (abs (- 5.5 (second place)))))))

(defun names-in-crowd (count)
  (loop for number from 1 to count
        collect (intern (format nil "CROWD-~D" number) :ars-magna.tests)))

(defun define-crowd (count &optional (order #'identity))
  "Define COUNT robots in the hall. ORDER is a function that puts their definitions into order."
  (loop for (name place number) in (funcall order
                                            (loop for name in (names-in-crowd count)
                                                  for place in (crowd-places)
                                                  for number from 0
                                                  collect (list name place number)))
        do (robot:define-robot name 'crowd-hall place (mod number 6)
             :cameras (list (list (* 2 pi) 3)) :hands '(6) :bins '(8)
             :attributes (case (mod number 3)
                           (0 '((:color red) (:size 4) (:obsview t)))
                           (1 '((:color blue) (:size 3)))))))

;;; What must hold.

(defun bodies-in-one-cell (robots)
  "Return a list of strings, one for each of ROBOTS that shares its cell with an earlier one."
  (let ((first (make-hash-table)))
    (loop for robot in robots
          for index = (robot:robot-cell-index robot)
          when (shiftf (gethash index first) robot)
            collect (format nil "~A is in the cell of another robot" robot))))

(defun unsound-robots (robots world)
  (loop for robot in robots
        append (handler-case (progn (robot:check-robot robot world) '())
                 (error (condition) (list (princ-to-string condition))))))

(defun watch-crowd (simulation)
  "Note what is wrong in SIMULATION after a tick."
  (let ((robots (run:simulation-robots simulation)) (world (run:simulation-world simulation)))
    (watch-ride simulation)
    (dolist (violation (append (unless (world:world-ghosts-p world) (bodies-in-one-cell robots))
                               (unsound-robots robots world)))
      (complain "tick ~D: ~A" (run:simulation-tick simulation) violation))))

;;; Driving.

(defun place-somewhere (robot)
  (destructuring-bind (x y) (pick (crowd-places))
    (unless (robot::robot-at world:*world* x y)
      (robot:place-robot robot x y (pick '(0 1 2 3))))))

(defun move-somehow (robot)
  "Issue a command that moves ROBOT, most likely into something."
  (case (base:roll-index 8 (ride-dice *ride*))
    (0 (issue-command 'command:robot-set-speed robot (pick '(1 .3 .8 3))))
    ((1 2) (issue-command 'command:robot-turn robot (pick (list (/ pi 2) (/ pi 4) -1 3))))
    (3 (issue-command 'command:robot-goto-wall robot))
    (4 (issue-command 'command:robot-go-distance robot (pick '(1 1/2 3 7))))
    (5 (issue-command (pick '(command:robot-stop command:robot-follow-wall)) robot))
    (t (issue-command 'command:robot-go-forward robot (pick '(1 2 5 20))))))

(defun step-crowd (count)
  "Do one thing with each of COUNT robots of the crowd, and let some ticks pass, perhaps none."
  (loop repeat count
        do (cond ((luck .02) (place-somewhere (any-robot)))
                 ((luck .05) (meddle))
                 ((luck .05) (manipulate-at-random))
                 ((luck .5) (move-somehow (any-robot)))
                 (t (command-at-random))))
  (when (luck .01) (populate))
  (ride-on (pick '(0 0 1 2 5 12))))

(defun drive-crowd (commands count)
  "Issue COMMANDS commands at random to COUNT robots, or until something is wrong."
  (run:add-observer #'watch-crowd)
  (populate)
  (loop while (and (< (ride-issued *ride*) commands)
                   (null (ride-troubles *ride*)))
        do (step-crowd (ceiling count 6))
           (base:take-messages))
  (setf (ride-over-p *ride*) t))

;;; The run goes on.

(defun crowd-digests (ticks)
  (loop repeat ticks do (ride-on 1) collect (run:state-digest)))

(defun ways-gone-wrong (ticks)
  "Let the run here, its fork, the loaded run and the rewound run go on for TICKS. Return a list of
those that came to something else than the first: :FORK, :LOAD, :REWIND, :REPLAY."
  (with-temporary-file (file)
    (ride-on 1)
    (let* ((tick (tick-of-run)) (fork (run:fork-simulation))
           (saved-p (null (saved-or-refused file)))
           (journal (run:journal-up-to-now time:*simulation*)) (digest (run:state-digest))
           (digests (crowd-digests ticks)))
      (flet ((wrong (way other) (unless (equal digests other) (list way))))
        (append
         (wrong :fork (run:call-in-fork fork (lambda () (crowd-digests ticks))))
         (and saved-p
              (run:with-loaded-simulation (file) (wrong :load (crowd-digests ticks))))
         (unless (= digest (nth-value 1 (run:replay journal))) (list :replay))
         (progn (rewind-to tick)
                (wrong :rewind (crowd-digests ticks))))))))

(defun crowd-ride (count commands seed &key (order (names-in-crowd count)) (ticks 40))
  "Issue COMMANDS commands to COUNT robots in a run with SEED, whose robots are listed in ORDER.
Return a list of what was wrong; a digest of all calls of continuations; and that of the state."
  (let ((*ride* (make-ride (base:make-dice seed "ride")))
        (*error-output* (make-broadcast-stream)))
    (run:with-simulation (order :seed seed :journal t :keep 5 :parameters '((base:max-speed* 3)))
      (drive-crowd commands count)
      (let ((digest (run:state-digest)) (calls (base:digest-value (ride-calls *ride*)))
            (troubles (append (ride-troubles *ride*) (ways-gone-wrong ticks))))
        (end-ride)
        (values (union troubles (ride-troubles *ride*) :test #'equal) calls digest)))))

(test robot-crowds.of-two-and-ten-and-forty
  "Bodies never overlap, each continuation is called once, and runs repeat."
  (base:with-own-definitions ()
    (loop for (count commands) in '((2 2000) (10 2000) (40 1000))
          do (define-crowd count)
             (let ((troubles (crowd-ride count commands count)))
               (is (null troubles) "~D robots: ~{~A~^; ~}" count (last troubles 5))))))

(test robot-crowds.come-in-any-order
  "Neither the order of definition nor that of WITH-SIMULATION matters: the calls come in the same
order, and the states are the same."
  (base:with-own-definitions ()
    (let ((outcomes
            (loop for order in (list #'identity #'reverse
                                     (lambda (list) (append (cddr list) (ldiff list (cddr list)))))
                  do (define-crowd 12 order)
                  collect (multiple-value-list
                           (crowd-ride 12 600 5 :ticks 5
                                                :order (funcall order (names-in-crowd 12)))))))
      (is-true (third (first outcomes)))
      (dolist (outcome outcomes)
        (is (equal (rest (first outcomes)) (rest outcome)))
        (is (null (first outcome)) "~{~A~^; ~}" (first outcome))))))
