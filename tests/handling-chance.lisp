;;;; handling-chance.lisp -- how often handling goes wrong (manual, chapter 4: Hands, Bins).

(in-package :ars-magna.tests)

(in-suite handling)

(defun expected-count-p (count trials probability)
  "True if COUNT successes in TRIALS go with PROBABILITY, within four standard deviations."
  (<= (abs (- count (* trials probability)))
      (* 4 (sqrt (* trials probability (- 1 probability))))))

(defun count-code (code trials trial)
  "Return how many of TRIALS calls of TRIAL return CODE."
  (loop repeat trials count (eq code (funcall trial))))

(defun code-after (ticks command &rest arguments)
  "Issue COMMAND with ARGUMENTS; return the error code it has ended with when TICKS have passed."
  (let ((code :unanswered))
    (apply command (append arguments (list (lambda (error &rest more)
                                             (declare (ignore more))
                                             (setf code error)))))
    (run:run-ticks ticks)
    code))

(test chance.of-missing-a-grasp
  (with-cook (:seed 1)
    (setf base:prob-grasp-lose-desig* 0 base:prob-lose-track* 0)
    (let ((designator (track (camera 0) (designate 'apple))))
      (is (expected-count-p
           (count-code :missed-grasp 3000
                       (lambda ()
                         (prog1 (code-after 6 'command:hand-grasp-desig
                                            (hand 0) (camera 0) designator)
                           (code-after 1 'command:hand-ungrasp (hand 0)))))
           3000 .04)))))

(test chance.of-losing-designators-by-grasping
  (with-cook (:seed 2)
    (let ((lost 0))
      (setf base:prob-lose-track* 0)
      (loop repeat 600
            do (let ((designators (loop repeat 5 collect (designate 'apple))))
                 (track (camera 0) (first designators))
                 (code-after 6 'command:hand-grasp-desig (hand 0) (camera 0) (first designators))
                 (code-after 1 'command:hand-ungrasp (hand 0))
                 (incf lost (count-if-not #'robot:designator-valid-p designators))
                 (dolist (designator designators)
                   (robot:drop-designator designator :silently t))))
      (is (expected-count-p lost 3000 .1)))))

(test chance.of-bumping-with-a-hand
  (with-cook (:seed 3)
    (flet ((trial (destination)
             (prog1 (code-after 2 'command:hand-insert (hand 0) destination)
               (code-after 2 'command:hand-remove (hand 0)))))
      (setf base:hand-insert-lose-desig-prob* 0)
      (let ((designator (designate 'hamper)))
        (is (expected-count-p (count-code :hand-bump 3000 (lambda () (trial designator)))
                              3000 .05)))
      (is (expected-count-p (count-code :hand-bump 3000 (lambda () (trial (bin 0)))) 3000 .05)))))

(test chance.of-losing-designators-by-a-bump
  (with-cook (:seed 4)
    (let ((lost 0))
      (setf base:hand-insert-miss-prob* 1)
      (loop repeat 600
            do (let ((designators (loop repeat 5 collect (designate 'hamper))))
                 (code-after 2 'command:hand-insert (hand 0) (first designators))
                 (incf lost (count-if-not #'robot:designator-valid-p designators))
                 (dolist (designator designators)
                   (robot:drop-designator designator :silently t))))
      (is (expected-count-p lost 3000 .1)))))

(test chance.of-cameras-going-in
  (with-cook (:seed 5)
    (let ((bumped 0) (went-in 0) (lost 0))
      (setf base:prob-lose-track* 0)
      (loop repeat 3000
            do (let ((designator (track (camera 0) (designate 'hamper))))
                 (track (camera 1) designator)
                 (ecase (code-after 2 'command:camera-insert (camera 0) designator)
                   (:camera-bump (incf bumped))
                   ((nil) (incf went-in)
                    (unless (robot:designator-valid-p designator) (incf lost))))
                 (put-into (camera 0) nil)
                 (robot:drop-designator designator :silently t)))
      (is (expected-count-p bumped 3000 .05))
      (is (expected-count-p lost went-in .1)))))

(test chance.of-a-jam
  (with-cook (:seed 6)
    (world:move-thing (thing 'apple) (bin 0))
    (is (expected-count-p
         (count-code :bin-jammed 10000
                     (lambda ()
                       (prog1 (code-after 2 'command:storage-bin-close (bin 0))
                         (code-after 2 'command:storage-bin-open (bin 0)))))
         10000 .01))))
