;;;; rpl-plans.lisp -- what the constructs of the plan language mean.

(in-package :ars-magna.tests)
(in-suite rpl)

(defmacro with-log ((log) &body body)
  "Run BODY, in which (LOG item) notes an item and the tick; return what was noted, in order."
  `(let ((items '()))
     (flet ((,log (item) (push (list item (rpl:plan-time)) items)))
       (declare (ignorable #',log))
       ,@body)
     (reverse items)))

;;; Sequence and parallel constructs.

(test seq.runs-its-steps-in-order
  (is (equal '((:a 0) (:b 2) (:c 5))
             (with-log (note)
               (is (eq :last (plan-value (rpl:seq (note :a) (rpl:wait-time 2) (note :b)
                                                  (rpl:wait-time 3) (note :c) :last)))))))
  (is (null (plan-value (rpl:seq)))))

(test par.ends-with-the-last-and-has-the-value-of-the-last-written
  (is (equal '((1 1) (2 2) (3 3))
             (with-log (note)
               (is (eq :b (plan-value (rpl:par (rpl:seq (rpl:wait-time 3) (note 3) :a)
                                               (rpl:seq (rpl:wait-time 1) (note 1))
                                               (rpl:seq (rpl:wait-time 2) (note 2) :b))))))))
  (is (null (plan-value (rpl:par)))))

(test par.starts-its-branches-from-left-to-right
  (is (equal '((1 0) (2 0) (3 0))
             (with-log (note) (plan-value (rpl:par (note 1) (rpl:seq (note 2)) (note 3)))))))

(test par.fails-at-once-and-evaporates-the-others
  (let ((finished nil))
    (is (eq :lost (rpl:failure-class
                   (plan-failure-of
                     (rpl:par (rpl:seq (rpl:wait-time 5) (setf finished t))
                              (rpl:seq (rpl:wait-time 1) (rpl:fail :class :lost)))))))
    (is (not finished))))

(test par.branches-talk-through-fluents
  (let ((ball (fluent)))
    (is (eq :pong (plan-value
                    (rpl:par (rpl:seq (rpl:set-value ball :ping)
                                      (rpl:wait-for (eq ball :pong)))
                             (rpl:seq (rpl:wait-for (eq ball :ping))
                                      (rpl:set-value ball :pong))))))))

(test par.the-final-states-of-its-tasks
  (let (tasks)
    (plan-failure-of
      (rpl:with-tags
        (setf tasks (list producer worker-1 worker-2 worker-3))
        (rpl:par (:tag producer (rpl:wait-time 1) (rpl:fail))
                 (:tag worker-1
                   (rpl:par (:tag worker-2 (rpl:wait-time 10))
                            (:tag worker-3 (rpl:wait-time 10)))))))
    (is (equal '(:failed :evaporated :evaporated :evaporated) (mapcar #'rpl:task-state tasks)))
    (is (every #'rpl:task-over-p tasks))))

(test pursue.ends-with-the-first
  (is (equal '((:fast 1))
             (with-log (note)
               (is (eq :won (plan-value (rpl:pursue (rpl:seq (rpl:wait-time 3) (note :slow))
                                                    (rpl:seq (rpl:wait-time 1) (note :fast)
                                                             :won)))))))))

(test pursue.fails-with-the-first-that-fails
  (is (eq :first (rpl:failure-class
                  (plan-failure-of
                    (rpl:pursue (rpl:seq (rpl:wait-time 1) (rpl:fail :class :first))
                                (rpl:wait-time 2)
                                (rpl:seq (rpl:wait-time 1) (rpl:fail :class :second))))))))

(test pursue.winner-and-loser-woken-at-once
  "The winner comes first, so the loser's failure does not count."
  (let ((f (fluent)))
    (is (eq :winner (plan-value
                      (rpl:pursue (rpl:seq (rpl:wait-for f) :winner)
                                  (rpl:seq (rpl:wait-for f) (rpl:fail))
                                  (rpl:seq (rpl:wait-time 1) (rpl:set-value f t)
                                           (rpl:wait-time 5))))))))

(test try-all.needs-one-success
  (is (eq :third (plan-value (rpl:try-all (rpl:fail)
                                          (rpl:seq (rpl:wait-time 1) (rpl:fail))
                                          (rpl:seq (rpl:wait-time 2) :third)
                                          (rpl:seq (rpl:wait-time 3) :fourth)))))
  (let ((failure (plan-failure-of (rpl:try-all (rpl:seq (rpl:wait-time 2) (rpl:fail :class :b))
                                               (rpl:seq (rpl:wait-time 1) (rpl:fail :class :a))))))
    (is (typep failure 'rpl:composite-failure))
    (is (equal '(:a :b) (mapcar #'rpl:failure-class (rpl:composite-failures failure)))))
  (is (typep (plan-failure-of (rpl:try-all)) 'rpl:composite-failure)))

(test try-in-order.tries-until-one-succeeds
  (is (equal '((:a 0) (:b 0) (:c 2) (:d 2))
             (with-log (note)
               (is (= 4 (plan-value
                          (rpl:try-in-order
                           (rpl:seq (note :a) (rpl:fail) (note 1))
                           (rpl:seq (note :b) (rpl:wait-time 2) (rpl:fail) (note 2))
                           (rpl:par (note :c) (rpl:fail))
                           (rpl:seq (note :d) 4)
                           (note :e))))))))
  (let ((failure (plan-failure-of (rpl:try-in-order (rpl:fail :class :a)
                                                    (rpl:fail :class :b)))))
    (is (equal '(:a :b) (mapcar #'rpl:failure-class (rpl:composite-failures failure))))))

(test try-one.the-runner-chooses-the-order
  (flet ((order (dice)
           (let ((tried '()))
             (rpl:run-plan-alone (rpl:interp-lambda ()
                                   (rpl:try-one (rpl:seq (push 1 tried) (rpl:fail))
                                                (rpl:seq (push 2 tried) (rpl:fail))
                                                (rpl:seq (push 3 tried) (rpl:fail))
                                                (rpl:seq (push 4 tried) (rpl:fail))))
                                 :runner (rpl:make-plan-runner :dice dice :on-end #'identity))
             (reverse tried))))
    (is (equal '(1 2 3 4) (order nil)))
    (is (equal (order (base:make-dice 5)) (order (base:make-dice 5))))
    (is (not (equal '(1 2 3 4) (order (base:make-dice 5)))))))

(test try-each-in-order.takes-the-first-element-that-works
  (is (= 2 (plan-value (rpl:try-each-in-order (n '(1 2 3))
                         (rpl:wait-time 1)
                         (unless (evenp n) (rpl:fail))
                         n))))
  (is (= 3 (length (rpl:composite-failures
                    (plan-failure-of (rpl:try-each-in-order (n #(1 2 3)) (rpl:fail))))))))

(test par-loop.each-element-has-its-own-variables
  (is (equal '((1 1) (2 2) (3 3))
             (with-log (note)
               (is (= 20 (plan-value
                           (rpl:par-loop (n '(3 1 2))
                             (let ((twice (* 10 n)))
                               (rpl:wait-time n)
                               (note n)
                               twice)))))))))

;;; Repetition.

(test loop.tests-before-each-turn
  (is (equal '((1 0) (2 2) (3 4))
             (with-log (note)
               (plan-value (let ((n 0))
                             (loop until (= n 3) (incf n) (note n) (rpl:wait-time 2)))))))
  (is (= 0 (plan-value (let ((n 0)) (loop until t (incf n)) n))))
  (is (= 3 (plan-value (let ((n 0)) (loop while (< n 3) (rpl:wait-time 1) (incf n)) n))))
  (let ((done (fluent)))
    (is (= 4 (plan-value (let ((n 0))
                           (loop until done
                                 (rpl:wait-time 1)
                                 (when (= 4 (incf n)) (rpl:set-value done t)))
                           n))))))

(test loop.can-be-left-by-return
  (is (eq :out (plan-value (loop (rpl:wait-time 1)
                                 (when (= 3 (rpl:plan-time)) (return :out)))))))

(test loop.that-never-waits-lets-others-run
  (is (eq :others (plan-value (let ((stop nil))
                                (rpl:par (loop until stop)
                                         (rpl:seq (setf stop t) :others)))))))

(test n-times.turns-at-most-so-often
  (is (= 6 (plan-value (rpl:n-times 3 (rpl:wait-time 2)) (rpl:plan-time))))
  (is (= 2 (plan-value (let ((n 0)) (rpl:n-times 5 until (= n 2) (incf n)) n))))
  (is (= 3 (plan-value (let ((n 0) (turns (fluent 3))) (rpl:n-times turns (incf n)) n)))))

(test dolist-and-dotimes.wait-and-return
  (is (equal '((:a 1) (:b 2))
             (with-log (note)
               (is (eq :left (plan-value (dolist (item '(:a :b :c))
                                           (rpl:wait-time 1)
                                           (note item)
                                           (when (eq item :b) (return :left)))))))))
  (is (= 9 (plan-value (let ((sum 0))
                         (dotimes (i 3 (+ sum 6)) (rpl:wait-time 1) (incf sum i)))))))

(test loop.closures-keep-their-turns-variables
  (is (equal '(0 1 2)
             (mapcar #'funcall
                     (plan-value (let ((closures '()))
                                   (dotimes (i 3)
                                     (rpl:wait-time 1)
                                     (push (lambda () i) closures))
                                   (reverse closures)))))))
