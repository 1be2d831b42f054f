;;;; rap-resources.lisp -- resources belong to a robot: its plans and goals take turns.

(in-package :ars-magna.tests.rap)

(def-suite* ars-magna.tests::rap-resources :in ars-magna.tests::ars-magna)

(defrobot rap-helper (rap-floor (4 12) 0))

(def-interp-proc hold-arm (who ticks)
  (with-resources (arm)
    (note-rap who)
    (wait-time ticks)))

(define-rap (index (hold-twice ?who))
  (resources arm)
  (method (task-net (a (hold-arm ?who 2)) (b (hold-arm ?who 2)))))

(define-rap (index (hold-thing ?what))
  (resources ?what)
  (method (primitive (note-rap what) (wait-time 2))))

(test rap-resources.plans-take-turns
  (is (equal '((1 a) (4 b)) (rap-notes (begin-plan 'hold-arm 'a 3)
                                       (begin-plan 'hold-arm 'b 3)
                                       (run-ticks 10))))
  (is (equal '((1 a) (1 b)) (rap-notes (begin-plan 'hold-thing 'a)
                                       (begin-plan 'hold-thing 'b)
                                       (run-ticks 10)))))

(test rap-resources.branches-take-turns
  (is (equal '((0 a) (3 b))
             (rap-notes (run-plan (interp-lambda () (par (hold-arm 'a 3) (hold-arm 'b 3))))))))

(test rap-resources.a-plan-and-a-goal-take-turns
  "The timer of a suspended task goes on."
  (flet ((noted (priority)
           (rap-notes (install-goal '(hold-arm goal 2) priority)
                      (begin-plan 'hold-arm 'plan 5)
                      (run-ticks 1)
                      (begin-plan 'work-on-agenda)
                      (run-ticks 10))))
    (is (equal '((1 plan) (6 goal)) (noted 0)))
    (is (equal '((1 plan) (2 goal)) (noted 1)))))

(test rap-resources.parts-of-an-owner-take-turns
  (is (equal '((1 a) (3 a) (5 b) (7 b)) (rap-notes (begin-plan 'hold-twice 'a)
                                                   (begin-plan 'hold-twice 'b)
                                                   (run-ticks 10)))))

(test rap-resources.each-robot-has-its-own
  (let ((*rap-notes* '()))
    (with-simulation ((rapper rap-helper) :seed 1)
      (begin-plan 'hold-arm 'a 3 :robot 'rapper)
      (begin-plan 'hold-arm 'b 3 :robot 'rap-helper)
      (begin-plan (interp-lambda () (on-robot ('rap-helper) (hold-arm 'c 1))) :robot 'rapper)
      (run-ticks 10))
    (is (equal '((1 a) (1 c) (2 b)) (reverse *rap-notes*)))))

(test rap-resources.no-run-is-needed
  (is (eql 3 (run-plan-alone (interp-lambda ()
                               (par (with-resources (arm) (wait-time 2))
                                    (with-resources (arm) (wait-time 1)))
                               (round (plan-time)))))))

(test rap-resources.forks-and-rewinds-are-exact
  "Also if a resource is first taken in a fork, or after the moment to which a run is rewound."
  (with-simulation (rapper :seed 1 :keep t)
    (let ((*rap-notes* '()))
      (flet ((ahead ()
               (setf *rap-notes* '())
               (begin-plan 'hold-twice 'b)
               (begin-plan 'hold-thing 'hall)
               (run-ticks 12)
               (list (reverse *rap-notes*) (state-digest))))
        (begin-plan 'hold-arm 'a 5)
        (run-ticks 3)
        (let ((now (state-digest)) (there (with-fork () (ahead))))
          (is (equal '((4 hall) (6 b) (8 b)) (first there)))
          (is (equal now (state-digest)))
          (is (equal there (ahead)))
          (rewind 12)
          (is (equal there (ahead))))))))
