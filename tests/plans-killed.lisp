;;;; plans-killed.lisp -- shipped plans ended at any tick and started again succeed as well.

(in-package :ars-magna.tests)
(in-suite plans)

;;; For a thorough test, (setf *kills* 300); that takes some minutes.

(defparameter *kills* 8 "How often each errand is ended and started again.")

(defun interrupted-run (kill plan arguments)
  "Begin PLAN with ARGUMENTS; if it goes on after KILL ticks (NIL: never), end it and begin again.
Return its task, the last, and how many ticks it took in all."
  (let ((task (apply #'driver:begin-plan plan arguments)))
    (flet ((go-on (limit)
             (run:run-until (lambda () (rpl:task-over-p task)) :limit limit)))
      (when kill
        (go-on kill)
        (unless (rpl:task-over-p task)
          (driver:end-plan task)
          (setf task (apply #'driver:begin-plan plan arguments))))
      (go-on 20000)
      (values task (run:simulation-tick)))))

(defun count-killed (robots plan arguments done-p)
  "Run PLAN on ROBOTS with *KILLS* seeds, for each seed once to its end and once ended at a random
tick. ARGUMENTS is a function of the seed that returns the plan's arguments. Return how often the
task satisfied DONE-P, a function of task, seed and position, whole and ended."
  (flet ((trial (seed kill)
           (run:call-with-simulation
            (lambda ()
              (let ((robot (first (run:simulation-robots))))
                (driver:rpl-init-robot robot)
                (multiple-value-bind (task ticks)
                    (interrupted-run kill plan (funcall arguments seed))
                  (list (and (funcall done-p task seed) t) ticks))))
            robots :seed seed)))
    (loop with dice = (base:make-dice 7 :kills)
          for seed from 1 to *kills*
          for (whole ticks) = (trial seed nil)
          for kill = (floor (base:roll-between 1 ticks dice))
          count whole into wholes
          count (first (trial seed kill)) into killed
          finally (return (list wholes killed)))))

(defun errand-of-seed (seed)
  (nth (mod seed (length *office-errands*)) *office-errands*))

(defun near-robot-p (name)
  "True if the thing called NAME lies on the floor within three metres of MARVIN."
  (multiple-value-call #'brought-p name (robot:robot-position ars-worlds:marvin)))

(test killed.fetch-thing
  "What it had already, it brings; the errand may also just have been done."
  (destructuring-bind (wholes killed)
      (count-killed '(ars-worlds:marvin) 'ars-worlds:fetch-thing
                    (lambda (seed) (rest (errand-of-seed seed)))
                    (lambda (task seed)
                      (declare (ignorable task))
                      (let ((name (first (errand-of-seed seed))))
                        (or (near-robot-p name) (brought-p name 62 38)))))
    (is (<= wholes killed) "~D of ~D" killed wholes)))

(test killed.patrol-places
  (destructuring-bind (wholes killed)
      (count-killed '(ars-worlds:robbie) 'ars-worlds:patrol-places
                    (constantly '(((23 10) (34 8) (6 22)) :rounds 2))
                    (lambda (task seed) (declare (ignore seed)) (eql 6 (rpl:task-result task))))
    (is (<= wholes killed) "~D of ~D" killed wholes)))

(test killed.tidy-room
  (destructuring-bind (wholes killed)
      (count-killed '(nurse) 'ars-worlds:tidy-room
                    (constantly '((((:color world:red) (:substance world:plastic))
                                   ((:color world:blue) (:substance world:paper)))
                                  ((6 5) (14 10))))
                    (lambda (task seed)
                      (declare (ignore task seed))
                      (let ((nurse (first (run:simulation-robots))))
                        (and (equal '(ball ball) (bin-names nurse 0))
                             (equal '(book book) (bin-names nurse 1))))))
    (is (<= wholes killed) "~D of ~D" killed wholes)))
