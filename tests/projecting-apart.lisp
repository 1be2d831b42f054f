;;;; projecting-apart.lisp -- what worlds of belief cannot reach, and the cost of rollouts.

(in-package :ars-test-projecting)
(in-readtable :nisp)

(in-suite projecting)

(defrobot second-runner (court (12 10) 0))

;;; Global variables could lead from a world of belief to the true run.

(defvar *true-runner* nil)
(defvar *true-ball* nil)
(defvar *true-task* nil)
(defvar *true-fluent* (create-fluent 'true-fluent nil))
(defvar *trespass* nil "What a plan is to do to the true run, a function.")

(def-interp-proc trespass ()
  (funcall *trespass*)
  (wait-time 2)
  :done)

(defmacro on-true-court (&body body)
  "Run BODY on a court whose runner, ball and waiting plan global variables have."
  `(on-court (:clean t)
     (let* ((*true-fluent* (create-fluent 'true-fluent nil))
            (*true-runner* runner)
            (*true-ball* (find-thing 'ball))
            (*true-task* (begin-plan (interp-lambda () (wait-for *true-fluent*) :woken))))
       (run-ticks 1)
       ,@body)))

(defun trespassed (function)
  "Return how a rollout of a plan that calls FUNCTION ends in a world believed in."
  (let* ((*trespass* function)
         (projection (project 'trespass :trials 1 :world #'believed-court)))
    (rollout-failure (first (projection-rollouts projection)))))

(test project.lets-no-world-believed-in-change-the-true-run
  (on-true-court
    (let ((digest (state-digest)) (simulation (current-simulation)))
      (dolist (deed (list (lambda () (move-thing *true-ball* '(2 2)))
                          (lambda () (destroy-thing *true-ball*))
                          (lambda () (set-attribute *true-ball* :color 'blue))
                          (lambda () (place-robot *true-runner* 2 2 0))
                          (lambda () (robot-turn *true-runner* 1 nil))
                          (lambda () (robot-place *true-runner* nil))
                          (lambda () (think *true-runner* 5 nil))
                          (lambda () (set-thinking :charged simulation))
                          (lambda () (end-plan *true-task*))
                          (lambda () (run-ticks 1 simulation))))
        (let ((failure (trespassed deed)))
          (is (typep failure 'lisp-failure))
          (is (search "This object belongs to another run" (princ-to-string failure))
              "~A" failure)))
      (is (= digest (state-digest)))
      (run-ticks 5)
      (is (eq :waiting (task-state *true-task*)))
      (is (eq *true-ball* (find-thing 'ball))))))

(test project.refuses-changes-by-the-function-that-makes-the-world
  (on-true-court
    (let ((projection (project '(toss 1) :trials 1
                               :world (lambda (run seed)
                                        (move-thing *true-ball* '(2 2))
                                        (believed-court run seed)))))
      (is (= 0 (projection-successes projection)))
      (is (= 20 (thing-x *true-ball*))))))

(test project.lets-worlds-believed-in-do-what-they-like-among-themselves
  (flet ((meddle ()
           (let ((outer runner))
             (with-simulation (runner) (move-thing (find-thing 'ball) '(3 3)))
             (robot-turn outer 1 nil))))
    (on-true-court
      (is (null (trespassed #'meddle))))))

(def-interp-proc count-in-fluent ()
  (set-value *true-fluent* (+ 1 (or (fluent-value *true-fluent*) 0)))
  (wait-for *true-fluent*)
  (fluent-value *true-fluent*))

(test project.gives-each-world-believed-in-its-own-fluents
  (on-true-court
    (is (equal '(1 1 1)
               (mapcar #'rollout-value
                       (projection-rollouts
                        (project 'count-in-fluent :trials 3 :world #'believed-court)))))
    (run-ticks 3)
    (is (null (fluent-value *true-fluent*)))
    (is (eq :waiting (task-state *true-task*)))))

;;; What rollouts cost.

(def-interp-proc fail-often (count)
  (n-times count
    (handle-failure ((:nothing () (return 1)))
      (fail :class :nothing))))

(def-interp-proc compute-often (count)
  (n-times count (with-charge (0) (+ 1 (* 2 3)))))

(def-interp-proc pay-often (count)
  (n-times count (charge-steps 20)))

(defun ticks-of (plan)
  "Return at which tick PLAN ends where ten steps of plans take a tick."
  (on-court (:thinking '(:charged :budget 10))
    (run-plan plan)))

(test project.charges-for-rollouts-what-plans-are-charged-for
  "Failures, what has a price, and what says what it costs, count in rollouts as in the run."
  (loop for (done foreseen)
          in (list (list (interp-lambda () (fail-often 20) (plan-time))
                         (interp-lambda () (project '(fail-often 20) :trials 1) (plan-time)))
                   (list (interp-lambda () (compute-often 20) (plan-time))
                         (interp-lambda () (project '(compute-often 20) :trials 1) (plan-time)))
                   (list (interp-lambda () (pay-often 20) (plan-time))
                         (interp-lambda () (project '(pay-often 20) :trials 1) (plan-time))))
        do (is (< (* .7 (ticks-of done)) (ticks-of foreseen) (+ 3 (* 1.3 (ticks-of done))))
               "~D ticks if done, ~D if foreseen" (ticks-of done) (ticks-of foreseen))))

(test project.charges-for-worlds-believed-in-alike
  (is (< (ticks-of (interp-lambda ()
                     (project '(fail-often 20) :trials 1 :world #'believed-court)
                     (plan-time)))
         (+ 3 (ticks-of (interp-lambda () (fail-often 20) (plan-time)))))))

;;; Costs without bounds.

(defun infinity ()
  "Return positive infinity."
  (ars-magna.base:bits-to-double #x7FF0000000000000))

(defun no-number ()
  "Return the float that is no number."
  (ars-magna.base:bits-to-double #x7FF8000000000000))

(test try-best.takes-an-infinite-cost-for-the-worst
  (flet ((chosen (cost)
           (on-court ()
             (first (told-of (try-best (:trials 2 :cost cost)
                               (seq (wait-time 30) :slow)
                               (seq (wait-time 3) :quick)))))))
    (is (eq :quick (chosen (lambda () (if (> (simulation-tick) 10) (infinity) 1)))))
    (is (eq :slow (chosen (lambda () (if (> (simulation-tick) 10) 1 (infinity))))))
    (is (eq :slow (chosen (lambda () (if (> (simulation-tick) 10) 1 (coerce (infinity)
                                                                            'single-float))))))
    (is (eq :slow (chosen #'infinity)))))

(test project.tells-an-infinite-cost
  (on-court ()
    (let ((projection (project '(toss 1) :trials 2 :cost #'infinity)))
      (is (= 2 (projection-successes projection)))
      (is (eql (infinity) (rollout-cost (first (projection-rollouts projection))))))))

(test project.reports-costs-that-are-no-numbers
  (dolist (cost (list (no-number) (ars-magna.base:bits-to-double #xFFF0000000000000)))
    (on-court ()
      (is (= 0 (projection-successes (project '(toss 1) :trials 2 :cost (lambda () cost)))))
      (let ((texts (mapcar #'message-text (take-messages))))
        (is (search "in 2 of 2 rollouts" (first texts)))
        (is (search "positive infinity for the worst" (first texts)))))))

;;; Tasks.

(test project.takes-tasks-of-the-plans-of-every-robot
  (with-simulation ((runner second-runner))
    (rpl-init-robot runner)
    (let ((task (begin-plan 'toss 1 9)))
      (rpl-init-robot second-runner)
      (is (= 3 (length (projection-rollouts (project task :trials 3))))))))

(test project.says-that-worlds-believed-in-know-no-tasks
  (on-true-court
    (refused ("with :world there are no tasks")
      (project *true-task* :trials 1 :world #'believed-court))
    (is (search "with :world there are no tasks"
                (told-error (interp-lambda ()
                              (project *true-task* :trials 1 :world #'believed-court)))))))
