;;;; fixed-point.lisp -- arithmetic for elementary functions: long integers, floats in two parts.

(in-package :ars-magna.basics)

(export '(+number-text+))

;;; A fixed-point number is an integer that counts units of 2^-PLACES. Integer arithmetic is the
;;; same everywhere. After loading, such numbers are used only for angles beyond a million radians.

(defvar *fixed-point-places* 256 "The number of binary places of fixed-point numbers.")

(defun to-fixed (number)
  (values (round (ash (numerator number) *fixed-point-places*) (denominator number))))

(defun fixed-product (a b)
  (ash (* a b) (- *fixed-point-places*)))

(declaim (inline power-of-two))
(defun power-of-two (exponent)
  "Return 2^EXPONENT, a double-float; EXPONENT is from -1022 to 1023."
  (declare (type (integer -1022 1023) exponent))
  (bits-to-double (ash (+ exponent 1023) 52)))

(defun nearest-double (fixed &optional (bits 53))
  "Return the double-float with BITS significant bits, 53 at most, that is nearest to FIXED."
  (let* ((shift (max 0 (- (integer-length (abs fixed)) bits)))
         (digits (round fixed (ash 1 shift))))
    (* (coerce digits 'double-float) (power-of-two (- shift *fixed-point-places*)))))

(defun double-parts (fixed &rest bits)
  "Return a list of double-floats whose sum is FIXED: for each number in BITS, a double-float
with that many significant bits; then the remainder."
  (if (null bits)
      (list (nearest-double fixed))
      (let ((head (nearest-double fixed (first bits))))
        (cons head (apply #'double-parts (- fixed (to-fixed (rational head))) (rest bits))))))

(defun doubles-table (count row)
  "Return a vector of the double-floats in the lists that ROW returns for 0, 1, 2 ... below COUNT."
  (coerce (loop for k below count append (funcall row k)) '(simple-array double-float (*))))

;;; Power series. Each is summed until its terms are less than one unit.

(defun sum-series (first next)
  "Return the sum of a series that begins with the term FIRST. Each further term is the value of
NEXT, called with the previous term and K = 1, 2, 3 ..."
  (loop for k from 1
        for term = first then (funcall next term (1- k))
        until (zerop term)
        sum term))

(defun sum-odd-powers (x sign)
  "Return X + SIGN X^3/3 + X^5/5 + SIGN X^7/7 ... for the rational X."
  (let ((factor (* sign (to-fixed (* x x)))) (power (to-fixed x)))
    (sum-series power (lambda (term k)
                        (declare (ignore term))
                        (setf power (fixed-product power factor))
                        (round power (1+ (* 2 k)))))))

(defun fixed-exponential (x)
  "Return e^X for a fixed-point X near 0."
  (sum-series (to-fixed 1) (lambda (term k) (round (fixed-product term x) k))))

(defun fixed-arctangent (x)
  "Return the arctangent of the rational X, from 0 to 1/2."
  (sum-odd-powers x -1))

(defun fixed-logarithm (x)
  "Return the natural logarithm of the rational X, from 1/2 to 2."
  (* 2 (sum-odd-powers (/ (1- x) (1+ x)) 1)))

(defun fixed-sine-or-cosine (x power)
  "Return the cosine of the rational X if POWER is 0, and its sine if POWER is 1."
  (let ((square (to-fixed (* x x))))
    (sum-series (if (zerop power) (to-fixed 1) (to-fixed x))
                (lambda (term k)
                  (let ((n (+ power (* 2 k))))
                    (- (round (fixed-product term square) (* n (1- n)))))))))

(defun fixed-pi ()
  "Return pi as a fixed-point number, by Machin's formula of 1706."
  (* 4 (- (* 4 (fixed-arctangent 1/5)) (fixed-arctangent 1/239))))

;;; The rows of the tables, lists of double-floats.

(defun sine-row (k)
  "Return the sine and the cosine of K/128, each in two parts."
  (append (double-parts (fixed-sine-or-cosine (/ k 128) 1) 53)
          (double-parts (fixed-sine-or-cosine (/ k 128) 0) 53)))

(defun power-row (k)
  "Return a list of 2^(K/128), rounded, and its relative rounding error."
  (let ((parts (double-parts (fixed-exponential (round (* k (fixed-logarithm 2)) 128)) 53)))
    (list (first parts) (/ (second parts) (first parts)))))

(defconstant +least-mantissa+ #x3FE6000000000000
  "The bits of 0.6875. Mantissas go from 0.6875 to 1.375, so the exponent of numbers near 1 is 0.")

(defun mantissa-row-center (row)
  (flet ((bound (row) (rational (bits-to-double (+ +least-mantissa+ (ash row 45))))))
    (/ (+ (bound row) (bound (1+ row))) 2)))

(defun logarithm-row (row)
  ;; Around 1, which rows 79 and 80 share, R is to be exact.
  (let* ((c (if (<= 79 row 80) 1 (/ (round 512 (mantissa-row-center row)) 512)))
         (logarithm (- (fixed-logarithm c)))
         (unit (ash 1 (- *fixed-point-places* 42)))
         (head (* (round logarithm unit) unit)))
    (list (coerce c 'double-float) (nearest-double head) (nearest-double (- logarithm head)))))

(defun arctangent-row (k)
  (let* ((x (/ k 256)) (divisor (1+ (* x x)))
         (value (if (<= k 128)
                    (fixed-arctangent x)
                    (- (ash (fixed-pi) -2) (fixed-arctangent (/ (- 256 k) (+ 256 k)))))))
    (append (double-parts value 53)
            ;; The series of 1 / (1 + X^2), integrated.
            (loop repeat 6
                  for n from 1
                  for before = 0 then last
                  for last = 0 then term
                  for term = (/ divisor) then (/ (- (+ (* 2 x last) before)) divisor)
                  collect (nearest-double (to-fixed (/ term n)))))))

;;;; Numbers in two parts

;;; A number with some 106 bits is kept as two parts, double-floats whose sum it is.

;;; A full call boxes its double-floats. So inline functions pass them in a vector on the stack. The
;;; last cell is for the result: a result in the cell of an argument takes 5 ns more.

(defmacro call-unboxed-function (function &rest numbers)
  "Call FUNCTION with a vector of NUMBERS and a last cell for the result. Return the result."
  (with-gensyms (cells)
    (let ((count (length numbers)))
      `(let ((,cells (make-array ,(1+ count) :element-type 'double-float)))
         (declare (dynamic-extent ,cells))
         (setf ,@(loop for number in numbers for k from 0 append `((aref ,cells ,k) ,number)))
         (,function ,cells)
         (aref ,cells ,count)))))

(defmacro define-unboxed-function (name (&rest arguments) &body body)
  "Define the function NAME. It takes a vector of ARGUMENTS and a cell to store BODY's value in."
  (let ((count (length arguments)))
    `(defun ,name (cells)
       (declare #.*hot* (type (simple-array double-float (,(1+ count))) cells))
       (let ,(loop for argument in arguments for k from 0 collect `(,argument (aref cells ,k)))
         (declare (type double-float ,@arguments))
         (setf (aref cells ,count) (progn ,@body))
         nil))))

(define-constant +number-text+ "a real number, from -1.7e308 to 1.7e308" :test #'string=
  :documentation "The range of double-floats, as a text for messages.")

(defmacro check-number (operator place)
  "Signal WRONG-ARGUMENT unless PLACE is a double-float or a real number that can be converted to a
double-float. Functions defined by DEFINE-UNBOXED-FUNCTION reject infinities themselves, because an
inline check would box the double-float."
  `(check-argument ,operator ,place (or (typep ,place 'double-float) (finite-p ,place))
                   +number-text+))

(defmacro polynomial (x &rest coefficients)
  "Return the value at X of the polynomial with COEFFICIENTS, constant term first (by Horner)."
  (let ((first (coerce (first coefficients) 'double-float)))
    (if (rest coefficients)
        `(+ ,first (* ,x (polynomial ,x ,@(rest coefficients))))
        first)))

(defmacro with-sum-parts ((high low) ((operator a b)) &body body)
  "Run BODY with HIGH bound to (OPERATOR A B), rounded, and LOW to the error. A must be above B."
  (once-only (a b)
    `(let* ((,high (,operator ,a ,b)) (,low (,operator (- ,a ,high) ,b)))
       (declare (type double-float ,high ,low))
       ,@body)))

(defmacro with-difference-parts ((high low) (a b) &body body)
  "Run BODY with HIGH bound to A - B, rounded, and LOW bound to the rounding error (Knuth)."
  (once-only (a b)
    (with-gensyms (back)
      `(let* ((,high (- ,a ,b)) (,back (- ,high ,a))
              (,low (- (- ,a (- ,high ,back)) (+ ,b ,back))))
         (declare (type double-float ,high ,low ,back))
         ,@body))))

(declaim (inline upper-bits))
(defun upper-bits (number)
  "Return the upper 26 bits of NUMBER, rounded (Veltkamp)."
  (declare (type double-float number))
  (let ((large (* 134217729d0 number)))
    (- large (- large number))))

(declaim (inline product-error))
(defun product-error (a b product)
  "Return the exact product of A and B minus PRODUCT, their rounded product (Dekker)."
  (declare (type double-float a b product))
  (let* ((a-head (upper-bits a)) (a-tail (- a a-head))
         (b-head (upper-bits b)) (b-tail (- b b-head)))
    (+ (* a-tail b-tail)
       (+ (* a-tail b-head)
          (+ (* a-head b-tail)
             (- (* a-head b-head) product))))))

(defconstant +rounding-shift+ 6755399441055744d0
  "1.5 times 2^52. Adding and then subtracting it rounds a double-float up to 2^51 to an integer.")

(declaim (inline round-to-whole))
(defun round-to-whole (number)
  "Return NUMBER, a double-float up to 2^51, rounded to a whole number."
  (declare (type double-float number))
  (- (+ number +rounding-shift+) +rounding-shift+))

(defmacro define-constant-parts (names fixed &rest bits)
  "Define the constants NAMES, double-floats of BITS significant bits whose sum is FIXED."
  `(progn ,@(loop for name in names for k from 0
                  collect `(define-constant ,name (nth ,k (double-parts ,fixed ,@bits))))))
