;;;; forking-plans.lisp -- plans forked at each tick, for all constructs.

(in-package :ars-magna.tests)
(in-suite forking)

;;; Each plan is forked at each of its ticks: fork, original and a fork's fork must end alike.

(defun endings (plan arguments ticks)
  "Run PLAN with ARGUMENTS for TICKS. Return how it ends: unforked, and in forks made at each tick."
  (run:with-simulation (rover :seed 5 :clean t)
    (let ((task (apply #'driver:begin-plan plan arguments)) (forks '()))
      (flet ((ending (task) (list (rpl:task-state task) (princ-to-string (rpl:task-result task))))
             (task-in (fork) (run:counterpart task fork)))
        (loop repeat ticks
              do (let ((fork (run:fork-simulation)))
                   (when (task-in fork) (push (list fork (task-in fork)) forks)))
                 (run:run-ticks 1))
        (cons (ending task)
              (loop for (fork task) in (reverse forks)
                    do (run:run-ticks ticks fork)
                    collect (ending task)))))))

(defmacro forked-at-each-tick (expected ticks &body plan)
  "Check that PLAN comes to EXPECTED within TICKS, forked or not."
  `(let ((endings (endings (rpl:interp-lambda () ,@plan) '() ,ticks)))
     (is (equal (list :succeeded (princ-to-string ,expected)) (first endings)))
     (is (rest endings))
     (is (every (lambda (ending) (equal ending (first endings))) endings) "~S" endings)))

(rpl:def-interp-proc count-deeply (depth)
  "Wait at the bottom of DEPTH calls."
  (if (zerop depth)
      (rpl:seq (rpl:wait-time 3) 0)
      (1+ (count-deeply (1- depth)))))

(test plans.deep-in-calls
  (forked-at-each-tick 1900 5 (count-deeply 1900)))

(test plans.with-variables-that-closures-share
  (forked-at-each-tick '(6 6 3) 12
    (let* ((count 0) (turns 0)
           (more (rpl:interp-lambda (by) (rpl:wait-time by) (incf count by)))
           (tell (lambda () count)))
      (labels ((again (n)
                 (when (plusp n)
                   (rpl:seq (incf turns) (rpl:call-plan more n) (again (1- n))))))
        (again 3)
        (list count (funcall tell) turns)))))

(test plans.that-clean-up-and-retry
  (forked-at-each-tick '(:cleaned 3) 20
    (let ((tries 0) (cleaned nil))
      (rpl:with-retry-counters ((slips 2))
        (rpl:handle-failure ((:broken () (rpl:do-retry slips (rpl:retry))))
          (incf tries)
          (rpl:evap-protect (rpl:seq (rpl:wait-time 1)
                                     (when (< tries 3) (rpl:fail :class :broken)))
                            (rpl:seq (rpl:wait-time 2) (setf cleaned :cleaned)))))
      (list cleaned tries))))

(test plans.side-by-side-and-watched
  (forked-at-each-tick '((:a :b) :first 2 :late) 30
    (let ((bell (rpl:create-fluent 'bell)) (rings 0))
      (rpl:pursue
        (rpl:whenever bell (incf rings) (rpl:wait-time 1))
        (rpl:seq
          (list (rpl:par-at-least 2 (rpl:seq (rpl:wait-time 9) :c)
                                    (rpl:seq (rpl:wait-time 1) (rpl:pulse bell) :a)
                                    (rpl:seq (rpl:wait-time 4) (rpl:pulse bell) :b))
                (rpl:try-in-order (rpl:seq (rpl:wait-time 1) :first) :second)
                (rpl:seq (rpl:wait-time 2) rings)
                (rpl:handle-failure ((t () (return :late)))
                  (rpl:with-deadline (2) (rpl:wait-time 9)))))))))


(test plans.that-block-suspend-and-follow-others
  (forked-at-each-tick '((:slow 10) :succeeded (:second :first)) 30
    (let ((times '()) (order '()))
      (rpl:with-tags
        (rpl:par
          (:tag slow (rpl:seq (rpl:wait-time 2) (push (rpl:plan-time) times) :slow))
          (rpl:seq (rpl:suspend slow) (rpl:wait-time 5) (rpl:wake-up slow))
          (rpl:seq (rpl:wait-for (rpl:fl-funcall #'eq (rpl:task-status slow) :succeeded))
                   (rpl:wait-time 4)
                   (push (rpl:plan-time) times)))
        (let ((status (rpl:fluent-value (rpl:task-status slow))))
          (rpl:partial-order ((:tag one (rpl:seq (rpl:wait-time 3) (push :first order)))
                              (:tag two (rpl:seq (rpl:wait-time 1) (push :second order))))
            (:order one two))
          (list (list :slow (first times)) status order))))))

(rpl:def-goal (rpl:achieve (turned-by ?angle))
  (driver:rpl-robot-turn angle)
  (rpl:wait-for driver:robot-stopped*)
  (rpl:succeed-with :turned))

(rpl:define-task-variable *haste* 1 "How long a plan waits.")

(test plans.with-goals-places-and-task-variables
  (forked-at-each-tick '(:turned 3 :there) 40
    (let ((where (rpl:create-fluent 'where :home)))
      (list (rpl:achieve '(turned-by 1))
            (rpl:with-task-variables ((*haste* 3)) (rpl:wait-time *haste*) *haste*)
            (rpl:pursue
              (rpl:at-location (:shop :there (eq where :shop)
                                      :go (rpl:seq (rpl:wait-time 3) (rpl:set-value where :shop)))
                (rpl:wait-time 4)
                :there)
              (rpl:seq (rpl:wait-time 5) (rpl:set-value where :away) (rpl:wait-time 30)))))))

(test plans.at-every-command
  "Forked in the midst of commands of each family, with tracks begun and hands in boxes."
  (run:with-simulation (ars-worlds:robbie :seed 2)
    (driver:begin-plan 'ars-worlds:tidy-room '(((:type toy)) ((:type laundry)))
                       '((5 5) (8 8) (12 5)))
    (loop repeat 60
          do (run:run-ticks 3)
             (base:take-messages)
             (let ((fork (run:fork-simulation)))
               (is (null (shared-by time:*simulation* fork)))
               (run:release-fork fork)))))

(defparameter *sharing-plan*
  '(let* ((count 0) (more (rpl:interp-lambda (by) (rpl:wait-time by) (incf count by)))
          (also (lambda () (incf count 10))) (list (list 1)))
    (flet ((add () (push count list)))
      (rpl:call-plan more 2)
      (rpl:wait-time 1)
      (funcall also)
      (add)
      (rpl:call-plan more 2)
      (list count list)))
  "The text of a plan whose functions share variables.")

(test plans.made-by-programs
  "Interpreted or compiled."
  (dolist (compile '(nil t))
    (let ((endings (endings (rpl:make-plan *sharing-plan* :compile compile) '() 12)))
      (is (equal '(:succeeded "(14 (12 1))") (first endings)))
      (is (every (lambda (ending) (equal ending (first endings))) endings) "~S" endings))))

(test plans.may-have-failed-with-a-backquoted-form
  (run:with-simulation (ars-worlds:robbie :seed 2)
    (driver:run-plan (rpl:interp-lambda (color) (rpl:fail :class :lost :color `((:color ,color))))
                     'red)
    (run:run-ticks 1)
    (let ((digest (run:state-digest time:*simulation*)))
      (run:with-fork ()
        (is (= digest (run:state-digest time:*simulation*)))))))
