;;;; par-at-least.lisp -- par-at-least: some of several branches must succeed.

(in-package :ars-magna.rpl.constructs)

(defstruct (tally (:constructor make-tally (missing left)) (:copier nil))
  "How many successes are MISSING, how many branches are LEFT that may bring them, and the VALUES
and FAILURES so far, last first."
  (missing 0 :type fixnum)
  (left 0 :type fixnum)
  (values '() :type list)
  (failures '() :type list))

(defun checked-number (count branches)
  (let ((count (fluent-value count)))
    (check-argument par-at-least count (whole-p count 0 branches)
                    "an integer from 0 to the number of branches")
    count))

(defun count-end (tally how result)
  (decf (tally-left tally))
  (case how
    (:succeeded (decf (tally-missing tally))
     (push result (tally-values tally)))
    (:failed (push result (tally-failures tally)))))

(defun decide-by-tally (task frame tally branches)
  "End what TASK waits in at FRAME if TALLY, of so many BRANCHES, says that it succeeds, or can do
so no more."
  (cond ((zerop (tally-missing tally))
         (complete task (reverse (tally-values tally))))
        ((> (tally-missing tally) (tally-left tally))
         (decide task (failure-of (make-condition 'composite-failure
                                                  :failures (reverse (tally-failures tally))
                                                  :attempts branches)
                                  task frame)))))

(define-construct par-at-least (count &body branches)
  "Run BRANCHES in a plan side by side. Succeed as soon as COUNT of them have, with the list of
their values, the first first; fail as soon as too many have not, with a composite failure.
Evaporate the others. COUNT is an integer from 0, which needs none, to the number of branches (ours;
CRAM's statecharts of 2026 have a PAR with minimum_success)."
  (:arguments count)
  (:parts (needed function (value-lambda count scope))
          (branches simple-vector (branches-code branches scope)))
  (:steps
   (begin
    (let ((needed (checked-number (funcall needed environment) (length branches))))
      (next over)
      (setf memory (make-tally needed (length branches)))
      (if (plusp needed)
          (start-branches branches task environment)
          (values (frame-up frame) '()))))
   (over (values (frame-up frame) value)))
  (:child-ended
   (cond ((eq how :escaped) (decide task result))
         (t (count-end memory how result)
            (decide-by-tally task frame memory (length branches))))))
