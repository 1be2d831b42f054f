;;;; beginners-unheard.lisp -- what kickers set for plans, tests in plans, fluents taken for values.

(in-package :ars-magna.tests)

(in-suite beginners)

;;; Kickers that set fluents of plans.

(defvar *bell* (rpl:create-fluent 'bell))

(defun ring-bell () (rpl:pulse *bell*))

(world:defkicker ring-at-times (thing) (:prob 1/5) (ring-bell))
(world:defkicker move-at-times (thing) (:prob 1/5) (world:kick-thing thing 1/10 0 nil))

(world:defmap belfry (10 10)
  (obj (bell :kickers (ring-at-times)) (5 5) ()))
(world:defmap garret (10 10)
  (obj (bell :kickers (move-at-times)) (5 5) ()))
(robot:defrobot ringer (belfry (3 3) 0))
(robot:defrobot mouse (garret (3 3) 0))

(test run-plan.hears-kickers
  (run:with-simulation (ringer)
    (is (equal '(:rang :succeeded)
               (multiple-value-list (driver:run-plan (plan-of (rpl:wait-for *bell*) :rang)))))
    (is-true (plusp (run:simulation-tick)))
    (is (string= "" (displayed)))))

(test run-plan.is-deadlocked-if-kickers-tell-nothing
  (run:with-simulation (mouse)
    (is (eq :deadlock
            (nth-value 1 (driver:run-plan (plan-of (rpl:wait-for *bell*) :rang)))))
    (is-true (has-words-p (displayed) "Deadlock"))))

;;; Checks of FiveAM in what a run calls.

(defun results-of-checks (function)
  "Return whether the checks in FUNCTION, as those of a test, passed: a list of truth values."
  (let ((test (gensym "CHECKS")))
    (eval `(5am:test (,test :suite nil) (funcall ,function)))
    (unwind-protect
         (let ((5am:*test-dribble* (make-broadcast-stream)) (5am:*on-failure* nil))
           (mapcar (lambda (result) (typep result '5am::test-passed)) (5am:run test)))
      (5am:rem-test test))))

(test checks.in-plans-and-continuations-count
  (let ((text nil) (done nil))
    (is (equal '(nil t nil)
               (results-of-checks
                (lambda ()
                  (run:with-simulation (ringer)
                    (driver:run-plan (plan-of (5am:is (= 1 2)) (5am:is (= 1 1))))
                    (command:robot-turn ringer 1/10 (lambda (&rest ignore)
                                                      (declare (ignore ignore))
                                                      (5am:is (= 3 4))
                                                      (setf done t)))
                    (run:run-ticks 20)
                    (setf text (displayed)))))))
    (is-true done)
    (is (not (search "ERROR" text)))))

;;; Fluents that are taken for their values.

(test experiments.take-no-fluent-for-its-value
  (flet ((errors (&rest clauses)
           (define-for-test-of clauses)
           (mapcar #'sixth (rows-of (experiment:run-experiment 'question :trials 1 :workers 1
                                                                         :stream nil)))))
    (is-true (has-words-p (first (errors '(:run t) '(:success *bell*)))
                          ":success" "(fluent-value ...)"))
    (is-true (has-words-p (first (errors '(:run t) '(:until *bell*))) ":until"))))

(defun define-for-test-of (clauses)
  (eval `(define-for-test (:robots ars-worlds:dot) ,@clauses)))

;;; Scripts show no style warnings.

(test doubts.are-plain-warnings-but-in-compiled-files
  (flet ((style-p ()
           (handler-case (base:warn-of-style "perhaps")
             (style-warning () t)
             (warning () nil))))
    (is (not (style-p)))
    (let ((*compile-file-truename* (or *compile-file-truename* #p"/x.lisp")))
      (is-true (style-p)))))

;;; Warnings in files.

(test warnings.of-a-map-read-its-file-once
  (let ((told 0))
    (uiop:with-temporary-file (:pathname path :stream out :type "lisp")
      (format out "(in-package :ars-user)~%(defmap walled (60 60) (rect (0 0) (40 40) bricks 5)~%~
                   ~{(obj t~D (0.5 0.5) ((:size 1)))~%~})~%"
              (loop for i below 60 collect i))
      :close-stream
      (is (> 5 (calls-of 'definitions::find-definitions-in-text
                         (lambda ()
                           (handler-bind ((warning (lambda (warning)
                                                     (incf told)
                                                     (muffle-warning warning))))
                             (load path)))))))
    (is (<= 60 told))))
