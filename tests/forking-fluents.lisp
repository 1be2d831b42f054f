;;;; forking-fluents.lisp -- fluents and valves in forks.

(in-package :ars-magna.tests)
(in-suite forking)

(defvar *gong* nil "A fluent that code gets at by a global variable.")
(defvar *both* nil "A network over *GONG* and another fluent.")
(defvar *row* nil "A vector of fluents.")
(defvar *door* nil "A valve.")

(rpl:def-interp-proc heed-gong (own)
  "Note what becomes of the global fluents, and of OWN, until *BOTH* is true twice."
  (let ((seen '()))
    (rpl:pursue
      (rpl:whenever *gong* (push (list (rpl:plan-time) :gong (rpl:fluent-value *gong*)) seen))
      (rpl:whenever own (push (list (rpl:plan-time) :own) seen))
      (rpl:whenever (rpl:fl-value-changed (aref *row* 1))
        (push (list (rpl:plan-time) :row (rpl:fluent-value (aref *row* 1))) seen))
      (rpl:seq (rpl:wait-for *both*)
               (rpl:wait-time 1)
               (rpl:wait-for (and *both* (not (aref *row* 0))))))
    (reverse seen)))

(defun call-with-gong (function)
  "Call FUNCTION with a fluent where a plan, and the global variables, heed fluents."
  (run:with-simulation (rover :seed 1)
    (driver:rpl-init-robot rover)
    (let* ((own (rpl:create-fluent 'own))
           (*gong* (rpl:create-fluent 'gong))
           (*row* (vector (rpl:create-fluent 'first) (rpl:create-fluent 'second 0)))
           (*both* (rpl:fl-funcall (lambda (one other) (and one other)) *gong* own))
           (*door* (rpl:make-valve 'door)))
      (driver:begin-plan 'heed-gong own)
      (run:run-ticks 2)
      (funcall function own))))

(defmacro with-gong ((own) &body body)
  `(call-with-gong (lambda (,own) (declare (ignorable ,own)) ,@body)))

(defun ring-on (own ticks)
  "Change all fluents, of the run that we are in, in the course of TICKS and more. Return what its
plan has seen."
  (let ((task (first (driver:plans))))
    (rpl:set-value *gong* :loud)
    (run:run-ticks ticks)
    (rpl:pulse own)
    (rpl:set-value (aref *row* 1) 7)
    (run:run-ticks ticks)
    (rpl:set-value *gong* nil)
    (run:run-ticks ticks)
    (rpl:set-value own t)
    (rpl:set-value *gong* t)
    (run:run-ticks ticks)
    (list (rpl:task-result task) (rpl:fluent-value *gong*) (rpl:fluent-value *both*))))

(test fluents.of-a-fork-are-its-own-by-every-road
  (with-gong (own)
    (let* ((one (run:with-fork () (ring-on own 3)))
           (slow (run:with-fork () (ring-on own 5)))
           (again (run:with-fork () (run:with-fork () (ring-on own 3)))))
      (is (null (rpl:fluent-value *gong*)))
      (is (null (rpl:fluent-value own)))
      (is (eql 0 (rpl:fluent-value (aref *row* 1))))
      (is (consp (first one)) "the plan in the fork has ended: ~S" one)
      (is (equal one again))
      (is (not (equal one slow)))
      (is (equal one (ring-on own 3))))))

(test fluents.changed-later-are-in-forks-as-they-were
  "Also those that no plan knows, and whose fork asks for them only after the change."
  (run:with-simulation (rover :seed 1)
    (let* ((lone (rpl:create-fluent 'lone 1)) (net (rpl:fl-funcall #'1+ lone))
           (first (run:fork-simulation)))
      (rpl:set-value lone 2)
      (let ((second (run:fork-simulation)))
        (rpl:set-value lone 3)
        (flet ((values-in (fork) (run:call-in-fork fork (lambda ()
                                                          (list (rpl:fluent-value lone)
                                                                (rpl:fluent-value net))))))
          (is (equal '(1 2) (values-in first)))
          (is (equal '(2 3) (values-in second)))
          (run:call-in-fork first (lambda () (rpl:set-value lone 9)))
          (is (equal '(9 10) (values-in first)))
          (let ((third (run:fork-simulation first)))
            (run:call-in-fork first (lambda () (rpl:set-value lone 10)))
            (is (equal '(9 10) (values-in third)))
            (is (equal '(10 11) (values-in first)))
            (is (equal '(2 3) (values-in second)))
            (is (equal '(3 4) (list (rpl:fluent-value lone) (rpl:fluent-value net))))))))))

(test fluents.made-in-a-fork-work-there
  (with-gong (own)
    (run:with-fork ()
      (let* ((new (rpl:create-fluent 'new)) (net (rpl:fl-funcall #'list new *gong*)) (seen nil))
        (driver:begin-plan (rpl:interp-lambda ()
                             (rpl:wait-for (and new *gong*))
                             (setf seen (list (rpl:plan-time) (rpl:fluent-value net)))))
        (run:run-ticks 1)
        (rpl:set-value *gong* 1)
        (run:run-ticks 1)
        (rpl:set-value new 2)
        (run:run-ticks 2)
        (is (equal '(5 (2 1)) seen))))
    (is (null (rpl:fluent-value *gong*)))))

(test fluents.code-of-the-original-called-from-a-fork-finds-its-own
  "Code in a fork may let the original go on. Plans, continuations and kickers of the original find
their fluents as they are there."
  (with-gong (own)
    (let ((original time:*simulation*) (other nil) (seen '()))
      (command:robot-turn rover .3 (lambda (&rest ignore)
                                     (declare (ignore ignore))
                                     (push (list rover (rpl:fluent-value *gong*)) seen)))
      (setf other rover)
      (rpl:set-value *gong* :original)
      (run:with-fork ()
        (rpl:set-value *gong* :fork)
        (run:run-ticks 30 original)
        (is (eq :fork (rpl:fluent-value *gong*)))
        (is (not (eq other rover))))
      (is (equal (list (list other :original)) seen)))))

(test fluents.set-by-kickers-and-schedules-of-a-fork
  (with-gong (own)
    (let ((thing (world:make-new-thing 'bell (list world:*world* 5.5 9.5) '((:size 1)))))
      (world:put-kicker ring-row (thing thing) ()
        (rpl:set-value (aref *row* 0) (run:simulation-tick))))
    (time:schedule (:gong :timer 4) (rpl:set-value *gong* (list 'scheduled (run:simulation-tick)))
                   (rpl:pulse own))
    (run:with-fork ()
      (run:run-ticks 10)
      (is (equal '(scheduled 6) (rpl:fluent-value *gong*)))
      (is (= 12 (rpl:fluent-value (aref *row* 0)))))
    (is (null (rpl:fluent-value *gong*)))
    (is (null (rpl:fluent-value (aref *row* 0))))))

(test fluents.orders-of-plans-wait-for-those-of-the-fork
  (with-gong (own)
    (rpl:set-value own nil)
    (run:with-fork ()
      (let ((task (driver:begin-plan (rpl:interp-lambda ()
                                       (rpl:partial-order
                                         ((rpl:seq (rpl:wait-time 2) (rpl:pulse *gong*))
                                          (:tag later (rpl:wait-time 1)))
                                         (:order *gong* later))))))
        (run:run-ticks 6)
        (is (eq :succeeded (rpl:task-state task)))))))

;;; Valves.

(test valves.of-a-fork-are-its-own
  (with-gong (own)
    (flet ((passage (name)
             (rpl:interp-lambda ()
               (rpl:with-valve (*door*)
                 (rpl:wait-for own)
                 (list name (rpl:plan-time))))))
      (let ((first (driver:begin-plan (passage :first))))
        (driver:begin-plan (passage :second))
        (run:run-ticks 1)
        (is (eq first (rpl:valve-owner *door*)))
        (flet ((outcome (ticks)
                 (let ((tasks (last (driver:plans) 2)))
                   (is (eq (first tasks) (rpl:valve-owner *door*)))
                   (is (equal (rest tasks) (rpl:valve-requests *door*)))
                   (run:run-ticks ticks)
                   (rpl:set-value own t)
                   (run:run-ticks 3)
                   (is (null (rpl:valve-owner *door*)))
                   (mapcar #'rpl:task-result tasks))))
          (is (equal '((:first 5) (:second 5)) (run:with-fork () (outcome 1))))
          (is (equal '((:first 6) (:second 6)) (run:with-fork () (run:with-fork () (outcome 2)))))
          (is (eq first (rpl:valve-owner *door*)))
          (is (equal '((:first 5) (:second 5)) (outcome 1))))))))

;;; Plans may begin when the fork has been made.

(defvar *tally* nil "A fluent that code gets at by a global variable.")

(rpl:def-interp-proc count-to-nine ()
  "Wait for a network that does not come true; count beside that."
  (rpl:par (rpl:wait-for (> *tally* 1000))
           (nisp:loop (rpl:wait-time 1)
             (rpl:set-value *tally* (+ 1 (rpl:fluent-value *tally*))))))

(defun tallies-apart (prepare)
  "Call PREPARE, fork, begin a plan that changes a global fluent; return what that is in both runs."
  (let ((*tally* (rpl:create-fluent 'tally 0)))
    (funcall prepare)
    (let ((fork (run:fork-simulation)))
      (driver:rpl-init-robot (first (run:simulation-robots time:*simulation*)))
      (driver:begin-plan 'count-to-nine)
      (run:run-ticks 9)
      (prog1 (list (rpl:fluent-value *tally*)
                   (run:call-in-fork fork (lambda () (rpl:fluent-value *tally*))))
        (run:release-fork fork)))))

(test fluents.of-a-fork-are-its-own-though-plans-begin-later
  (run:with-simulation (rover :seed 1)
    (is (equal '(8 0) (tallies-apart (constantly nil)))))
  ;; Where another robot has plans by then.
  (run:with-simulation ((keeper helper) :seed 1)
    (is (equal '(8 0) (tallies-apart (lambda ()
                                       (driver:rpl-init-robot helper)
                                       (driver:begin-plan 'heed-gong *tally*)
                                       (run:run-ticks 2)))))))

(test rewind.to-the-beginning-gives-global-fluents-the-values-of-then
  (let ((*tally* (rpl:create-fluent 'tally 0)))
    (run:with-simulation (rover :seed 1 :keep t)
      (driver:begin-plan 'count-to-nine)
      (run:run-ticks 9)
      (loop repeat 3
            do (is (= 8 (rpl:fluent-value *tally*)))
               (run:rewind 7)
               (is (= 1 (rpl:fluent-value *tally*)))
               (run:run-ticks 7)))))
