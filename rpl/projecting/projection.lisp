;;;; projection.lisp -- rollouts, and projections made of them.

(in-package :ars-magna.rpl-projecting)

(addition projection-p)

(defstruct (scene (:constructor make-scene (question moment branch)) (:copier nil))
  "Where rollouts begin: in forks of MOMENT, a fork itself, in which the twin of QUESTION waits for
its answer, by taking its BRANCH, a number; or, without a MOMENT, in a world believed in."
  (question nil :read-only t)
  (moment nil :read-only t)
  (branch 0 :type fixnum :read-only t))

(addition rollout-p)
(define-record (rollout (:constructor make-rollout
                            (scene trial seed state result ticks cost steps ways &optional broken)))
  "One trial of a projection."
  (scene nil scene)
  (trial 0 fixnum "the number of the trial")
  (seed 0 integer "the integer from which all chance in the rollout came" :addition)
  (state :limit keyword "how the rollout ended: :succeeded, :failed, :evaporated, :deadlock,
:stopped; :limit, if its horizon came first; or :runaway, if plans took a million steps in a tick
without waiting" :addition)
  (result nil t "a value or a failure")
  (ticks 0 real "how many ticks the rollout took" :addition)
  (cost nil (or null real)
        "the number that the function :cost returned at the end, or NIL without one" :addition)
  (steps 0 integer "how many steps of plans count")
  (ways '() list "where robots went")
  (broken nil (or null keyword)
          "the option, :COST or :WORLD, of whose function the failure is an error, or NIL"))

(define-shared scene rollout)

(addition rollout-succeeded-p)
(defun rollout-succeeded-p (rollout)
  "True if what ROLLOUT tried succeeded within its horizon."
  (eq :succeeded (rollout-state rollout)))

(addition rollout-value)
(defun rollout-value (rollout)
  "Return the value of the plan in ROLLOUT if it succeeded, or NIL. It may be an object of a run
that is over."
  (and (rollout-succeeded-p rollout) (rollout-result rollout)))

(addition rollout-failure)
(defun rollout-failure (rollout)
  "Return the failure of ROLLOUT if it failed, or NIL."
  (and (eq :failed (rollout-state rollout))
       (rollout-result rollout)))

(defun error-of (rollout)
  (let ((failure (rollout-failure rollout)))
    (and (typep failure 'lisp-failure) (lisp-failure-condition failure))))

(defun reason-of (rollout)
  "Return in a word why ROLLOUT did not succeed: the class of its failure, or its state."
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
            (and (rollout-failure rollout) (safe-text (reason-of rollout)))
            (rollout-ticks rollout) (rollout-seed rollout))))

;;;; Projections

(define-record (projection (:constructor make-projection (text tick horizon rollouts)))
  "What may become of a plan, or a branch of one, as PROJECT returns it."
  (text "" string "a text that says what was projected" :addition)
  (tick 0 real "the tick from which it was projected" :addition)
  (horizon 0 real "how many ticks each rollout was given" :addition)
  (rollouts '() list "the list of its rollouts, in order of their trials" :addition))

(define-shared projection)

(addition projection-successes)
(defun projection-successes (projection)
  "Return how many rollouts of PROJECTION succeeded."
  (count-if #'rollout-succeeded-p (projection-rollouts projection)))

(defun trials-of (projection)
  (length (projection-rollouts projection)))

(addition projection-probability)
(defun projection-probability (projection)
  "Return the share of the rollouts of PROJECTION that succeeded, a double-float from 0 to 1; 1/2 if
there are none, as of a PROJECT inside of a rollout."
  (if (projection-rollouts projection)
      (coerce (/ (projection-successes projection) (trials-of projection)) 'double-float)
      .5d0))

(addition projection-interval)
(defun projection-interval (projection &key (confidence .95d0))
  "Return the bounds, low and high, of the success probability of PROJECTION, by WILSON-INTERVAL.
Signals WRONG-ARGUMENT unless CONFIDENCE is between 0 and 1."
  (wilson-interval (projection-successes projection) (trials-of projection)
                   :confidence confidence))

(addition projection-failures)
(defun projection-failures (projection)
  "Return conses (reason . count), the most frequent first: why rollouts of PROJECTION did not
succeed. A reason is the class of a failure or its condition type, or else the rollout's state."
  (let ((counts '()))
    (dolist (rollout (projection-rollouts projection))
      (unless (rollout-succeeded-p rollout)
        (let* ((reason (reason-of rollout)) (known (assoc reason counts)))
          (if known (incf (cdr known)) (push (cons reason 1) counts)))))
    (stable-sort (nreverse counts) #'> :key #'cdr)))

(defun average (numbers)
  "Return the mean of the list NUMBERS, exactly, or NIL of none. If one is infinite so is the mean."
  (cond ((find-if #'positive-infinity-p numbers))
        (numbers (/ (reduce #'+ (mapcar #'rational numbers)) (length numbers)))))

(addition projection-mean-ticks)
(defun projection-mean-ticks (projection)
  "Return the mean ticks of the rollouts of PROJECTION that succeeded, a rational; NIL if none did."
  (average (mapcar #'rollout-ticks
                   (remove-if-not #'rollout-succeeded-p (projection-rollouts projection)))))

(defun first-error-text (projection)
  (let ((condition (some #'error-of (projection-rollouts projection))))
    (and condition (cut (brief-text condition) 120))))

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
              (projection-successes projection) (trials-of projection) low high
              (projection-mean-ticks projection) (reasons-text projection)
              (first-error-text projection)))))

;;; Which of several is the best.

(defun price-of (projection)
  "Return what success costs on average in PROJECTION, in what :COST counts or else in ticks; if
nothing succeeded, what the rollouts cost that were counted. NIL if that is unknown."
  (let* ((rollouts (projection-rollouts projection))
         (good (remove-if-not #'rollout-succeeded-p rollouts)))
    (cond ((some #'rollout-cost rollouts)
           (average (remove nil (mapcar #'rollout-cost (or good rollouts)))))
          (t (projection-mean-ticks projection)))))

(defun better-p (projection other)
  "True if PROJECTION succeeds more often than OTHER, or as often and at a lower price."
  (let ((successes (projection-successes projection)) (others (projection-successes other))
        (price (price-of projection)) (other-price (price-of other)))
    (cond ((/= successes others) (> successes others))
          ((and price other-price) (< price other-price)))))

(defun best-of (projections)
  "Return the index of the best of PROJECTIONS, the first of those that are as good."
  (let ((best 0))
    (loop for projection in projections
          for index from 0
          do (when (better-p projection (nth best projections)) (setf best index)))
    best))
