;;;; points.lisp -- arithmetic on points, numbers and intervals (manual 3.2.1, Table 3.1).

(in-package :ars-magna.geometry)

;;; Every operation takes operands of one dimension: spans (numbers and intervals) or regions
;;; (points and point intervals). Mixing an element with an interval lifts the element, which
;;; costs nothing here: its lower and upper bounds are the same number (manual 3.2.1).

(deftype finite ()
  "The numbers that can be converted to double-floats."
  '(and real (satisfies finite-p)))

(deftype span ()
  "The type of operands with one dimension: numbers and intervals."
  '(or finite interval))

(deftype region ()
  "The type of operands with two dimensions: points and point intervals."
  '(or pt pt-interval))

(declaim (inline low high low-x high-x low-y high-y))

(defun low (span)
  (if (interval-p span) (%interval-min span) (double span)))

(defun high (span)
  (if (interval-p span) (%interval-max span) (double span)))

(defun low-x (region)
  (if (pt-p region) (%pt-x region) (%interval-min (%pt-interval-x region))))

(defun high-x (region)
  (if (pt-p region) (%pt-x region) (%interval-max (%pt-interval-x region))))

(defun low-y (region)
  (if (pt-p region) (%pt-y region) (%interval-min (%pt-interval-y region))))

(defun high-y (region)
  (if (pt-p region) (%pt-y region) (%interval-max (%pt-interval-y region))))

(defun reject-operand (operator name value expected)
  "Signal WRONG-ARGUMENT, because OPERATOR cannot use VALUE as its operand NAME. The text
EXPECTED says which operands are possible."
  (reject-argument operator name value
                   (if (and (realp value) (not (finite-p value))) +number-text+ expected)))

(defmacro dispatch-on-types (operator operands expected &body clauses)
  "CLAUSES are lists ((TYPE...) FORM...). Evaluate the forms of the first clause whose types fit the
values of the variables OPERANDS. Signals WRONG-ARGUMENT, with the text EXPECTED, if no clause fits
or the result is too large."
  (flet ((test (types)
           `(and ,@(loop for operand in operands
                         for type in types
                         collect `(typep ,operand ',type))))
         (refuse (operand)
           `(reject-operand ',operator ',operand ,operand ,expected)))
    `(check-overflow (,operator ,(first (last operands)))
       (cond ,@(loop for (types . forms) in clauses
                     collect `(,(test types) ,@forms))
             ,@(loop for operand in operands
                     for place from 0
                     for types = (loop for (types) in clauses collect (nth place types))
                     collect `((not (typep ,operand '(or ,@types))) ,(refuse operand)))
             ;; Each operand may be valid alone; then the last does not fit the others.
             (t ,(refuse (first (last operands))))))))

;;; Arithmetic. Each destructive operation reads all that it needs of both operands before it
;;; stores, so that (subtract! a a) is right, and A is as it was if the result is too large; none of
;;; them conses. The others work on a fresh copy.

(declaim (inline %add! %add-region! %product-bounds %neg!))

(defun %add! (interval low high)
  (%set-interval! interval (+ (%interval-min interval) low) (+ (%interval-max interval) high)))

(defun %add-region! (region low-x high-x low-y high-y)
  (let ((x (%pt-interval-x region)) (y (%pt-interval-y region)))
    (%set-region! region
                  (+ (%interval-min x) low-x) (+ (%interval-max x) high-x)
                  (+ (%interval-min y) low-y) (+ (%interval-max y) high-y))))

(defun %neg! (interval)
  ;; 0 - x, not -x, so that no negative zero turns an ATAN2 round.
  (%set-interval! interval (- 0d0 (%interval-max interval)) (- 0d0 (%interval-min interval))))

(defun %product-bounds (interval low high)
  (let ((a (* (%interval-min interval) low))
        (b (* (%interval-min interval) high))
        (c (* (%interval-max interval) low))
        (d (* (%interval-max interval) high)))
    (values (min a b c d) (max a b c d))))

(public add!)
(defun add! (a b)
  "Change A into the sum of A and B; return A. Intervals add bound by bound (manual, Table 3.1)."
  (dispatch-on-types add! (a b) "a PT and a PT, or an INTERVAL or PT-INTERVAL and one like it"
    ((pt pt) (set-pt! a (+ (%pt-x a) (%pt-x b)) (+ (%pt-y a) (%pt-y b))))
    ((interval span) (%add! a (low b) (high b)))
    ((pt-interval region) (%add-region! a (low-x b) (high-x b) (low-y b) (high-y b))))
  a)

(public add)
(defun add (a b)
  "Return the sum of A and B. They are points (as vectors), intervals or point intervals. A number
can stand for an interval, a point for a point interval (manual, Table 3.1)."
  (dispatch-on-types add (a b) "two points or point intervals, or two intervals or numbers"
    ((pt pt) (%make-pt (+ (%pt-x a) (%pt-x b)) (+ (%pt-y a) (%pt-y b))))
    ((finite finite) (+ (double a) (double b)))
    ((span span) (add! (lift a) b))
    ((region region) (add! (lift a) b))))

(public subtract!)
(defun subtract! (a b)
  "Change A into A minus B, and return A. For intervals, the result contains all differences of
their elements (manual, Table 3.1; reading 48)."
  (dispatch-on-types subtract! (a b) "a PT and a PT, or an INTERVAL or PT-INTERVAL and one like it"
    ((pt pt) (set-pt! a (- (%pt-x a) (%pt-x b)) (- (%pt-y a) (%pt-y b))))
    ((interval span) (%add! a (- (high b)) (- (low b))))
    ((pt-interval region)
     (%add-region! a (- (high-x b)) (- (low-x b)) (- (high-y b)) (- (low-y b)))))
  a)

(public subtract)
(defun subtract (a b)
  "Return A minus B. They are two points (as vectors), two intervals, or two point intervals. One of
two intervals may be a number, and one of two point intervals a point (manual, Table 3.1)."
  (dispatch-on-types subtract (a b) "two points or point intervals, or two intervals or numbers"
    ((pt pt) (%make-pt (- (%pt-x a) (%pt-x b)) (- (%pt-y a) (%pt-y b))))
    ((finite finite) (- (double a) (double b)))
    ((span span) (subtract! (lift a) b))
    ((region region) (subtract! (lift a) b))))

(public neg!)
(defun neg! (a)
  "Negate A in place, and return A. The bounds of an interval are swapped (manual, Table 3.1)."
  (dispatch-on-types neg! (a) "a PT, INTERVAL or PT-INTERVAL"
    ((pt) (set-pt! a (- 0d0 (%pt-x a)) (- 0d0 (%pt-y a))))
    ((interval) (%neg! a))
    ((pt-interval)
     (%neg! (%pt-interval-x a))
     (%neg! (%pt-interval-y a))))
  a)

(public neg)
(defun neg (a)
  "Return the negative of A, a point, number, interval or point interval (manual, Table 3.1)."
  (dispatch-on-types neg (a) "a PT, INTERVAL, PT-INTERVAL or number"
    ((finite) (- 0d0 (double a)))
    (((or pt interval pt-interval)) (neg! (copy-obj a)))))

(public mul!)
(defun mul! (a factor)
  "Multiply A by the number FACTOR, and return A. A negative FACTOR swaps the bounds of an interval.
If A is an interval, FACTOR may be an interval too (manual, Table 3.1)."
  (dispatch-on-types mul! (a factor) "a PT, INTERVAL or PT-INTERVAL and a number"
    ((pt finite) (let ((factor (double factor)))
                 (set-pt! a (* (%pt-x a) factor) (* (%pt-y a) factor))))
    ((interval span)
     (multiple-value-call #'%set-interval! a (%product-bounds a (low factor) (high factor))))
    ((pt-interval span)
     (let ((low (low factor)) (high (high factor)))
       (multiple-value-call #'%set-region! a
         (%product-bounds (%pt-interval-x a) low high)
         (%product-bounds (%pt-interval-y a) low high)))))
  a)

(public mul)
(defun mul (a factor)
  "Return A, a point, number, interval or point interval, multiplied by the number FACTOR. If FACTOR
is an interval, return the interval or point interval of all products (manual, Table 3.1)."
  (dispatch-on-types mul (a factor) "a point, interval or point interval and a number"
    ((pt finite) (mul! (copy-obj a) factor))
    ((finite finite) (* (double a) (double factor)))
    ((span span) (mul! (lift a) factor))
    ((region span) (mul! (lift a) factor))))

;;; Lengths.

(declaim (inline euclidean-length least-absolute-value greatest-absolute-value))

(defun scaled-length (x y most)
  "Return the length of the vector (X, Y), even if the squares of X and Y overflow or underflow.
MOST is the larger of their absolute values."
  (declare (type double-float x y most))
  ;; So that a box's sides and diagonals can be added.
  (when (<= 1d308 most) (error 'floating-point-overflow :operation 'norm :operands (list x y)))
  (let ((x (/ x most)) (y (/ y most)))
    (* most (sqrt (+ (* x x) (* y y))))))

(defun euclidean-length (x y)
  (declare (type double-float x y))
  (let ((most (max (abs x) (abs y))))
    (if (or (< 1d-140 most 1d140) (zerop most))
        (sqrt (+ (* x x) (* y y)))
        (scaled-length x y most))))

(defun least-absolute-value (interval)
  (max 0d0 (%interval-min interval) (- (%interval-max interval))))

(defun greatest-absolute-value (interval)
  (max (abs (%interval-min interval)) (abs (%interval-max interval))))

(public norm)
(defun norm (a)
  "Return the Euclidean length of the vector to the point A, in metres. If A is an interval or point
interval, return the INTERVAL of the lengths of its elements (manual, Table 3.1)."
  (dispatch-on-types norm (a) "a PT, INTERVAL, PT-INTERVAL or number"
    ((pt) (euclidean-length (%pt-x a) (%pt-y a)))
    ((finite) (abs (double a)))
    ((interval) (%make-interval (least-absolute-value a) (greatest-absolute-value a)))
    ((pt-interval)
     (let ((x (%pt-interval-x a)) (y (%pt-interval-y a)))
       (%make-interval (euclidean-length (least-absolute-value x) (least-absolute-value y))
                       (euclidean-length (greatest-absolute-value x)
                                         (greatest-absolute-value y)))))))

(public dist)
(defun dist (a b)
  "Return the Euclidean distance of the points A and B, in metres. If A or B is an interval or point
interval, return the INTERVAL of the distances of their elements (manual, Table 3.1; reading 42)."
  (dispatch-on-types dist (a b) "two points or point intervals, or two intervals or numbers"
    ((pt pt) (euclidean-length (- (%pt-x a) (%pt-x b)) (- (%pt-y a) (%pt-y b))))
    ((span span) (norm (subtract a b)))
    ((region region) (norm (subtract a b)))))
