;;;; double-parts.lisp -- how elementary functions compute with more digits than a double-float has.

(in-package :ars-magna.basics)

;;; A number with some 106 bits is kept as two parts, double-floats whose sum it is.

;;; A full call boxes its double-floats. So inline functions pass them in a vector on the stack. The
;;; last cell is for the result: a result in the cell of an argument takes 5 ns more.

(defmacro in-cells (function &rest numbers)
  "Return the double-float that FUNCTION puts behind NUMBERS, in the last cell of a vector."
  (with-gensyms (cells)
    (let ((count (length numbers)))
      `(let ((,cells (make-array ,(1+ count) :element-type 'double-float)))
         (declare (dynamic-extent ,cells))
         (setf ,@(loop for number in numbers for k from 0 append `((aref ,cells ,k) ,number)))
         (,function ,cells)
         (aref ,cells ,count)))))

(defmacro define-put (name (&rest arguments) &body body)
  "Define the function NAME of a vector whose cells hold ARGUMENTS. It puts the value of BODY into
the last cell."
  (let ((count (length arguments)))
    `(defun ,name (cells)
       (declare #.*hot* (type (simple-array double-float (,(1+ count))) cells))
       (let ,(loop for argument in arguments for k from 0 collect `(,argument (aref cells ,k)))
         (declare (type double-float ,@arguments))
         (setf (aref cells ,count) (progn ,@body))
         nil))))

(define-constant +number-text+ "a real number, from -1.7e308 to 1.7e308" :test #'string=)

(defmacro check-number (operator place)
  "Signal WRONG-ARGUMENT unless PLACE is a double-float or a real number that can be made one. Which
double-floats are wrong is for the functions that PUT results to say: inline, it would box them."
  `(check-argument ,operator ,place (or (typep ,place 'double-float) (finite-p ,place))
                   +number-text+))

(defmacro polynomial (x &rest coefficients)
  "Return the polynomial of X with COEFFICIENTS, numbers, from the constant one on (Horner)."
  (let ((first (coerce (first coefficients) 'double-float)))
    (if (rest coefficients)
        `(+ ,first (* ,x (polynomial ,x ,@(rest coefficients))))
        first)))

(defmacro with-parts ((high low) ((operator a b)) &body body)
  "Run BODY with HIGH bound to A OPERATOR B, and LOW to its rounding error. A is larger than B."
  (once-only (a b)
    `(let* ((,high (,operator ,a ,b)) (,low (,operator (- ,a ,high) ,b)))
       (declare (type double-float ,high ,low))
       ,@body)))

(defmacro with-difference ((high low) (a b) &body body)
  "Run BODY with HIGH bound to A - B, and LOW to its rounding error (Knuth)."
  (once-only (a b)
    (with-gensyms (back)
      `(let* ((,high (- ,a ,b)) (,back (- ,high ,a))
              (,low (- (- ,a (- ,high ,back)) (+ ,b ,back))))
         (declare (type double-float ,high ,low ,back))
         ,@body))))

(declaim (inline upper-half))
(defun upper-half (number)
  "Return the upper 26 bits of NUMBER, rounded (Veltkamp)."
  (declare (type double-float number))
  (let ((large (* 134217729d0 number)))
    (- large (- large number))))

(declaim (inline product-error))
(defun product-error (a b product)
  "Return A B - PRODUCT, exactly; PRODUCT is A B, rounded (Dekker)."
  (declare (type double-float a b product))
  (let* ((a-head (upper-half a)) (a-tail (- a a-head))
         (b-head (upper-half b)) (b-tail (- b b-head)))
    (+ (* a-tail b-tail)
       (+ (* a-tail b-head)
          (+ (* a-head b-tail)
             (- (* a-head b-head) product))))))

(defconstant +shift+ 6755399441055744d0
  "To add and subtract 1.5 2^52 rounds double-floats up to 2^51 to whole numbers.")

(declaim (inline whole))
(defun whole (number)
  "Return NUMBER, a double-float up to 2^51, rounded to a whole one."
  (declare (type double-float number))
  (- (+ number +shift+) +shift+))

(defmacro define-parts (names fixed &rest bits)
  "Define constants NAMES: double-floats whose sum is FIXED, with so many BITS."
  `(progn ,@(loop for name in names for k from 0
                  collect `(define-constant ,name (nth ,k (double-parts ,fixed ,@bits))))))
