;;;; types.lisp -- PT, INTERVAL and PT-INTERVAL: making, reading, changing, printing them.

(in-package :ars-magna.geometry)

(export '(pt-p set-pt! set-interval! set-pt-interval!))

;;; All numbers in here are double-floats; any real is accepted and coerced. An interval never
;;; has its min above its max. A point interval owns its two intervals: no other object shares
;;; them, so that a destructive operation changes its first operand only (manual 3.2.1).

;;; None of these contains infinities, NaNs or other numbers beyond double-floats, and DISPATCH (see
;;; points.lisp) signals an error if a result would.

(defmacro check-finite (operator place)
  `(check-argument ,operator ,place (finite-p ,place) +number-text+))

(define-condition beyond-floats (wrong-argument)
  ()
  (:default-initargs :expected "operands whose result is not beyond 1.7e308 either way")
  (:documentation "The result of an operation is too large for a double-float."))

;; An operation that uses another one reports its own operands.
(defmacro check-overflow ((operator operand) &body body)
  "If a floating-point number overflows in BODY, signal WRONG-ARGUMENT about the variable OPERAND."
  `(handler-case (progn ,@body)
     ((or floating-point-overflow beyond-floats) ()
       (error 'beyond-floats :operator ',operator :name ',operand :value ,operand))))

;;; Points.

(public pt)
(define-record (pt (:constructor %make-pt (x y)) (:conc-name %pt-)
                   (:predicate pt-p "True of a PT."))
  "A point or vector in the plane, in metres: x grows to the right, y downward (manual 3.2.1)."
  (x 0d0 double-float :writable)
  (y 0d0 double-float :writable))
(declaim-final pt)

(declaim (inline make-pt set-pt!))

(addition make-pt)
(defun make-pt (x y)
  "Return the point (X, Y). X and Y are real numbers, in metres, from -1.7e308 to 1.7e308. In Nisp,
write (make PT X Y). Signals WRONG-ARGUMENT."
  (check-finite make-pt x)
  (check-finite make-pt y)
  (%make-pt (double x) (double y)))

(defmacro define-number-accessor (name (raw value object) check documentation)
  "Define the accessor NAME: it reads OBJECT with the accessor RAW; its SETF function evaluates
CHECK, then stores VALUE as a double-float."
  `(progn
     (addition ,name)
     (settable ,name)
     (declaim (inline ,name (setf ,name)))
     (defun ,name (,object) ,documentation (,raw ,object))
     (defun (setf ,name) (,value ,object)
       ,check
       (setf (,raw ,object) (double ,value)))))

(define-number-accessor pt-x (%pt-x x pt) (check-finite pt-x x)
  "Return the horizontal coordinate of PT, in metres. Can be set.")

(define-number-accessor pt-y (%pt-y y pt) (check-finite pt-y y)
  "Return the vertical coordinate of PT, in metres, growing downward. Can be set.")

(defun set-pt! (pt x y)
  "Move PT to (X, Y) and return it."
  (setf (%pt-x pt) (double x)
        (%pt-y pt) (double y))
  pt)

;;; Intervals.

(public interval)
(define-record (interval (:constructor %make-interval (min max)) (:conc-name %interval-)
                         (:predicate interval-p "True of an INTERVAL."))
  "The real numbers from min to max, both included: an uncertain number (manual 3.2.1)."
  (min 0d0 double-float :writable)
  (max 0d0 double-float :writable))
(declaim-final interval)

(declaim (inline %set-interval!))

(defun %set-interval! (interval min max)
  (setf (%interval-min interval) min
        (%interval-max interval) max)
  interval)

(addition make-interval)
(defun make-interval (min max)
  "Return the interval from MIN to MAX, real numbers from -1.7e308 to 1.7e308. MIN above MAX is an
error. In Nisp, write (make INTERVAL MIN MAX). Signals WRONG-ARGUMENT."
  (check-finite make-interval min)
  (check-finite make-interval max)
  (check-argument make-interval min (<= min max) "a number that is not above the max")
  (%make-interval (double min) (double max)))

(define-number-accessor interval-min (%interval-min min interval)
    (check-argument interval-min min (and (finite-p min) (<= min (%interval-max interval)))
                    "a number that is not above the max; set the max first")
  "Return the lower bound of INTERVAL. Can be set to a number that is not above the upper bound.")

(define-number-accessor interval-max (%interval-max max interval)
    (check-argument interval-max max (and (finite-p max) (>= max (%interval-min interval)))
                    "a number that is not below the min; set the min first")
  "Return the upper bound of INTERVAL. Can be set to a number that is not below the lower bound.")

(declaim (inline set-interval!))
(defun set-interval! (interval min max)
  "Set the bounds of INTERVAL to reals MIN and MAX. MIN above MAX is an error. Return INTERVAL."
  (check-argument set-interval! min (<= min max) "a number that is not above the max")
  (%set-interval! interval (double min) (double max)))

;;; Point intervals.

(public pt-interval)
(define-record (pt-interval (:constructor %make-pt-interval (x y)) (:conc-name %pt-interval-)
                            (:predicate pt-interval-p "True of a PT-INTERVAL."))
  "A box with sides parallel to the axes: an uncertain point (manual 3.2.1)."
  (x (%make-interval 0d0 0d0) interval)
  (y (%make-interval 0d0 0d0) interval))
(declaim-final pt-interval)

(addition make-pt-interval)
(defun make-pt-interval (a b)
  "Return the box whose sides are the intervals A (along x) and B (along y), or whose opposite
corners are the points A and B, in any order. The intervals are copied. A number stands for the
interval that contains only this number. In Nisp, write (make PT-INTERVAL A B). See reading 43."
  (cond ((and (pt-p a) (pt-p b))
         (%make-pt-interval (span-between (%pt-x a) (%pt-x b))
                            (span-between (%pt-y a) (%pt-y b))))
        (t
         (dolist (side (list a b))
           (check-argument make-pt-interval side (or (interval-p side) (finite-p side))
                           "two points, or two intervals or numbers from -1.7e308 to 1.7e308"))
         (%make-pt-interval (lift a) (lift b)))))

(defun span-between (a b)
  "Return the interval with the ends A and B, in either order."
  (declare (type double-float a b))
  (%make-interval (min a b) (max a b)))

(defun lift (x)
  "If X is an interval, return a copy; for a number or point, an interval that contains only X."
  (etypecase x
    (real (let ((x (double x))) (%make-interval x x)))
    (interval (%make-interval (%interval-min x) (%interval-max x)))
    (pt (%make-pt-interval (lift (%pt-x x)) (lift (%pt-y x))))
    (pt-interval (%make-pt-interval (lift (%pt-interval-x x)) (lift (%pt-interval-y x))))))

(defmacro define-side-accessor (name raw axis)
  "Define the accessor NAME. It returns the side of a point interval along AXIS, read with RAW. The
SETF function of NAME copies the bounds of an interval into that side."
  `(progn
     (addition ,name)
     (settable ,name)
     (declaim (inline ,name))
     (defun ,name (pt-interval)
       ,(format nil "Return the INTERVAL along ~A of PT-INTERVAL, not a copy: changing the ~
                     INTERVAL changes~%PT-INTERVAL. Can be set to an INTERVAL, whose bounds are ~
                     copied." axis)
       (,raw pt-interval))
     (defun (setf ,name) (interval pt-interval)
       (check-argument ,name interval (interval-p interval) "an interval")
       (%set-interval! (,raw pt-interval) (%interval-min interval) (%interval-max interval))
       interval)))

(define-side-accessor pt-interval-x %pt-interval-x "x")
(define-side-accessor pt-interval-y %pt-interval-y "y")

(defun side-length (side)
  (- (%interval-max side) (%interval-min side)))

(addition pt-interval-dx)
(defun pt-interval-dx (pt-interval)
  "Return the width of PT-INTERVAL along x, in metres."
  (check-overflow (pt-interval-dx pt-interval)
    (side-length (%pt-interval-x pt-interval))))

(addition pt-interval-dy)
(defun pt-interval-dy (pt-interval)
  "Return the width of PT-INTERVAL along y, in metres."
  (check-overflow (pt-interval-dy pt-interval)
    (side-length (%pt-interval-y pt-interval))))

;; Inline, so that bounds need not be boxed on the way.
(declaim (inline %set-region! set-pt-interval!))
(defun %set-region! (pt-interval x-min x-max y-min y-max)
  (%set-interval! (%pt-interval-x pt-interval) x-min x-max)
  (%set-interval! (%pt-interval-y pt-interval) y-min y-max)
  pt-interval)

(defun set-pt-interval! (pt-interval x-min x-max y-min y-max)
  "Set the bounds, real numbers, of PT-INTERVAL along x and along y. Return PT-INTERVAL."
  (check-argument set-pt-interval! x-min (<= x-min x-max) "a number that is not above x-max")
  (check-argument set-pt-interval! y-min (<= y-min y-max) "a number that is not above y-max")
  (%set-region! pt-interval (double x-min) (double x-max) (double y-min) (double y-max)))

;;; Copies, equality, print forms.

(public copy-obj)
(defun copy-obj (object)
  "Return a fresh copy of OBJECT, a PT, INTERVAL or PT-INTERVAL (its sides are copied too), or
return OBJECT itself if it is a number (manual 3.2.1; reading 234)."
  (typecase object
    (real object)
    (pt (%make-pt (%pt-x object) (%pt-y object)))
    ((or interval pt-interval) (lift object))
    (t (check-argument copy-obj object nil "a PT, INTERVAL or PT-INTERVAL"))))

(public equal)
(defun equal (a b)
  "True if A and B are PTs, INTERVALs or PT-INTERVALs with exactly the same numbers. Other objects
are compared by CL:EQUAL (manual 3.2.1; reading 30). This function can be the test of a hash table;
keys of the table must not be modified."
  (typecase a
    (pt (and (pt-p b) (= (%pt-x a) (%pt-x b)) (= (%pt-y a) (%pt-y b))))
    (interval (and (interval-p b)
                   (= (%interval-min a) (%interval-min b))
                   (= (%interval-max a) (%interval-max b))))
    (pt-interval (and (pt-interval-p b)
                      (equal (%pt-interval-x a) (%pt-interval-x b))
                      (equal (%pt-interval-y a) (%pt-interval-y b))))
    (t (cl:equal a b))))

;; 0 and -0 are the same here, and not to SXHASH.
(defun equal-hash (object)
  "Return a hash code, an integer, of OBJECT. Objects that are EQUAL have the same hash code."
  (flet ((mix (a b) (sxhash (list (+ 0d0 a) (+ 0d0 b)))))
    (typecase object
      (pt (mix (%pt-x object) (%pt-y object)))
      (interval (mix (%interval-min object) (%interval-max object)))
      (pt-interval (logxor (equal-hash (%pt-interval-x object))
                           (* 3 (ash (equal-hash (%pt-interval-y object)) -3))))
      (t (sxhash object)))))

(sb-ext:define-hash-table-test equal equal-hash)

(defun shown-number (number)
  "Return NUMBER rounded for printing: to a millionth, if floats of its size are that exact."
  (if (< (abs number) 1d9)
      (+ 0d0 (/ (fround (* number 1d6)) 1d6))
      number))

(defun print-value (object stream numbers control &rest parts)
  "Print OBJECT to STREAM. For PRINC, print PARTS with the format string CONTROL; for other
functions, print #< > with NUMBERS rounded to a millionth."
  (if (or *print-escape* *print-readably*)
      (let ((*read-default-float-format* 'double-float))
        (print-unreadable-object (object stream)
          (format stream "~A~{ ~A~}" (symbol-name (type-of object))
                  (mapcar #'shown-number numbers))))
      (apply #'format stream control parts)))

(defun interval-bounds (interval)
  (list (%interval-min interval) (%interval-max interval)))

(defmethod print-object ((pt pt) stream)
  (let ((numbers (list (%pt-x pt) (%pt-y pt))))
    (print-value pt stream numbers "(~{~,2F~^,~})" numbers)))

(defmethod print-object ((interval interval) stream)
  (print-value interval stream (interval-bounds interval) "[~{~,2F~^,~}]"
               (interval-bounds interval)))

(defmethod print-object ((pt-interval pt-interval) stream)
  (let ((x (%pt-interval-x pt-interval)) (y (%pt-interval-y pt-interval)))
    (print-value pt-interval stream (append (interval-bounds x) (interval-bounds y)) "(~A,~A)" x
                 y)))
