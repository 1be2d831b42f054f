;;;; exponentials.lisp -- exponential, logarithm and power, with the same bits on every machine.

(in-package :ars-magna.basics)

(export '(%logarithm power))

;;; Exponential.

(define-constant +powers+ (doubles-table 128 #'power-row)
  :test #'equalp
  :documentation "For each K from 0 to 127: 2^(K/128), rounded, and its relative rounding error.")

(define-constant-parts (+step-1+ +step-2+) (round (fixed-logarithm 2) 128) 36)
(define-constant +steps+ (/ 128 (nearest-double (fixed-logarithm 2)))
  :documentation "The number of steps in the table +POWERS+ that correspond to a factor of e.")

;; Inline, as a call would return a box.
(declaim (inline signal-overflow))
(defun signal-overflow (number)
  "Signal FLOATING-POINT-OVERFLOW, or return infinity if that trap is masked. NUMBER is above 700."
  (declare (type double-float number))
  (* number most-positive-double-float))

(declaim (inline scale-by-power))
(defun scale-by-power (number exponent)
  "Return NUMBER times 2^EXPONENT. The result may be subnormal, or may overflow."
  (declare (type double-float number) (type (integer -1100 1100) exponent))
  (cond ((< exponent -1021) (* number (power-of-two (+ exponent 200)) #.(power-of-two -200)))
        ((> exponent 1023) (* number (power-of-two (- exponent 200)) #.(power-of-two 200)))
        (t (* number (power-of-two exponent)))))

(declaim (inline exponential-of-parts))
(defun exponential-of-parts (high low)
  "Return e^(HIGH + LOW), for HIGH from -745.2 to 709.79."
  (declare (type (double-float -745.2d0 709.79d0) high) (type double-float low))
  (let* ((steps (round-to-whole (* high +steps+)))
         (x (+ (- (- high (* steps +step-1+)) (* steps +step-2+)) low))
         (steps (truncate (the (double-float -150000d0 132000d0) steps)))
         (row (* 2 (ldb (byte 7 0) steps))) (power (aref +powers+ row))
         (rise (+ x (+ (aref +powers+ (1+ row))
                       (* x x (polynomial x 1/2 1/6 1/24 1/120 1/720))))))
    (scale-by-power (+ power (* power rise)) (ash steps -7))))

(define-unboxed-function put-exponential (number)
  (cond ((> number 709.79d0) (signal-overflow number))
        ((< number -745.2d0) 0d0)
        (t (exponential-of-parts number 0d0))))

;;; Logarithm. A number is 2^K (1 + R) / C, where C is a table's.

(define-constant +logarithms+ (doubles-table 128 #'logarithm-row)
  :test #'equalp
  :documentation "For each row: C, a number with 10 bits; and -log C as a sum of two numbers, the
first with 42 binary places.")

(define-constant-parts (+log-2-1+ +log-2-2+) (fixed-logarithm 2) 42)

(declaim (inline logarithm-parts))
(defun logarithm-parts (number)
  "Return four values: R, the rounding error of R, and two numbers whose sum is log (2^K / C)."
  (declare (type (double-float (0d0)) number))
  (let* ((small-p (< number #.(power-of-two -1022)))
         (bits (ldb (byte 63 0) (double-to-bits (if small-p
                                                    (* number #.(power-of-two 54))
                                                    number))))
         (above (- bits +least-mantissa+))
         (mantissa (bits-to-double (ldb (byte 62 0) (- bits (ash (ash above -52) 52)))))
         (row (* 3 (ldb (byte 7 45) above))) (c (aref +logarithms+ row))
         (exponent (coerce (- (ash above -52) (if small-p 54 0)) 'double-float))
         ;; With its 42 binary places the product is exact.
         (head (- (+ mantissa 1536d0) 1536d0)))
    (declare (type (signed-byte 64) above))
    (with-sum-parts (r low) ((+ (- (* c head) 1d0) (* c (- mantissa head))))
      (values r low
              (+ (* exponent +log-2-1+) (aref +logarithms+ (+ row 1)))
              (+ (* exponent +log-2-2+) (aref +logarithms+ (+ row 2)))))))

(declaim (inline logarithm-series-tail))
(defun logarithm-series-tail (r square)
  "Return log (1 + R) - R + R^2 / 2."
  (declare (type double-float r square))
  (* r square (+ (polynomial r 1/3 -1/4)
                 (* square (+ (polynomial r 1/5 -1/6)
                              (* square (polynomial r 1/7 -1/8 1/9)))))))

(declaim (inline %logarithm))
(defun %logarithm (number)
  "Return the logarithm of NUMBER, 10 ns faster than LOGARITHM, but with 500 bytes of inline code."
  (declare (type (double-float (0d0)) number))
  (multiple-value-bind (r r-low base base-low) (logarithm-parts number)
    (with-sum-parts (high low) ((+ base r))
      (let ((square (* r r)))
        (+ high (+ (+ low (+ base-low r-low))
                   (- (logarithm-series-tail r square) (* 0.5d0 square))))))))

(declaim (ftype (function (t t t) nil) reject-base))
(defun reject-base (operator name number)
  (reject-argument operator name number "a number above 0"))

(defmacro finite-above-zero-p (number)
  `(and (< 0d0 ,number) (<= ,number most-positive-double-float)))

(define-unboxed-function put-logarithm (number)
  (if (finite-above-zero-p number)
      (%logarithm number)
      (reject-base 'logarithm 'number number)))

;;; Powers. The logarithm must have more than 53 bits, as its error is multiplied by the exponent.

(declaim (inline two-part-logarithm))
(defun two-part-logarithm (number)
  "Return two numbers whose sum is the logarithm of NUMBER, to some 68 bits."
  (declare (type (double-float (0d0)) number))
  (multiple-value-bind (r r-low base base-low) (logarithm-parts number)
    (let ((r-head (upper-bits r)))
      (with-sum-parts (high low) ((+ base r))
        (with-sum-parts (higher lower) ((- high (* 0.5d0 r-head r-head)))
          (with-sum-parts (highest lowest)
              ((+ higher (+ (+ low lower base-low (- r-low (* r r-low)))
                            (- (logarithm-series-tail r (* r r))
                               (* 0.5d0 (- r r-head) (+ r r-head))))))
            (values highest lowest)))))))

(declaim (inline positive-power))
(defun positive-power (base exponent)
  (declare (type (double-float (0d0)) base) (type double-float exponent))
  (multiple-value-bind (high low) (two-part-logarithm base)
    ;; Beyond 2^64 the power of any base but 1 is too large or too small.
    (let* ((exponent (max #.(- (power-of-two 64)) (min exponent #.(power-of-two 64))))
           (product (* exponent high)))
      (cond ((> product 709.79d0) (signal-overflow product))
            ((< product -745.2d0) 0d0)
            (t (exponential-of-parts
                product (+ (product-error exponent high product) (* exponent low))))))))

(define-unboxed-function put-power (base exponent)
  (cond ((zerop exponent) 1d0)
        ((finite-above-zero-p base) (positive-power base exponent))
        ((and (zerop base) (plusp exponent)) 0d0)
        (t (reject-base 'power 'base base))))

;;; The functions for other files.

(declaim (inline exponential logarithm power))

(addition exponential)
(defun exponential (number)
  "Return e to the power NUMBER, with the same bits on every machine (CL:EXP differs). Signals
WRONG-ARGUMENT unless NUMBER is real, and FLOATING-POINT-OVERFLOW if it is above 709.78."
  (check-number exponential number)
  (call-unboxed-function put-exponential (double number)))

(addition logarithm)
(defun logarithm (number)
  "Return the natural logarithm of NUMBER, with the same bits on every machine; CL:LOG differs
between machines. Signals WRONG-ARGUMENT unless NUMBER is above 0."
  (check-number logarithm number)
  (call-unboxed-function put-logarithm (double number)))

(defun power (base exponent)
  "Return BASE to the power EXPONENT as a double-float, with the same bits on every machine; CL:EXPT
differs between machines. Signals FLOATING-POINT-OVERFLOW. Signals WRONG-ARGUMENT if BASE is
negative, or if BASE is 0 and EXPONENT is negative."
  (check-number power base)
  (check-number power exponent)
  (call-unboxed-function put-power (double base) (double exponent)))
