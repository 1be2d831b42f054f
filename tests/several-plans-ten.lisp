;;;; several-plans-ten.lisp -- ten robots with a plan each: runs repeat, and none waits for another.

(in-package :ars-magna.tests)
(in-suite several-plans)

(defun ten-robots (&optional (numbers '(0 1 2 3 4 5 6 7 8 9)))
  "Return a list for WITH-SIMULATION of ten robots like ABE."
  (loop for i in numbers
        collect (list 'abe :as (intern (format nil "TEN-~D" i) :ars-magna.tests)
                           :at (list 5 (+ 5 (* 5 i))))))

(defun robot-number (robot)
  (parse-integer (string (robot:robot-name robot)) :start 4))

(rpl:def-interp-proc roam (times)
  "Turn, drive and think by chance, TIMES times. Return the choices."
  (let ((choices '()))
    (rpl:n-times times
      (push (rpl:try-one 1 2 3 4) choices)
      (driver:rpl-robot-turn (* .3 (first choices)))
      (rpl:wait-for driver:robot-stopped*)
      (driver:rpl-robot-go-forward (random 3))
      (rpl:wait-for driver:robot-stopped*)
      (rpl:think (first choices)))
    choices))

(defun roaming-ends (tasks)
  "Return sorted lists of a robot's number, the tick at which its one of TASKS ended, its value."
  (let ((ends '()))
    (loop repeat 400
          do (run:run-ticks 1)
             (loop for (number . task) in tasks
                   when (and (rpl:task-over-p task) (not (assoc number ends)))
                     do (push (list number (run:simulation-tick) (rpl:task-result task)) ends)))
    (sort ends #'< :key #'first)))

(defun begin-roaming (&optional (order #'identity))
  (loop for robot in (funcall order (run:simulation-robots))
        collect (cons (robot-number robot) (driver:begin-plan 'roam 4 :robot robot))))

(defun headless-roaming (seed thinking &key (numbers '(0 1 2 3 4 5 6 7 8 9)) (order #'identity))
  (run:with-simulation ((ten-robots numbers) :seed seed :thinking thinking)
    (roaming-ends (begin-roaming order))))

(defun forked-roaming (seed thinking)
  "As HEADLESS-ROAMING. Return the digests of the run and of a fork made at tick 7, at tick 407."
  (run:with-simulation ((ten-robots) :seed seed :thinking thinking)
    (begin-roaming)
    (run:run-ticks 7)
    (let ((fork (run:fork-simulation)))
      (run:run-ticks 400)
      (run:run-ticks 400 fork)
      (list (run:state-digest time:*simulation* t) (run:state-digest fork t)))))

(defun trouble-with-roaming (seed thinking)
  "Return what is wrong with the ends of plans of ten robots, or NIL."
  (let ((ends (headless-roaming seed thinking)))
    (append (unless (= 10 (length ends)) (list (list seed :ended (length ends))))
            (unless (equal ends (headless-roaming seed thinking)) (list (list seed :again)))
            (unless (equal ends (headless-roaming seed thinking :order #'reverse))
              (list (list seed :begun-in-another-order)))
            (unless (equal ends (headless-roaming seed thinking :numbers '(3 9 4 0 1 8 7 6 2 5)))
              (list (list seed :robots-in-another-order)))
            (unless (apply #'= (forked-roaming seed thinking)) (list (list seed :fork))))))

(test ten.plans-end-the-same-way-in-any-order-and-in-forks
  (let ((*package* (find-package :ars-magna.tests)))
    (dolist (thinking '(:free :charged))
      (dotimes (seed 3) (is (null (trouble-with-roaming seed thinking)))))))

(test ten.a-plan-that-never-waits-delays-no-other
  (flet ((ends (loop-p)
           (run:with-simulation ((ten-robots) :seed 1 :clean t)
             (let ((base:*message-queue* (base:make-message-queue))
                   (*standard-output* (make-broadcast-stream))
                   (*error-output* (make-broadcast-stream)))
               (let ((tasks (loop for robot in (rest (run:simulation-robots))
                                  collect (cons (robot-number robot)
                                                (driver:begin-plan 'roam 2 :robot robot)))))
                 (when loop-p
                   (driver:begin-plan (rpl:interp-lambda () (loop (rpl:seq nil)))
                                      :robot (first (run:simulation-robots))))
                 (let ((rpl:*runaway-limit* 2000)) (roaming-ends tasks)))))))
    (let ((alone (ends nil)))
      (is (= 9 (length alone)))
      (is (equal alone (ends t))))))

;;; Dice of plans.

(defun two-draws (robot)
  "Run a plan on ROBOT, named, that draws from both kinds of dice of plans; return what it draws."
  (driver:run-plan (rpl:interp-lambda ()
                     (rpl:wait-time 1)
                     (list (random 1000000)
                           (rpl:try-one 1 2 3 4) (rpl:try-one 1 2 3 4) (rpl:try-one 1 2 3 4)))
                   :robot robot))

(test saved-runs.of-several-robots-go-on-with-the-dice-of-their-plans
  (with-temporary-file (file)
    (with-three (:seed 3)
      (let ((before (two-draws 'ada)) (digest nil) (after '()))
        (run:save-simulation file)
        (setf digest (run:state-digest))
        (flet ((go-on () (list (two-draws 'ben) (two-draws 'ada) (two-draws 'ada))))
          (run:with-fork () (setf after (go-on)))
          (is (= 4 (length (remove-duplicates (cons before after) :test #'equal))))
          (is (equal after (run:with-loaded-simulation (file)
                             (is (= digest (run:state-digest)))
                             (go-on))))
          (driver:rpl-init-robot ada)
          (is (equal after (go-on))))))))
