;;;; projection.lisp -- what may become of a plan, from many trials of it.

(in-package :ars-magna.rpl-projecting)

(addition projection-p)
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
  "Return the bounds, low and high, for the probability that what PROJECTION is about succeeds, by
WILSON-INTERVAL. Signals WRONG-ARGUMENT unless CONFIDENCE is between 0 and 1."
  (wilson-interval (projection-successes projection) (trials-of projection)
                   :confidence confidence))

(addition projection-failures)
(defun projection-failures (projection)
  "Return a list (reason . count), the most frequent first, of why rollouts of PROJECTION did not
succeed: the class of a failure or its condition type, or else the rollout's state."
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
  "Return how many ticks the rollouts of PROJECTION that succeeded took on average, a rational; NIL
if none did."
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
