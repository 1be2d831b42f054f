;;;; forking.lisp -- forks at random moments of random runs continue as their originals do.

(in-package :ars-magna.tests)
(in-suite forking)

;;; Random commands whose continuations issue further ones. Copied continuations do the same in the
;;; fork.

(defun call-in-rides (function rides moments seed)
  "Call FUNCTION with a simulation, in which much is under way, MOMENTS times in each of RIDES."
  (loop for ride from 0 below rides
        do (run:with-simulation ((keeper helper) :seed (+ seed ride))
             (let ((*ride* (make-ride (base:make-dice (+ seed ride) "moments"))))
               (populate)
               (loop repeat moments
                     do (loop repeat 4 do (step-ride))
                        (base:take-messages)
                        (funcall function time:*simulation*))))))

(defun forks-of-rides (rides moments seed)
  "Return how many forks were made in random rides, and what was wrong with them."
  (let ((forks 0) (troubles '()))
    (call-in-rides (lambda (simulation)
                     (incf forks)
                     (setf troubles (append (fork-trouble simulation 8 :continuations t) troubles)))
                   rides moments seed)
    (values forks troubles)))

(test forks.of-random-rides-go-their-ways
  (multiple-value-bind (forks troubles) (forks-of-rides 4 20 100)
    (is (= 80 forks))
    (is (null troubles) "~{~S~%~}" troubles)))

;;; Plans at random, over shared fluents and valves, that go wrong and begin anew.

(defun random-plan-text (things dice)
  "Return the form of a random plan over THINGS, three fluents and two valves, that never ends."
  `(destructuring-bind (f g h v w) ',things
     (declare (ignorable f g h v w))
     (rpl:with-policy (rpl:whenever (not f)
                        (rpl:wait-time 3)
                        (rpl:set-value f t)
                        (rpl:pulse g))
       (loop (rpl:handle-failure ((t () (rpl:wait-time 1) (return)))
               ,(if (base:chance .5 dice) (random-form 4 dice) (random-body 4 dice))
               (rpl:wait-time 2))))))

(defun call-in-random-plan (function moments seed)
  "Call FUNCTION with a simulation in which a random plan is under way, MOMENTS times."
  (let ((dice (base:make-dice seed "forks")) (driver:*trace-plans* t) (rpl:*runaway-limit* 2000)
        (base:*echo-output* (make-broadcast-stream)))
    (run:with-simulation (rover :seed seed)
      (driver:rpl-init-robot rover)
      (let ((things (list (fluent nil 'f) (fluent nil 'g) (fluent nil 'h)
                          (rpl:make-valve 'v) (rpl:make-valve 'w))))
        (driver:begin-plan (rpl:make-plan (random-plan-text things dice)))
        (loop repeat moments
              do (run:run-ticks (1+ (base:roll-index 6 dice)))
                 (base:take-messages)
                 (funcall function time:*simulation*))))))

(defun forks-of-random-plans (plans moments seed)
  "Return how many forks were made in random plans, and what was wrong with them."
  (let ((forks 0) (troubles '()))
    (loop for each from seed repeat plans
          do (call-in-random-plan (lambda (simulation)
                                    (incf forks)
                                    (setf troubles (append (fork-trouble simulation 10) troubles)))
                                  moments each))
    (values forks troubles)))

(test forks.of-random-plans-go-their-ways
  (multiple-value-bind (forks troubles) (forks-of-random-plans 10 6 1)
    (is (= 60 forks))
    (is (null troubles) "~{~S~%~}" troubles)))

;;; The shipped errands.

(defparameter *errands*
  '((ars-worlds:marvin ars-worlds:fetch-thing ((:color blue) (:substance plastic)) ((109 24)))
    (ars-worlds:robbie ars-worlds:tidy-room (((:type toy)) ((:type laundry)))
     ((5 5) (8 8) (12 5)))
    (ars-worlds:robbie ars-worlds:search-watchfully ((:type vase)) ((5 5) (20 12) (30 25)))
    (ars-worlds:gofer ars-worlds:patrol-places ((60 40) (20 40) (100 40))))
  "Lists (robot plan argument...).")

(defun forks-of-errands (moments ticks seed)
  "Return how many forks were made in the shipped errands, at MOMENTS with TICKS in between, and
what was wrong with them."
  (let ((forks 0) (troubles '()) (driver:*trace-plans* t))
    (loop for (robot . plan) in *errands*
          do (run:call-with-simulation
              (lambda ()
                (apply #'driver:begin-plan plan)
                (loop repeat moments
                      do (run:run-ticks ticks)
                         (base:take-messages)
                         (incf forks)
                         (setf troubles (append (fork-trouble time:*simulation* ticks) troubles))))
              robot :seed seed))
    (values forks troubles)))

(test forks.of-shipped-errands-go-their-ways
  (multiple-value-bind (forks troubles) (forks-of-errands 4 20 7)
    (is (= 16 forks))
    (is (null troubles) "~{~S~%~}" troubles)))

(test forks.stay-with-their-originals-for-long
  "A thousand ticks of an errand, tick for tick."
  (let ((driver:*trace-plans* t))
    (run:with-simulation (ars-worlds:marvin :seed 3)
      (driver:begin-plan 'ars-worlds:fetch-thing '((:color blue) (:substance plastic)) '((109 24)))
      (run:run-ticks 40)
      (is (null (fork-trouble time:*simulation* 1000))))))

(test forks.that-share-something-are-found-out
  "These tests can fail: here forks share their dice."
  (let ((method (defmethod base:copy-plan-value :around ((dice base:dice) fork)
                  (declare (ignore fork))
                  dice)))
    (unwind-protect
         (let ((troubles (nth-value 1 (forks-of-rides 1 10 100))))
           (is (find-if #'consp troubles) "what is shared")
           (is (find-if #'stringp troubles) "what comes of it"))
      (remove-method #'base:copy-plan-value method))))
