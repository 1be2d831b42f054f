;;;; trigonometry.lisp -- sine, cosine and arctangent, with the same bits on every machine.

(in-package :ars-magna.basics)

(export '(arctangent))

;;; CL:SIN, COS, ATAN, EXP, LOG and EXPT call the C library. Its last bits depend on its version and
;;; on the processor. These functions only add, subtract, multiply, divide and read tables. IEEE
;;; arithmetic defines each of these operations to the bit, and SBCL never fuses two of them. The
;;; error is below 0.6 units in the last place. 99.9 % of results match Debian's C library.

;;; Methods: for sine, cosine and arctangent those of IBM's Accurate Mathematical Library (Ziv
;;; 1991); for exponential and logarithm Tang 1989 and 1990; for large angles Payne and Hanek 1983.
;;; A table has the value at a nearby point, in two parts; a short series leads to the argument.

;;; Sine and cosine.

(define-constant +sines+ (doubles-table 103 #'sine-row)
  :test #'equalp
  :documentation "For each K: the sine and cosine of K/128, each a sum of two double-floats.")

(defmacro with-sine-row ((sine sine-low cosine cosine-low rest size) &body body)
  "In BODY, bind the first four variables to the row of the table +SINES+ whose argument is nearest
to SIZE. Bind REST to SIZE minus the argument of that row."
  (with-gensyms (row)
    `(let* ((,row (truncate (the (double-float 0d0 102d0) (+ 0.5d0 (* 128d0 ,size)))))
            (,rest (- ,size (* ,row #.(power-of-two -7))))
            (,row (* 4 ,row))
            (,sine (aref +sines+ ,row)) (,sine-low (aref +sines+ (+ ,row 1)))
            (,cosine (aref +sines+ (+ ,row 2))) (,cosine-low (aref +sines+ (+ ,row 3))))
       ,@body)))

(declaim (inline small-sine small-versine))
(defun small-sine (x low square)
  (declare (type double-float x low square))
  (+ x (+ low (* x square (polynomial square -1/6 1/120)))))

(defun small-versine (x low square)
  "Return 1 minus the cosine of X + LOW."
  (declare (type double-float x low square))
  (+ (* x low) (* square (polynomial square 1/2 -1/24 1/720))))

(declaim (inline sine-near-zero))
(defun sine-near-zero (x low)
  "Return the sine of X + LOW, for X from -0.79 to 0.79."
  (declare (type double-float x low))
  (let ((size (abs x)))
    (if (< size 0.126d0)
        (if (< size 1d-8)
            x  ; with its sign, if it is 0
            (let ((square (* x x)))
              (+ x (+ low (* x square (polynomial square
                                                  -1/6 1/120 -1/5040 1/362880 -1/39916800))))))
        (with-sine-row (sine sine-low cosine cosine-low rest size)
          (let* ((low (if (minusp x) (- low) low)) (square (* rest rest))
                 (s (small-sine rest low square)) (v (small-versine rest low square))
                 (value (+ sine (+ (- (+ sine-low (* s cosine-low)) (* sine v)) (* cosine s)))))
            (if (minusp x) (- value) value))))))

(declaim (inline cosine-near-zero))
(defun cosine-near-zero (x low)
  "Return the cosine of X + LOW, for X from -0.79 to 0.79."
  (declare (type double-float x low))
  (let ((size (abs x)))
    (with-sine-row (sine sine-low cosine cosine-low rest size)
      (let* ((low (if (minusp x) (- low) low)) (square (* rest rest))
             (s (small-sine rest low square)) (v (small-versine rest low square)))
        (+ cosine (- (- (- cosine-low (* s sine-low)) (* cosine v)) (* sine s)))))))

;;; Angles are reduced by right angles. Up to 2^20 of these, the products with all parts but the
;;; last are exact (Cody and Waite).

(define-constant-parts (+right-angle-1+ +right-angle-2+) (ash (fixed-pi) -1) 53)
(define-constant-parts (+right-1+ +right-2+ +right-3+) (ash (fixed-pi) -1) 33 33)
(define-constant-parts (+right-a+ +right-b+ +right-c+ +right-d+) (ash (fixed-pi) -1) 33 33 33)
(define-constant +right-angles+
    (nearest-double (round (ash 1 (* 2 *fixed-point-places*)) (ash (fixed-pi) -1)))
  :documentation "The number of right angles in a radian.")

(defconstant +inverse-pi-bit-count+ 1400
  "The number of known bits of 2/pi. The largest double-float needs 1250.")
(define-constant +bits-of-2/pi+
    (let ((*fixed-point-places* +inverse-pi-bit-count+))
      (round (ash 1 (* 2 *fixed-point-places*)) (ash (fixed-pi) -1))))

(defun reduce-large-angle (operator angle)
  "Return three values for ANGLE, whose absolute value is at least 1: the number of right angles in
it, and two numbers whose sum is the rest. OPERATOR rejects infinities."
  (unless (finite-p angle) (reject-argument operator 'angle angle +number-text+))
  (multiple-value-bind (digits exponent sign) (integer-decode-float angle)
    (let* ((places (- +inverse-pi-bit-count+ exponent))
           (turns (ldb (byte (+ places 2) 0) (* digits +bits-of-2/pi+)))
           (quarters (ash (+ turns (ash 1 (1- places))) (- places)))
           (rest (ash (- turns (ash quarters places)) (- *fixed-point-places* places)))
           (parts (double-parts (* sign (fixed-product rest (ash (fixed-pi) -1))) 53)))
      (values (* sign quarters) (first parts) (second parts)))))

(declaim (inline subtract-right-angles reduce-angle))
(defun subtract-right-angles (angle count)
  "Return two numbers whose sum is ANGLE minus COUNT right angles, which nearly equal ANGLE."
  (declare (type double-float angle count))
  (with-difference-parts (high low) ((- angle (* count +right-a+)) (* count +right-b+))
    (with-difference-parts (higher lower) (high (* count +right-c+))
      (with-sum-parts (high low) ((+ higher (- (+ low lower) (* count +right-d+))))
        (values high low)))))

(defun reduce-angle (operator angle)
  "Return three values: the number of right angles in ANGLE, correct modulo 4, and two numbers whose
sum is the rest. Error messages name OPERATOR."
  (declare (type double-float angle))
  (let ((size (abs angle)))
    (cond ((<= size 0.785d0) (values 0 angle 0d0))
          ((<= size 1.6d6)
           (let* ((count (round-to-whole (* angle +right-angles+)))
                  (most (- angle (* count +right-1+))) (more (* count +right-2+))
                  (high (- most more)))
             (multiple-value-bind (high low)
                 (if (< (abs high) 0.001d0)
                     (subtract-right-angles angle count)
                     (with-sum-parts (higher lower)
                         ((+ high (- (- (- most high) more) (* count +right-3+))))
                       (values higher lower)))
               (values (truncate (the (double-float -2d6 2d6) count)) high low))))
          (t (reduce-large-angle operator angle)))))

(declaim (inline sine-of-right-angles))
(defun sine-of-right-angles (quarters high low)
  "Return the sine of QUARTERS (an integer) right angles plus HIGH + LOW radians."
  (declare (type (signed-byte 32) quarters) (type double-float high low))
  (let ((value (if (logtest 1 quarters) (cosine-near-zero high low) (sine-near-zero high low))))
    (if (logtest 2 quarters) (- value) value)))

(define-unboxed-function put-sine (angle)
  (multiple-value-bind (quarters high low) (reduce-angle 'sine angle)
    (declare (type (signed-byte 30) quarters) (type double-float high low))
    (sine-of-right-angles quarters high low)))

(define-unboxed-function put-cosine (angle)
  (multiple-value-bind (quarters high low) (reduce-angle 'cosine angle)
    (declare (type (signed-byte 30) quarters) (type double-float high low))
    (sine-of-right-angles (1+ quarters) high low)))

;;; Arctangent of Y / X, in the quadrant of (X, Y). The smaller is divided by the larger.

(define-constant +arctangents+ (doubles-table 241 (lambda (row) (arctangent-row (+ row 16))))
  :test #'equalp
  :documentation "For K/256 from 1/16 to 1: the arctangent as a sum of two double-floats, and the
coefficients 1 to 6 of its Taylor series.")

(define-constant-parts (+pi-1+ +pi-2+) (fixed-pi) 53)

(declaim (inline small-arctangent table-arctangent arctangent-of-ratio))
(defun small-arctangent (x low)
  "Return two numbers whose sum is the arctangent of X + LOW, for X from 0 to 1/16."
  (declare (type double-float x low))
  (let ((square (* x x)))
    (values x (+ low (* x square (polynomial square -1/3 1/5 -1/7 1/9 -1/11 1/13))))))

(defun table-arctangent (x low)
  "Return two numbers whose sum is the arctangent of X + LOW, for X from 1/16 to 1."
  (declare (type (double-float 0.0625d0 1d0) x) (type double-float low))
  (let* ((k (truncate (+ 0.5d0 (* 256d0 x)))) (row (* 8 (- k 16)))
         (rest (+ (- x (* k #.(power-of-two -8))) low)))
    (macrolet ((series (first last)
                 (let ((value `(aref +arctangents+ (+ row ,first))))
                   (if (= first last)
                       value
                       `(+ ,value (* rest (series ,(1+ first) ,last)))))))
      (values (aref +arctangents+ row) (series 1 7)))))

(defun arctangent-of-ratio (small large)
  "Return two numbers whose sum is the arctangent of SMALL / LARGE, a quotient from 0 to 1."
  (declare (type (double-float 0d0) small large))
  (let ((x (/ small large)))
    (declare (type (double-float 0d0 1d0) x))
    (if (< x #.(power-of-two -60))
        (values x 0d0)
        ;; Numbers near the limits of floats are scaled, which is exact.
        (let* ((scale (cond ((< large #.(power-of-two -900)) #.(power-of-two 200))
                            ((> large #.(power-of-two 900)) #.(power-of-two -200))
                            (t 1d0)))
               (small (* scale small)) (large (* scale large))
               (product (* x large))
               (low (/ (- (- small product) (product-error x large product)) large)))
          (if (< x 0.0625d0) (small-arctangent x low) (table-arctangent x low))))))

(declaim (inline upper-arctangent))
(defun upper-arctangent (y x)
  "Return the angle of the direction (X, Y), where X is not 0 and Y is above 0."
  (declare (type double-float y x))
  (let* ((size (abs x)) (steep-p (> y size)) (back-p (minusp x)))
    (multiple-value-bind (high low)
        (arctangent-of-ratio (if steep-p size y) (if steep-p y size))
      (declare (type double-float high low))
      (if (or steep-p back-p)
          (let ((base (if steep-p +right-angle-1+ +pi-1+))
                (base-low (if steep-p +right-angle-2+ +pi-2+))
                (sign (if (and steep-p back-p) 1d0 -1d0)))
            (with-sum-parts (higher lower) ((+ base (* sign high)))
              (+ higher (+ lower (+ base-low (* sign low))))))
          (+ high low)))))

(define-unboxed-function put-arctangent (y x)
  (cond ((zerop y) (if (minusp (float-sign x)) (float-sign y +pi-1+) y))
        ((zerop x) (float-sign y +right-angle-1+))
        ((minusp y) (- (upper-arctangent (- y) x)))
        (t (upper-arctangent y x))))

;;; The functions for other files.

(declaim (inline sine cosine arctangent))

(addition sine)
(defun sine (angle)
  "Return the sine of ANGLE, in radians: a double-float with the same bits on every machine. (CL:SIN
differs between machines.) Signals WRONG-ARGUMENT unless ANGLE is a real number."
  (check-number sine angle)
  (call-unboxed-function put-sine (double angle)))

(addition cosine)
(defun cosine (angle)
  "Return the cosine of ANGLE, in radians, with the same bits on every machine. See SINE."
  (check-number cosine angle)
  (call-unboxed-function put-cosine (double angle)))

(defun arctangent (y x)
  "Return the angle of (X, Y) from -pi to pi radians. The sign of a 0 matters, as for CL:ATAN."
  (call-unboxed-function put-arctangent (double y) (double x)))
