;;;; figures.lisp -- numbers as text, and round numbers.

(in-package :ars-magna.plots)

(export '(rounded-number-text decimal-exponent decimal-text strip-trailing-zeros))

;;; Internally all numbers are rationals. So numbers of any size do not overflow, and the same data
;;; give the same picture to the last byte.

(defun as-rational (value)
  "Return the number VALUE as a rational: 0.1 as 1/10. Return NIL for NIL. Signals WRONG-ARGUMENT."
  (check-argument chart value (or (null value) (rationalp value) (finite-p value))
                  "a finite number, or NIL if there is none")
  ;; For denormalized floats, SBCL's RATIONALIZE returns values of other floats.
  (and value
       (if (and (floatp value) (< (float-precision value) (float-digits value)))
           (rational value)
           (rationalize value))))

(defun decimal-exponent (value)
  "Return the greatest integer N for which 10^N is at most the absolute value of VALUE (not 0)."
  (let* ((size (abs value))
         (bits (- (integer-length (numerator size)) (integer-length (denominator size)) 1)))
    (loop for power from (- (floor (* 3/10 bits)) (ceiling (max 0 (- bits)) 100) 1)
          while (<= (expt 10 (1+ power)) size)
          finally (return power))))

;;; Text.

(defun decimal-text (value decimals)
  "Return VALUE as text, rounded to DECIMALS decimals."
  (multiple-value-bind (whole rest)
      (truncate (abs (round (* (rational value) (expt 10 decimals)))) (expt 10 decimals))
    (format nil "~:[~;-~]~D~:[~;.~V,'0D~]"
            (and (minusp value) (plusp (+ whole rest)))
            whole (plusp decimals) decimals rest)))

(defun strip-trailing-zeros (text)
  "Return TEXT, the text of a number, without trailing zeros after the decimal point."
  (if (find #\. text)
      (string-right-trim "." (string-right-trim "0" text))
      text))

(defun round-to-digits (value digits)
  (if (zerop value)
      0
      (let ((unit (expt 10 (- (decimal-exponent value) digits -1))))
        (* unit (round value unit)))))

(defun significant-digits-text (value digits)
  (let* ((value (round-to-digits value digits))
         (power (if (zerop value) 0 (decimal-exponent value))))
    (if (<= -4 power 6)
        (strip-trailing-zeros (decimal-text value (max 0 (- digits 1 power))))
        (format nil "~Ae~D"
                (strip-trailing-zeros (decimal-text (/ value (expt 10 power)) (1- digits)))
                power))))

(defun rounded-number-text (value &key (percent nil) (digits 4))
  "Return the text of the number VALUE with DIGITS significant digits, as per cent if PERCENT: 0.3,
12.5 %, 1.5e9. For NIL return a dash. Signals WRONG-ARGUMENT."
  (let ((value (as-rational value)))
    (cond ((null value) "-")
          (percent (format nil "~A %" (significant-digits-text (* 100 value) digits)))
          (t (significant-digits-text value digits)))))

;;; Round numbers along an axis.

(defun choose-round-step (span most)
  "Return the least step, 10^n, 2*10^n or 5*10^n, that divides SPAN into at most MOST parts."
  (let ((least (/ span most)))
    (loop for power from (decimal-exponent least)
          thereis (loop for factor in '(1 2 5)
                        for step = (* factor (expt 10 power))
                        when (<= least step) return step))))

(defconstant +step-tolerance+ 1/1000000000
  "The fraction of a step by which a float may differ from a round number.")

(defun multiple-below (step value)
  (* step (floor (+ (/ value step) +step-tolerance+))))

(defun multiple-above (step value)
  (* step (ceiling (- (/ value step) +step-tolerance+))))

(defun mark-text (value step largest percent)
  "Return the text of VALUE for a mark, with as many decimals as STEP. The marks are STEP apart;
LARGEST is the largest absolute value."
  (flet ((decimals (step) (max 0 (- (decimal-exponent step)))))
    (cond (percent
           (format nil "~A %" (decimal-text (* 100 value) (decimals (* 100 step)))))
          ((and (<= 1/100000 step) (< largest (expt 10 7)))
           (decimal-text value (decimals step)))
          ((zerop value) "0")
          (t (let ((unit (expt 10 (decimal-exponent largest))))
               (format nil "~Ae~D" (decimal-text (/ value unit) (decimals (/ step unit)))
                       (decimal-exponent largest)))))))

(defun step-marks (step low high percent)
  "Return a list of marks (value text), STEP apart, for an axis from LOW to HIGH."
  (let ((largest (max (abs low) (abs high))))
    (loop for value from (multiple-above step low) to (multiple-below step high) by step
          collect (list value (mark-text value step largest percent)))))
