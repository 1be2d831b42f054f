;;;; projection.lisp -- rollouts, and projections made of them.

(in-package :ars-magna.rpl-projecting)

(addition projection-p)

(defstruct (rollout-start (:constructor make-rollout-start (question moment branch)) (:copier nil))
  "The start of rollouts that try BRANCH, a number, of QUESTION. MOMENT is a fork where a copy of
QUESTION awaits its answer; rollouts fork it. Without MOMENT, they begin in a believed world."
  (question nil :read-only t)
  (moment nil :read-only t)
  (branch 0 :type fixnum :read-only t))

(addition rollout-p)
(define-record (rollout (:constructor make-rollout
                            (scene trial seed state result ticks cost steps ways
                             &optional broken measure)))
  "One trial of a projection."
  (scene nil rollout-start)
  (trial 0 fixnum "the number of the trial")
  (seed 0 integer "the integer from which all chance in the rollout came" :addition)
  (state :limit keyword "how the rollout ended: :succeeded, :failed, :evaporated, :deadlock,
:stopped; :limit, if its horizon came first; or :runaway, if the plan took a million steps in a tick
without waiting" :addition)
  (result nil t "a value or a failure")
  (ticks 0 real "how many ticks the rollout took" :addition)
  (cost nil (or null real)
        "the number that the function :COST returned at the end; NIL without :COST" :addition)
  (steps 0 integer "how many steps of plans count")
  (ways '() list "where robots went")
  (broken nil (or null keyword)
          "the option, :COST, :MEASURE or :WORLD, whose error ended the rollout, or NIL")
  (measure nil (or null real)
           "the value of the measure of the option :MEASURE; NIL without :MEASURE" :addition))

(define-shared-types rollout-start rollout)

(addition rollout-succeeded-p)
(defun rollout-succeeded-p (rollout)
  "True if the plan in ROLLOUT succeeded within its horizon."
  (eq :succeeded (rollout-state rollout)))

(addition rollout-value)
(defun rollout-value (rollout)
  "Return the value of ROLLOUT's plan if it succeeded, or NIL. The value may be of a finished run."
  (and (rollout-succeeded-p rollout) (rollout-result rollout)))

(addition rollout-failure)
(defun rollout-failure (rollout)
  "Return the failure of ROLLOUT if it failed, or NIL."
  (and (eq :failed (rollout-state rollout))
       (rollout-result rollout)))

(defun rollout-error (rollout)
  (let ((failure (rollout-failure rollout)))
    (and (typep failure 'lisp-failure) (lisp-failure-condition failure))))

(defun rollout-reason (rollout)
  "Return why ROLLOUT did not succeed: the class of its failure, or else its state, a keyword."
  (let ((failure (rollout-failure rollout)))
    (cond ((null failure) (rollout-state rollout))
          ((failure-class failure))
          (t (type-of failure)))))

(defun outcome-word (state)
  (case state
    (:succeeded "success")
    (:limit "limit")
    (t "failure")))

(defmethod print-object ((rollout rollout) stream)
  (print-unreadable-object (rollout stream :type t)
    (format stream "~D, ~(~A~)~@[: ~A~] after ~A tick~:P, seed ~D" (rollout-trial rollout)
            (rollout-state rollout)
            (and (rollout-failure rollout) (safe-text (rollout-reason rollout)))
            (rollout-ticks rollout) (rollout-seed rollout))))

;;;; Projections

(define-record (projection (:constructor make-projection (text tick horizon rollouts)))
  "The result of PROJECT: an estimate of how a plan, or a branch of a plan, may end."
  (text "" string "a text that says what was projected" :addition)
  (tick 0 real "the tick at which the projected plan would begin" :addition)
  (horizon 0 real "how many ticks each rollout was given" :addition)
  (rollouts '() list "the list of the projection's rollouts, in order of their trials" :addition))

(define-shared-types projection)

(addition projection-successes)
(defun projection-successes (projection)
  "Return how many rollouts of PROJECTION succeeded."
  (count-if #'rollout-succeeded-p (projection-rollouts projection)))

(defun rollout-count (projection)
  (length (projection-rollouts projection)))

(addition projection-probability)
(defun projection-probability (projection)
  "Return the fraction of the rollouts of PROJECTION that succeeded, a double-float from 0 to 1.
Return 0.5 if there are no rollouts, as for a PROJECT inside of a rollout."
  (if (projection-rollouts projection)
      (coerce (/ (projection-successes projection) (rollout-count projection)) 'double-float)
      .5d0))

(addition projection-interval)
(defun projection-interval (projection &key (confidence .95d0))
  "Return the bounds, low and high, of the success probability of PROJECTION, by WILSON-INTERVAL.
Signals WRONG-ARGUMENT unless CONFIDENCE is between 0 and 1."
  (wilson-interval (projection-successes projection) (rollout-count projection)
                   :confidence confidence))

(addition projection-failures)
(defun projection-failures (projection)
  "Return a list of conses (reason . count), the most frequent reason first, for the unsuccessful
rollouts of PROJECTION. A reason is a failure's class or condition type, or the rollout's state."
  (let ((counts '()))
    (dolist (rollout (projection-rollouts projection))
      (unless (rollout-succeeded-p rollout)
        (let* ((reason (rollout-reason rollout)) (known (assoc reason counts)))
          (if known (incf (cdr known)) (push (cons reason 1) counts)))))
    (stable-sort (nreverse counts) #'> :key #'cdr)))

(defun mean-or-infinity (numbers)
  "Return the exact mean of the list NUMBERS; NIL for (), and infinity if a number is infinite."
  (cond ((find-if #'positive-infinity-p numbers))
        (numbers (/ (reduce #'+ (mapcar #'rational numbers)) (length numbers)))))

(addition projection-mean-ticks)
(defun projection-mean-ticks (projection)
  "Return the mean ticks, a rational, of successful rollouts of PROJECTION; NIL if none succeeded."
  (mean-or-infinity
   (mapcar #'rollout-ticks
           (remove-if-not #'rollout-succeeded-p (projection-rollouts projection)))))

(defun mean-of-measures (rollouts)
  "Return the exact mean of the known measures of ROLLOUTS, or NIL."
  (mean-or-infinity (remove nil (mapcar #'rollout-measure rollouts))))

(addition projection-mean-measure)
(defun projection-mean-measure (projection)
  "Return the mean, a double-float, of the measure of the option :MEASURE in the rollouts of
PROJECTION, successful or not; NIL without :MEASURE."
  (let ((mean (mean-of-measures (projection-rollouts projection))))
    (and mean (coerce mean 'double-float))))

(defun first-error-text (projection)
  (let ((condition (some #'rollout-error (projection-rollouts projection))))
    (and condition (cut (brief-condition-text condition) 120))))

(defun reasons-text (projection)
  (let ((failures (projection-failures projection)))
    (and failures
         (cut (format nil "~{~A~^, ~}"
                      (loop for (reason . count) in failures
                            collect (format nil "~D ~(~A~)" count (safe-text reason))))
              120))))

(defmethod print-object ((projection projection) stream)
  (print-unreadable-object (projection stream :type t)
    (multiple-value-bind (low high) (projection-interval projection)
      (format stream "~A: ~D of ~D, ~,2F to ~,2F~@[, ~,1F ticks~]~@[; not: ~A~]~
                      ~@[; first error: ~A~]"
              (cut (projection-text projection) 60)
              (projection-successes projection) (rollout-count projection) low high
              (projection-mean-ticks projection) (reasons-text projection)
              (first-error-text projection)))))

;;; Which of several is the best.

(defun mean-cost (projection)
  "Return the mean cost, by the function :COST, of the rollouts of PROJECTION that succeeded. If
none succeeded, return the mean cost of all rollouts with a known cost. Without costs, do the same
with the negative of the measure :MEASURE. Without that, return the mean ticks of success, or NIL."
  (let* ((rollouts (projection-rollouts projection))
         (good (remove-if-not #'rollout-succeeded-p rollouts)))
    (cond ((some #'rollout-cost rollouts)
           (mean-or-infinity (remove nil (mapcar #'rollout-cost (or good rollouts)))))
          ((some #'rollout-measure rollouts) (- (mean-of-measures (or good rollouts))))
          (t (projection-mean-ticks projection)))))

(defun better-projection-p (projection other)
  (let ((successes (projection-successes projection)) (others (projection-successes other))
        (price (mean-cost projection)) (other-price (mean-cost other)))
    (cond ((/= successes others) (> successes others))
          ((and price other-price) (< price other-price)))))

(defun index-of-best (projections)
  "Return the index of the best of PROJECTIONS. Of equally good projections, the first is the best."
  (let ((best 0))
    (loop for projection in projections
          for index from 0
          do (when (better-projection-p projection (nth best projections)) (setf best index)))
    best))
