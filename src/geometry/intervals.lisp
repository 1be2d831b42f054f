;;;; intervals.lisp -- comparing, joining and growing intervals (manual 3.2.1, Table 3.2).

(in-package :ars-magna.geometry)

;;; Bounds belong to their interval. In two dimensions a comparison holds if it holds along both
;;; axes. Where the table says x, the operand is an element: a number or a point.

(defmacro define-comparison (name combine (low-a high-a low-b high-b) documentation form)
  "Define NAME, a function of two intervals. In FORM, the four variables hold the bounds of both
intervals along an axis. COMBINE joins the values of FORM for two axes."
  `(progn
     (public ,name)
     (defun ,name (a b)
       ,documentation
       (flet ((compare (,low-a ,high-a ,low-b ,high-b)
                (declare (type double-float ,low-a ,high-a ,low-b ,high-b)
                         (ignorable ,low-a ,high-a ,low-b ,high-b))
                ,form))
         (declare (inline compare))
         (dispatch-on-types ,name (a b) "two intervals or numbers, or two point intervals or points"
           ((span span) (compare (low a) (high a) (low b) (high b)))
           ((region region)
            (,combine (compare (low-x a) (high-x a) (low-x b) (high-x b))
                      (compare (low-y a) (high-y a) (low-y b) (high-y b)))))))))

(define-comparison interval-intersect? and (low-a high-a low-b high-b)
  "True if the intervals A and B have a common element; bounds count (manual, Table 3.2)."
  (and (<= low-a high-b) (<= low-b high-a)))

(define-comparison interval-subset? and (low-a high-a low-b high-b)
  "True if every element of the interval A is in the interval B (manual, Table 3.2)."
  (and (<= low-b low-a) (<= high-a high-b)))

(define-comparison less and (low-a high-a low-b high-b)
  "True if every element of the interval A is less than every element of the interval B. For point
intervals, this must be true along both axes (manual, Table 3.2)."
  (< high-a low-b))

(define-comparison greater and (low-a high-a low-b high-b)
  "True if every element of the interval A is greater than every element of the interval B. For
point intervals, this must be true along both axes (manual, Table 3.2)."
  (> low-a high-b))

;; As reading 46 says.
(define-comparison interval-dist max (low-a high-a low-b high-b)
  "Return the gap between the intervals A and B, 0 if and only if they intersect. For point
intervals, return the wider of the gaps along the two axes (manual, Table 3.2)."
  (max 0d0 (- low-a high-b) (- low-b high-a)))

(public in-interval)
(defun in-interval (x interval)
  "True if the number or point X is in INTERVAL, bounds included (manual, Table 3.2)."
  (dispatch-on-types in-interval (x interval) "a number and an INTERVAL, or a PT and a PT-INTERVAL"
    ((finite span) (<= (low interval) (double x) (high interval)))
    ((pt region) (and (<= (low-x interval) (%pt-x x) (high-x interval))
                      (<= (low-y interval) (%pt-y x) (high-y interval))))))

;;; Measures.

(declaim (inline centre))
(defun centre (low high)
  (declare (type double-float low high))
  (* 0.5d0 (+ low high)))

(public interval-width)
(defun interval-width (interval)
  "Return the largest distance between two elements of INTERVAL. For a point interval, this is the
diagonal (manual, Table 3.2; reading 45)."
  (dispatch-on-types interval-width (interval) "an INTERVAL or PT-INTERVAL"
    ((span) (- (high interval) (low interval)))
    ((region) (euclidean-length (- (high-x interval) (low-x interval))
                                (- (high-y interval) (low-y interval))))))

(public interval-overlap-width)
(defun interval-overlap-width (a b)
  "Return the width of the intersection of the intervals A and B; 0 if they do not intersect
(manual, Table 3.2; reading 47)."
  (flet ((width ()
           (let ((common (interval-intersect a b)))
             (if common (interval-width common) 0d0))))
    (dispatch-on-types interval-overlap-width (a b) "two intervals or two point intervals"
      ((span span) (width))
      ((region region) (width)))))

(public nominal)
(defun nominal (interval)
  "Return the centre of INTERVAL, the best estimate: a number, or a new PT (manual, Table 3.2)."
  (dispatch-on-types nominal (interval) "an INTERVAL or PT-INTERVAL"
    ((span) (centre (low interval) (high interval)))
    ((region) (%make-pt (centre (low-x interval) (high-x interval))
                        (centre (low-y interval) (high-y interval))))))

;;; Intersection.

(declaim (inline %intersect!))
(defun %intersect! (interval low high)
  (%set-interval! interval (max (%interval-min interval) low) (min (%interval-max interval) high)))

(public interval-intersect!)
(defun interval-intersect! (a b)
  "Change A into the intersection of the intervals A and B, and return A. If they do not intersect,
leave A unchanged and return NIL (manual, Table 3.2; reading 44)."
  (dispatch-on-types interval-intersect! (a b) "an INTERVAL or PT-INTERVAL and one like it"
    ((interval span)
     (when (interval-intersect? a b)
       (%intersect! a (low b) (high b))))
    ((pt-interval region)
     (when (interval-intersect? a b)
       (%intersect! (%pt-interval-x a) (low-x b) (high-x b))
       (%intersect! (%pt-interval-y a) (low-y b) (high-y b))
       a))))

(public interval-intersect)
(defun interval-intersect (a b)
  "Return the intersection of the intervals A and B, a new interval, or NIL (manual, Table 3.2)."
  (dispatch-on-types interval-intersect (a b) "two intervals or two point intervals"
    ((span span) (interval-intersect! (lift a) b))
    ((region region) (interval-intersect! (lift a) b))))

;;; The least bounding interval (LBI).

(declaim (inline %bound!))
(defun %bound! (interval low high)
  (%set-interval! interval (min (%interval-min interval) low) (max (%interval-max interval) high)))

(public interval-lbi!)
(defun interval-lbi! (a b)
  "Grow the interval A minimally to contain the interval B, and return A (manual, Table 3.2)."
  (dispatch-on-types interval-lbi! (a b) "an INTERVAL or PT-INTERVAL and one like it"
    ((interval span) (%bound! a (low b) (high b)))
    ((pt-interval region)
     (%bound! (%pt-interval-x a) (low-x b) (high-x b))
     (%bound! (%pt-interval-y a) (low-y b) (high-y b))))
  a)

(public interval-lbi)
(defun interval-lbi (a b)
  "Return the least interval that contains the intervals A and B (manual, Table 3.2)."
  (dispatch-on-types interval-lbi (a b) "two intervals or two point intervals"
    ((span span) (interval-lbi! (lift a) b))
    ((region region) (interval-lbi! (lift a) b))))

(public add-to-lbi!)
(defun add-to-lbi! (interval x)
  "Grow INTERVAL minimally to contain the number or point X; return INTERVAL (manual, Table 3.2)."
  (dispatch-on-types add-to-lbi! (interval x) "an INTERVAL and a number, or a PT-INTERVAL and a PT"
    ((interval finite) (interval-lbi! interval x))
    ((pt-interval pt) (interval-lbi! interval x))))

(public add-to-lbi)
(defun add-to-lbi (interval x)
  "Return the least interval that contains INTERVAL and the number or point X (manual, Table 3.2)."
  (dispatch-on-types add-to-lbi (interval x) "an INTERVAL and a number, or a PT-INTERVAL and a PT"
    ((span finite) (interval-lbi! (lift interval) x))
    ((region pt) (interval-lbi! (lift interval) x))))

(public interval-lift)
(defun interval-lift (x)
  "Return the interval that contains only X, a number or a point (manual, Table 3.2)."
  (dispatch-on-types interval-lift (x) "a number or a PT"
    (((or finite pt)) (lift x))))

(public lift-lbi)
(defun lift-lbi (x &rest more)
  "Return the least interval that contains X and MORE, all numbers or points (manual, Table 3.2)."
  (declare (dynamic-extent more))
  (check-argument lift-lbi x (typep x '(or finite pt)) "a number or a PT")
  (let ((interval (lift x)))
    (dolist (x more interval)
      (dispatch-on-types lift-lbi (interval x) "all numbers or all points"
        ((interval finite) (interval-lbi! interval x))
        ((pt-interval pt) (interval-lbi! interval x))))))

;;; Growth.

(declaim (inline %grown-bounds))
(defun %grown-bounds (interval amount)
  "Return the bounds of INTERVAL grown by AMOUNT; a negative AMOUNT shrinks, at most to the centre."
  (let ((low (- (%interval-min interval) amount))
        (high (+ (%interval-max interval) amount)))
    (if (<= low high)
        (values low high)
        (let ((centre (centre (%interval-min interval) (%interval-max interval))))
          (values centre centre)))))

(public grow-interval!)
(defun grow-interval! (interval amount)
  "Move each boundary of INTERVAL outward by the number AMOUNT, and return INTERVAL. A negative
AMOUNT shrinks INTERVAL, at most to its centre (manual, Table 3.2)."
  (dispatch-on-types grow-interval! (interval amount) "an INTERVAL or PT-INTERVAL and a number"
    ((interval finite)
     (multiple-value-call #'%set-interval! interval (%grown-bounds interval (double amount))))
    ((pt-interval finite)
     (multiple-value-call #'%set-region! interval
       (%grown-bounds (%pt-interval-x interval) (double amount))
       (%grown-bounds (%pt-interval-y interval) (double amount)))))
  interval)

(public grow-interval)
(defun grow-interval (interval amount)
  "Return a new interval: INTERVAL with each boundary moved outward by the number AMOUNT. A negative
AMOUNT shrinks the new interval, at most to the centre of INTERVAL (manual, Table 3.2)."
  (dispatch-on-types grow-interval (interval amount) "an INTERVAL or PT-INTERVAL and a number"
    ((span finite) (grow-interval! (lift interval) amount))
    ((region finite) (grow-interval! (lift interval) amount))))
