;;;; thoughts.lisp -- what a robot has yet to be charged for its thinking, less than a tick.

(in-package :ars-magna.robot)

(export '(charge-thought))

;;; Thoughts of fractions of a tick add up. The fraction is kept exactly, in the robot's mind, for
;;; plans and programs together. Plans are not in journals, so what they add is a request.

(define-argument-type 'tick-fraction (lambda (value) (typep value '(rational 0 (1))))
  "a fraction of a tick, from 0 to below 1")

;; Digests of runs without fractions are as they were before there were fractions.
(defmethod digest-state :after ((mind mind) digest)
  (unless (zerop (mind-unpaid mind)) (digest-add digest (mind-unpaid mind))))

(defun keep-unpaid-thought (robot fraction)
  "Make FRACTION, of a tick, what ROBOT has yet to be charged for its thinking."
  (unless (= fraction (mind-unpaid (robot-mind robot)))
    (changing ((robot-world robot) keep-unpaid-thought robot fraction)
      (setf (mind-unpaid (robot-mind robot)) fraction))))

(define-operator 'keep-unpaid-thought '(robot tick-fraction) #'keep-unpaid-thought)

(defun charge-thought (robot span)
  "Charge ROBOT for a thought of SPAN ticks, a number not below 0. Return the whole ticks that the
thought takes. The rest, less than a tick, is kept for the next thought."
  (multiple-value-bind (ticks rest) (floor (+ (mind-unpaid (robot-mind robot)) (rationalize span)))
    (keep-unpaid-thought robot rest)
    ticks))

(addition robot-unpaid-thinking)
(defun robot-unpaid-thinking (robot)
  "Return the fraction of a tick, a rational from 0 to below 1, that ROBOT has yet to be charged for
its thinking: it is added to its next THINK. Signals WRONG-ARGUMENT."
  (check-argument robot-unpaid-thinking robot (robot-p robot) (argument-type-text 'robot robot))
  (mind-unpaid (robot-mind robot)))
