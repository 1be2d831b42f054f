;;;; figures.lisp -- the numbers of a comparison, with as many digits as they are known to.

(in-package :ars-magna.experiment)

;;; Of means all numbers have the same last decimal, which has a negative number above the point. It
;;; shows the width of the interval, or if that is nothing the difference, with two digits.

(defun last-decimal (size)
  "Return which decimal is the second digit of SIZE."
  (- 1 (power-of-ten (rational size))))

(defun decimals-known (difference)
  "Return which decimal is the last that the numbers of DIFFERENCE, of means, are worth."
  (let* ((low (paired-low difference)) (high (paired-high difference))
         (width (if low (number-less high low) 0))
         (reach (find-if-not #'zerop (list (paired-estimate difference)
                                           (paired-first difference)))))
    (cond ((plusp width)
           (min (last-decimal width)
                (max 6 (+ 5 (last-decimal (max (abs low) (abs high)))))))
          (reach (max (last-decimal reach) (min 3 (+ 13 (last-decimal reach)))))
          (t 3))))

(defun power-text (number decimals)
  "Return NUMBER with a power of ten, up to its last of DECIMALS."
  (let* ((power (power-of-ten number))
         (text (decimal-text (/ number (expt 10 power)) (max 0 (+ decimals power)))))
    (format nil "~Ae~D" (without-zeros text) power)))

(defun mean-text (value decimals)
  "Return VALUE, a mean or a difference, in DECIMALS; with a power of ten if it is far from 1."
  (let* ((unit (expt 10 (- decimals)))
         (number (* unit (round (rational value) unit))))
    (cond ((and (zerop number) (< 9 decimals)) "0")
          ;; Beside very large numbers a small one is not nothing.
          ((and (zerop number) (minusp decimals) (not (zerop value))) (figure-text value :digits 2))
          ((or (zerop number) (<= -6 (power-of-ten number) 14))
           (decimal-text number (max 0 decimals)))
          (t (power-text number decimals)))))

(defun number-writer (difference)
  "Return a function that writes the numbers of DIFFERENCE, without units."
  (cond ((eq :rate (paired-kind difference))
         (lambda (value) (hundredths-text value (paired-trials difference))))
        ((plusp (or (paired-rounding difference) 0)) #'number-text)
        (t (let ((decimals (if (paired-first difference) (decimals-known difference) 0)))
             (lambda (value) (mean-text value decimals))))))
