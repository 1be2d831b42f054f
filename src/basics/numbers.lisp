;;;; numbers.lisp -- how large the numbers are that the simulator takes: one limit for each kind.

(in-package :ars-magna.basics)

(export '(+largest+ +largest-quantity+ within-reason-p quantity-p amount-p probability-p whole-p
          tick-span-p))

;;; Positions, distances, speeds, angles and times are kept below 1e9 either way: there a
;;; double-float is exact to 1e-7 metres or radians, so that what is added up in a run stays true,
;;; and a count of ticks can be added to another for ever. (At 20 ticks a second 1e9 ticks take a
;;; year and a half.) What things are like, such as weights, is kept below 1e15, where every whole
;;; number is a double-float of its own, and sums and squares are far from overflowing. Infinities
;;; and what is no number are nowhere taken. ARGUMENT-TYPES.LISP says all this to users.

(define-constant +largest+ (expt 10 9)
  :documentation "How large positions, distances, speeds, angles and times are at most.")

(define-constant +largest-quantity+ (expt 10 15)
  :documentation "How large the numbers are at most that say what something is like.")

(defun other-within-p (value limit)
  (and (finite-p value) (<= (- limit) value limit)))

(declaim (inline within-p within-reason-p quantity-p))
(defun within-p (value limit)
  "True if VALUE is a number from -LIMIT to LIMIT, an integer."
  (if (typep value 'double-float)
      (and (finite-double-p value)
           (<= (double (- limit)) value (double limit)))
      (other-within-p value limit)))

(defun within-reason-p (value)
  "True if VALUE can be a position, distance, speed, angle or time: from -1e9 to 1e9."
  (within-p value +largest+))

(defun quantity-p (value)
  "True if VALUE can say what something is like: a number from -1e15 to 1e15."
  (within-p value +largest-quantity+))

(defun amount-p (value)
  "True if VALUE is a quantity not below 0."
  (and (quantity-p value) (not (minusp value))))

(defun probability-p (value)
  "True if VALUE is a number from 0 to 1."
  (and (finite-p value) (<= 0 value 1)))

(defun whole-p (value &optional (least 0) (most +largest+))
  "True if VALUE is an integer from LEAST to MOST."
  (and (integerp value) (<= least value most)))

(defun tick-span-p (value)
  "True if VALUE is how long something can last: a whole number of ticks, from 0 to 1e9."
  (whole-p value))
