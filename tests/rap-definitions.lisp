;;;; rap-definitions.lisp -- clauses without use, variables without values, orders of steps.

(in-package :ars-magna.tests.rap)

(def-suite* ars-magna.tests::rap-definitions :in ars-magna.tests::ars-magna)

(defun method-mistake (&rest clauses)
  (rap-mistake `(define-rap (index (foo ?x)) (method ,@clauses))))

(test rap-definitions.variables-without-values-are-refused
  (loop for (use . contexts)
          in '(((primitive (note-rap ?y)) (not (at ?x ?y)) (or (at ?x ?y) (in ?x ?z)))
               ((primitive (wait-time 1) (note-rap y)) (not (at ?x ?y)))
               ((task-net (a (rap-work ?y 1))) (not (at ?x ?y)) (or (at ?y) (and)))
               ((primitive 1)
                (and (< ?y 3) (at ?y)) (and (test (plusp ?y)) (at ?y)) (= ?x (?y)) (= ?y ?z)
                (and (test (plusp y)) (at ?y)) (within ?y (at ?x)) (not (and (< ?y 3) (at ?y)))))
        do (dolist (context contexts)
             (let ((mistake (method-mistake `(context ,context) use)))
               (is (and mistake (search "value" mistake) (search "define-rap foo" mistake))
                   "~S ~S: ~A" context use mistake))))
  (is (search "the result ?y" (rap-mistake '(define-rap (index (foo => ?y)) (succeed (not (at ?y)))
                                             (method (primitive 1)))))))

(test rap-definitions.clauses-without-use-are-refused
  (loop for (clauses . text)
          in '((((index (bar))) . "only one clause index")
               (((attempts 1) (attempts 3)) . "only one clause attempts")
               (((succeed)) . "something after succeed")
               (((resources)) . "something after resources")
               (((resources "body")) . "names, or variables")
               (((attempts)) . "something after attempts")
               (((method (context) (primitive 1))) . "something after context")
               (((method (primitive 1) (task-net))) . "either a clause")
               (((method m (primitive 1)) (method m (primitive 2))) . "is called m")
               (((method method-3 (primitive 1)) (method (primitive 2))) . "is called method-3"))
        do (let ((mistake (rap-mistake `(define-rap (index (foo)) (method (primitive 1))
                                          ,@clauses))))
             (is (and mistake (search text mistake)) "~S: ~A" clauses mistake))))

(define-rap (index (rap-values ?x))
  (method (context (and (not (none ?y)) (or (at ?x ?n) (in ?x ?n)) (= ?m 7) (test (< n ?m 9))))
          (primitive (let ((y 1)) (note-rap (list x n m y))))))

(test rap-definitions.variables-with-values-are-accepted
  (is (equal '((0 (cup 3 7 1))) (rap-notes (memory-add '(at cup 9))
                                           (memory-add '(in cup 3))
                                           (run-plan 'rap-values 'cup)))))

(test rap-definitions.steps-that-could-never-begin-are-refused
  (loop for (net . tags)
          in '((((a (b) (for c)) (c (d) (for a)) (e (b) (for a)) (f (b))) . "a and c could")
               (((a (b) (wait-for (q) c)) (c (d) (wait-for (r) a))) . "a and c could")
               (((a (b) (wait-for (q) c)) (c (d) (for a))) . "a and c could")
               (((sequence (a (b)) (c (d))) (e (b) (for a)) ) . nil)
               (((a (b) (wait-for (q) c) (until-start c)) (c (d) (until-end a))) . nil)
               (((a (b ?y) (for c)) (c (d => ?y))) . "a and c could")
               (((a (b ?y => ?z)) (c (d ?z => ?y))) . "a and c could"))
        do (let ((mistake (method-mistake `(task-net ,@net))))
             (is (if tags (search tags mistake) (null mistake)) "~S: ~A" net mistake))))

(define-rap (index (rap-count ?n => ?m)) (method (primitive (wait-time 1) (setf m (1+ n)))))

(define-rap (index (rap-sum))
  (method (context (start ?n))
          (task-net (late (rap-work ?m 1))
                    (first (rap-count ?n => ?m))
                    (other (rap-work ?n 1)))))

(define-rap (index (rap-chain))
  (method (task-net (sequence (one (rap-double 1 => ?n)) (two (rap-count ?n => ?n))
                              (three (rap-count ?n => ?n)) (four (rap-work ?n 1))))))

(test rap-definitions.a-step-that-uses-a-result-comes-after-the-step-that-gives-it
  (is (equal '((1 4) (2 5)) (rap-notes (memory-add '(start 4)) (run-plan 'rap-sum))))
  (is (equal '((3 4)) (rap-notes (run-plan 'rap-chain)))))

(define-rap (index (rap-net-6))
  (method (task-net (b (rap-work b 1))
                    (pause (rap-work pause 3) (for signal))
                    (signal (rap-signal 3) (wait-for (signal) b)))))

(test rap-definitions.a-step-waits-for-an-event-while-the-other-goes-on
  "Not before the other has begun, even if the query holds already."
  (is (equal '((3 pause) (4 b) (10 :over))
             (rap-notes (memory-add '(signal)) (run-plan 'rap-net-6)))))

(define-rap (index (rap-leave ?x => ?y))
  (resources arm)
  (method (resources hand)
          (primitive (setf y 1)
                     (dolist (n '(1 2 3)) (wait-time 1) (setf y n) (when (= n 2) (return)))
                     (unless (eq x 'on) (return "not a failure"))
                     (setf y :end))))

(test rap-definitions.return-ends-a-primitive-and-the-method-succeeds
  (in-rap-run
    (is (eql 2 (run-plan 'rap-leave 'off)))
    (is (eq :end (run-plan 'rap-leave 'on)))
    (is (eql 4 (simulation-tick)))))
