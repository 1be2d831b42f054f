;;;; rewinding-values.lisp -- fluents, arguments of plans and random numbers after a rewind.

(in-package :ars-magna.tests)
(in-suite rewinding)

;;; Fluents.

(test rewind.undoes-fluents-that-are-first-set-after-a-rewind
  (let ((door (rpl:create-fluent 'door :shut)))
    (with-rover (:seed 1 :keep t)
      (run:run-ticks 5)
      (run:rewind 2)
      (run:run-ticks 5)
      (rpl:set-value door :open)
      (run:run-ticks 2)
      (run:rewind 4)
      (is (eq :shut (rpl:fluent-value door))))))

(test rewind.undoes-fluents-that-are-set-in-forks
  (let ((door (rpl:create-fluent 'door :shut)))
    (with-rover (:seed 1)
      (run:with-fork ()
        (run:keep-forks)
        (run:run-ticks 5)
        (rpl:set-value door :open)
        (run:rewind 2)
        (is (eq :shut (rpl:fluent-value door))))
      (is (eq :shut (rpl:fluent-value door))))))

;;; Arguments of plans.

(defstruct chore "What a plan is to do." (todo '()) (robot nil))

(rpl:def-interp-proc do-chore (chore)
  (rpl:n-times (length (chore-todo chore))
    (driver:rpl-robot-turn (pop (chore-todo chore)))
    (rpl:wait-for driver:robot-stopped*)))

(defun angle-after-chore (&rest rewinds)
  "Return how far the rover has turned on a chore after 120 ticks, and REWINDS of so many ticks."
  (with-rover (:seed 1 :keep t :clean t)
    (driver:begin-plan 'do-chore (make-chore :todo (list 1 2 3 1 2 3) :robot rover))
    (run:run-ticks 20)
    (dolist (ticks rewinds) (run:rewind ticks))
    (run:run-ticks (- 120 (tick-of-run)))
    (robot:robot-angle rover)))

(test rewind.begins-plans-with-what-their-arguments-were
  "A plan that uses up what it was given finds it again, as often as one likes."
  (is (near-p 12 (angle-after-chore)))
  (is (near-p 12 (angle-after-chore 5)))
  (is (near-p 12 (angle-after-chore 5 3 2))))

(test rewind.remembers-arguments-that-their-giver-changes
  (with-rover (:seed 1 :keep t :clean t)
    (let ((way (list 1 2)))
      (driver:begin-plan 'do-chore (make-chore :todo way))
      (run:run-ticks 2)
      (setf (second way) 3)
      (run:rewind 1)
      (run:run-ticks 60)
      (is (near-p 3 (robot:robot-angle rover))))))

(test rewind.knows-robots-and-what-is-shared-in-arguments
  "Where the run is redone from its beginning: a kept fork shares what only a program refers to."
  (with-rover (:seed 1 :keep t)
    (let* ((run::*fork-time-share* 1/1000000)
           (chore (make-chore :robot rover)) (given (vector chore (list chore)))
           (seen (rpl:create-fluent 'seen)))
      (rpl:set-value seen given)
      (run:run-ticks 3)
      (setf (chore-robot chore) :lost)
      (run:rewind 1)
      (let ((now (rpl:fluent-value seen)))
        (is (eq rover (chore-robot (aref now 0))))
        (is (eq (aref now 0) (first (aref now 1))))))))

;;; What is left when the run is over.

(test rewind.leaves-fluents-as-they-are-where-the-run-has-gone-on
  "Without rewinding a fluent of everybody's keeps what the run has set; so it does with it."
  (let ((door (rpl:create-fluent 'door :shut)))
    (with-rover (:seed 1 :keep t)
      (run:run-ticks 3)
      (rpl:set-value door :open)
      (run:run-ticks 3)
      (run:rewind 5))
    (is (eq :shut (rpl:fluent-value door)))
    (with-rover (:seed 1 :keep t)
      (run:run-ticks 3)
      (run:rewind 1)
      (rpl:set-value door :ajar)
      (run:run-ticks 3)
      (run:rewind 1))
    (is (eq :ajar (rpl:fluent-value door)))))

;;; Dice of programs.

(defun rolled-after (function &optional back)
  "Return what RANDOM says after FUNCTION of a run, going back BACK ticks, and on again."
  (with-rover (:seed 1 :keep t)
    (run:run-ticks 3)
    (funcall function)
    (when back (run:rewind back))
    (random 1000000)))

(test rewind.restores-the-dice-of-programs
  (flet ((both (function)
           (is (= (rolled-after function) (rolled-after function 0)))))
    (both (lambda () (run:run-ticks 1)))
    (both (lambda () (random 10) (run:run-ticks 1)))
    (both (lambda () (loop repeat 900 do (random 10)) (run:run-ticks 20)))
    (both (lambda ()
            (command:robot-turn rover 0.1 (lambda (&rest ignored)
                                            (declare (ignore ignored))
                                            (random 10)))
            (run:run-ticks 9))))
  (is (= (rolled-after #'list) (rolled-after (lambda () (random 10)) 0))))

(rpl:def-interp-proc turn-by-chance ()
  (rpl:n-times 40
    (driver:rpl-robot-turn (random 3.0))
    (rpl:wait-for driver:robot-stopped*)))

(defun angle-by-chance (&optional back)
  (with-rover (:seed 1 :keep t)
    (random 10)
    (driver:begin-plan 'turn-by-chance)
    (run:run-ticks 5)
    (random 10)
    (run:run-ticks 10)
    (when back (run:rewind back))
    (run:run-ticks (- 55 (tick-of-run)))
    (robot:robot-angle rover)))

(test rewind.lets-plans-roll-what-they-rolled
  (is (= (angle-by-chance) (angle-by-chance 0) (angle-by-chance 7))))

;;; Forks.

(test rewind.a-fork-goes-on-by-run-ticks
  (with-rover (:seed 1)
    (let ((fork (run:fork-simulation)))
      (run:call-in-fork fork (lambda () (run:keep-forks) (run:run-ticks 5) (run:rewind 2)))
      (is (= 5 (run:run-ticks 2 fork)))
      (is (= 6 (nth-value 1 (run:run-until (lambda () nil) :limit 1 :simulation fork)))))))

(defvar *top-count* (rpl:create-fluent 'top-count 0) "What top-level code counts in.")

(defun root-now-p () (eq fluents:+root+ (base:global-value 'fluents:*realm*)))

(test rewind.of-a-live-run-ends-with-it
  "Once another run starts, top-level code works where it did, with what it had last."
  (keeping-often
    (live-rover (:rate 500 :seed 2)
      (driver:rpl-init-robot rover)
      (command:robot-turn rover 90)
      (setf (rpl:fluent-value *top-count*) 1)
      (awaiting (< 20 (tick-of-run)))
      (run:rewind 10)
      (is-false (root-now-p))
      (setf (rpl:fluent-value *top-count*) 2)
      (driver:begin-plan 'count-for-ever *top-count*)
      (awaiting (< 5 (rpl:fluent-value *top-count*)))
      (time:pause)
      (time:ask time:*simulation* (constantly nil)))
    (let ((count (rpl:fluent-value *top-count*)))
      (live-rover (:rate 500 :seed 2)
        (is-true (root-now-p))
        (is (<= count (rpl:fluent-value *top-count*)))
        (setf (rpl:fluent-value *top-count*) 0)
        (is (= 0 (rpl:fluent-value *top-count*)))))
    (is-true (root-now-p))))

;;; What functions have closed over.

(defmacro keeping-every (share &body body)
  "Run BODY, where runs spend so much of their time on forks as SHARE says."
  `(let ((run::*fork-time-share* ,share)) ,@body))

(defun pot-after (share rewinds begin)
  "Return where a pot is after 88 ticks, once BEGIN has been called with it, and what was said;
REWINDS are made at the tick 85, where forks take SHARE of the time."
  (keeping-every share
    (with-rover (:seed 1 :keep t)
      (let ((pot (world:make-new-thing 'pot (list world:*world* 3.5 3.5) '((:size 1)))))
        (funcall begin pot)
        (run:run-ticks 85)
        (dolist (ticks rewinds) (run:rewind ticks))
        (run:run-ticks (- 88 (tick-of-run)))
        (list (world:thing-x (world:find-thing 'pot)) (base:take-messages))))))

(defun outcomes-for-pot (begin)
  "Return what POT-AFTER returns for BEGIN with many forks, and with none but the first."
  (remove-duplicates (loop for rewinds in '(() (25) (70 10) (84))
                           append (loop for share in '(1 1/1000000)
                                        collect (pot-after share rewinds begin)))
                     :test #'equal))

(test rewind.does-what-was-scheduled
  "Also where the fork that goes on had not been asked for it: its own pot is moved."
  (is (equal '((4.5d0 ()))
             (outcomes-for-pot
              (lambda (pot) (time:schedule (nil :timer 5) (world:kick-thing pot 1 0 nil)))))))

(test rewind.schedules-with-the-variables-of-then
  (is (equal '((6.5d0 ()))
             (outcomes-for-pot
              (lambda (pot)
                (let ((distance 0) (simulation time:*simulation*))
                  (time:schedule (:push :when (= 3 (incf distance)) :timeout 9)
                    (when (eq simulation time:*simulation*)
                      (world:kick-thing pot distance 0 nil)))))))))

(rpl:def-interp-proc kick-later (pot ticks kick)
  (rpl:wait-time ticks)
  (time:schedule (nil :timer 5) (funcall kick) (world:kick-thing pot 1 0 nil)))

(test rewind.knows-what-plans-schedule-again
  "A plan's function of the same code is the one that it has asked for, and no other way."
  (is (equal '((6.5d0 ()))
             (outcomes-for-pot
              (lambda (pot)
                (dolist (ticks '(3 10))
                  (driver:begin-plan 'kick-later pot ticks #'list))
                (driver:begin-plan 'kick-later pot 12 (lambda ()
                                                        (world:kick-thing pot 0 0 nil))))))))
