;;;; elementary.lisp -- accuracy, exact cases and bits of sine, logarithm and the like.

(in-package :ars-magna.tests)

(def-suite* elementary :in ars-magna)

;;; Arithmetic to compare with: integers that count units of 2^-*PRECISION*.

(defvar *precision* 256 "How many binary places numbers have that are called exact here.")

(defun exact (number)
  "Return the real NUMBER in units of 2^-*PRECISION*."
  (round (* (rational number) (ash 1 *precision*))))

(defun exact-times (a b) (ash (* a b) (- *precision*)))
(defun exact-over (a b) (round (ash a *precision*) b))

(defun exact-sum (first factor)
  "Return the sum of FIRST and what follows: the term K is the one before, times (FACTOR K)."
  (loop for k from 1
        for term = first then (exact-times term (funcall factor (1- k)))
        until (zerop term) sum term))

(defun exact-arccotangent (whole)
  (loop for power = (round (exact 1) whole) then (round power (- (* whole whole)))
        for k from 1 by 2
        until (zerop power) sum (round power k)))

(defun exact-pi ()
  "Return pi (Gauss's formula)."
  (* 4 (+ (* 12 (exact-arccotangent 18)) (* 8 (exact-arccotangent 57))
          (* -5 (exact-arccotangent 239)))))

(defun exact-exponential (x)
  "Return e^X for an exact X."
  (let ((value (exact-sum (exact 1) (lambda (k) (round x (* k 4096))))))
    (loop repeat 12 do (setf value (exact-times value value)))
    value))

(defun exact-sine (x &optional (quarters 0))
  "Return the sine of the exact X and so many right angles QUARTERS."
  (let* ((x (rem (+ x (* quarters (round (exact-pi) 2))) (* 2 (exact-pi))))
         (square (exact-times x x)))
    (exact-sum x (lambda (k) (round (- square) (* 2 k (1+ (* 2 k))))))))

(defun better-logarithm (x guess)
  "Return the logarithm of the exact X; GUESS is near it."
  (let ((power (exact-exponential guess)))
    (+ guess (* 2 (exact-over (- x power) (+ x power))))))

(defun better-angle (y x guess)
  "Return the angle of the direction (X, Y), numbers; GUESS, a double-float, is near it."
  (let ((sine (exact-sine (exact guess))) (cosine (exact-sine (exact guess) 1))
        (scale (max (abs x) (abs y))))
    (let ((y (exact (/ (rational y) (rational scale))))
          (x (exact (/ (rational x) (rational scale)))))
      (+ (exact guess)
         (exact-over (- (exact-times y cosine) (exact-times x sine))
                     (+ (exact-times x cosine) (exact-times y sine)))))))

(defun units-off (number exact)
  "Return by how many units in its last place the double-float NUMBER is off EXACT."
  (multiple-value-bind (digits exponent) (integer-decode-float number)
    (declare (ignore digits))
    (double-float-of (/ (abs (- (exact number) exact)) (exact (expt 2 exponent))))))

(defun double-float-of (number) (coerce number 'double-float))

;;; Arguments, from a generator of the tests' own.

(defun numbers-between (low high count seed)
  "Return a list of COUNT double-floats from LOW to HIGH."
  (loop with state = seed
        repeat count
        do (setf state (ldb (byte 64 0) (+ (* state 6364136223846793005) 1442695040888963407)))
        collect (+ low (* (- high low) (/ (ash state -12) (double-float-of (ash 1 52)))))))

(defun numbers-of-sizes (least most count seed)
  "Return a list of COUNT double-floats of both signs, with exponents of 2 from LEAST to MOST."
  (loop for size in (numbers-between 1d0 2d0 count seed)
        for exponent in (numbers-between least most count (1+ seed))
        for k from 0
        collect (* (if (evenp k) 1 -1) (scale-float size (floor exponent)))))

(defun worst (error &rest lists)
  "Return the greatest value of the function ERROR for elements of LISTS."
  (apply #'max (apply #'mapcar error lists)))

;;; Accuracy. Numbers up to 2^1023 take 1,400 binary places.

(defun sine-error (x) (units-off (base:sine x) (exact-sine (exact x))))
(defun cosine-error (x) (units-off (base:cosine x) (exact-sine (exact x) 1)))

(test sines.are-within-0.6-units-of-the-last-place
  (dolist (error '(sine-error cosine-error))
    (is (> 0.6d0 (worst error (numbers-between -7d0 7d0 400 1))))
    (is (> 0.6d0 (worst error (numbers-between -1.7d6 1.7d6 200 2))))
    (is (> 0.6d0 (worst error (numbers-between -1d9 1d9 100 3))))
    (is (> 0.6d0 (worst error (numbers-of-sizes -30 3 200 4))))))

(test sines.of-huge-angles-are-exact-too
  (let ((*precision* 1400))
    (dolist (error '(sine-error cosine-error))
      (is (> 0.6d0 (worst error (numbers-of-sizes 20 1023 12 5))))
      ;; The double-float that is nearest to a multiple of a right angle, as far as its size goes.
      (is (> 0.6d0 (funcall error (scale-float 6381956970095103d0 797)))))))

(test sines.near-multiples-of-right-angles-are-exact-too
  (dolist (k '(1 2 3 4 5 6 100 1000 99999 1000000))
    (let ((x (* k (/ pi 2))))
      (is (> 0.6d0 (sine-error x)) "~D" k)
      (is (> 0.6d0 (cosine-error x)) "~D" k))))

(defun exponential-error (x)
  (units-off (base:exponential x) (exact-exponential (exact x))))

(defun logarithm-error (x)
  (let ((value (base:logarithm x)))
    (if (zerop value) 0d0 (units-off value (better-logarithm (exact x) (exact value))))))

(defun power-error (base exponent)
  (units-off (base:power base exponent)
             (exact-exponential
              (exact-times (exact exponent)
                           (better-logarithm (exact base) (exact (base:logarithm base)))))))

(test exponentials.are-within-0.6-units-of-the-last-place
  (is (> 0.6d0 (worst #'exponential-error (numbers-between -20d0 20d0 300 6))))
  (is (> 0.6d0 (worst #'logarithm-error (numbers-between 0.4d0 2.5d0 300 7))))
  (is (> 0.6d0 (worst #'logarithm-error (numbers-between 0.99d0 1.01d0 300 8))))
  (let ((*precision* 2400))
    (is (> 0.6d0 (worst #'exponential-error (numbers-between -700d0 700d0 20 9))))
    (is (> 0.6d0 (worst #'logarithm-error (mapcar #'abs (numbers-of-sizes -1000 1000 10 10)))))))

(test powers.are-within-0.6-units-of-the-last-place
  (is (> 0.6d0 (worst #'power-error (numbers-between 0.1d0 10d0 200 11)
                      (numbers-between -20d0 20d0 200 12))))
  (is (> 0.6d0 (worst #'power-error (numbers-between 0.99d0 1.01d0 100 13)
                      (numbers-between -3000d0 3000d0 100 14)))))

(defun arctangent-error (y x)
  (let ((value (base:arctangent y x))) (units-off value (better-angle y x value))))

(test arctangents.are-within-0.6-units-of-the-last-place
  (is (> 0.6d0 (worst #'arctangent-error (numbers-between -75d0 75d0 400 15)
                      (numbers-between -75d0 75d0 400 16))))
  (is (> 0.6d0 (worst #'arctangent-error (numbers-of-sizes -20 20 200 17)
                      (numbers-of-sizes -20 20 200 18))))
  (is (> 0.6d0 (worst #'arctangent-error (numbers-of-sizes 1000 1020 50 19)
                      (numbers-of-sizes 1000 1020 50 20))))
  (is (> 0.6d0 (worst #'arctangent-error (numbers-of-sizes -1020 -1000 50 21)
                      (numbers-of-sizes -1020 -1000 50 22)))))

;;; Exact cases.

(test elementary.exact-cases
  (is (eql 0d0 (base:sine 0)))
  (is (eql -0d0 (base:sine -0d0)))
  (is (eql 1d0 (base:cosine 0)))
  (is (eql 1d0 (base:sine (/ pi 2))))
  (is (eql -1d0 (base:cosine pi)))
  (is (eql 1d0 (base:exponential 0)))
  (is (eql 0d0 (base:logarithm 1)))
  (is (eql 0d0 (base:exponential -1000)))
  (is (eql 1d0 (base:power 0 0)))
  (is (eql 0d0 (base:power 0 2)))
  (is (eql 3d0 (base:power 9 1/2)))
  (loop for k from -1000 to 1000 do (is (eql (scale-float 1d0 k) (base:power 2 k))))
  (loop for k from 0 to 22 do (is (eql (double-float-of (expt 10 k)) (base:power 10 k)))))

(test arctangents.along-axes-and-diagonals
  (loop for (y x turn) in '((0d0 1d0 0) (1d0 1d0 1/4) (1d0 0d0 1/2) (1d0 -1d0 3/4) (0d0 -1d0 1)
                            (-1d0 -1d0 -3/4) (-1d0 0d0 -1/2) (-1d0 1d0 -1/4) (-0d0 -1d0 -1)
                            (0d0 -0d0 1) (0d0 0d0 0) (1d0 -0d0 1/2))
        do (is (= (* turn pi) (base:arctangent y x)) "~A ~A" y x))
  (is (eql -0d0 (base:arctangent -0d0 1d0))))

(test elementary.mistakes-are-told
  (loop for (function . data) in '((base:sine "1" nil #c(1 1)) (base:cosine "1" nil #c(1 1))
                                   (base:exponential "1" nil #c(1 1)) (base:logarithm "1" nil 0 -1)
                                   (base:power nil -1))
        do (dolist (datum data)
             (signals base:wrong-argument
               (apply function datum (if (eq function 'base:power) '(2))))))
  (signals base:wrong-argument (base:sine sb-ext:double-float-positive-infinity))
  (signals base:wrong-argument (funcall 'base:power 0 -1))
  (signals floating-point-overflow (base:exponential 1000))
  (signals floating-point-overflow (base:power 10 1000)))

;;; The same bits on each machine, which were computed by SBCL 2.2.9, 2.5.2 and 2.6.4.

(defun bits-of-results (function &rest lists)
  "Return a number for the bits of what FUNCTION returns for the elements of LISTS."
  (let ((digest (base:make-digest)))
    (apply #'mapc (lambda (&rest numbers) (base:digest-add digest (apply function numbers))) lists)
    (base:digest-value digest)))

(defun angles-of-all-sizes ()
  (append (numbers-between -7d0 7d0 10000 31) (numbers-between -2000d0 2000d0 6000 32)
          (numbers-of-sizes -60 60 4000 33)))

(test elementary.bits-are-the-same-everywhere
  (let ((positive (append (numbers-between 1d-9 2d0 10000 34) (numbers-between 0d0 1d6 8000 35)
                          (mapcar #'abs (numbers-of-sizes -1000 1000 2000 36))))
        (exponents (numbers-between -20d0 20d0 20000 37))
        (coordinates (append (numbers-between -75d0 75d0 16000 38)
                             (numbers-of-sizes -60 60 4000 39))))
    (is (= 76286142318942004 (bits-of-results #'base:sine (angles-of-all-sizes))))
    (is (= 17535667687499023138 (bits-of-results #'base:cosine (angles-of-all-sizes))))
    (is (= 18154158609675027560 (bits-of-results #'base:arctangent coordinates
                                                 (reverse coordinates))))
    (is (= 7177212516642886819 (bits-of-results #'base:exponential exponents)))
    (is (= 15866779482634750194 (bits-of-results #'base:logarithm positive)))
    (is (= 2798518815710311983 (bits-of-results #'base:power (subseq positive 0 18000)
                                (subseq exponents 0 18000))))))

;;; Nothing is allocated.

(defun sum-of-results (count)
  "Return a sum of what each function returns for arguments that nobody knows at compile time."
  (declare (type fixnum count) (optimize speed))
  (let ((sum 0d0))
    (declare (type double-float sum))
    (dotimes (k count (truncate (min 1d6 sum)))
      (let ((x (+ 0.5d0 (* k 1d-4))))
        (incf sum (+ (base:sine x) (base:cosine x) (base:arctangent x 2d0)
                     (base:exponential (- x)) (base:logarithm x) (base:power x 0.3d0)))))))

(test elementary.conses-nothing
  (sum-of-results 10)
  (let ((before (sb-ext:get-bytes-consed)))
    (sum-of-results 10000)
    (is (> 100000 (- (sb-ext:get-bytes-consed) before)))))
