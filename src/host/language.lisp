;;;; language.lisp -- compiler policy, global values, events, weak references, floats as bits.

(in-package :ars-magna.host)

(export '(*hot* compiler-note declaim-final form-calling global-value define-global
          weak-table-p make-similar-table make-weak-reference weak-value define-event add-listener
          call-listeners finite-p positive-infinity-p double-to-bits bits-to-double
          finite-double-p cell-index tick-count double random-words random-state-words
          fill-random-words wrap-random-renewal))

(eval-when (:compile-toplevel :load-toplevel :execute)
  (defparameter *hot* '(optimize (speed 3) (safety 1) (debug 0) (sb-ext:inhibit-warnings 3))
    "The optimisation policy for functions that take much time in a profile: (declare #.*hot*)."))

(deftype compiler-note ()
  "The type of the condition by which the compiler reports that code will be slow."
  'sb-ext:compiler-note)

(defmacro declaim-final (&rest types)
  "Promise the compiler that the structure types TYPES get no further subtypes."
  `(declaim (sb-ext:freeze-type ,@types)))

(defun form-calling (function body &rest arguments)
  "Return a form that calls FUNCTION with (lambda () BODY), of dynamic extent, and ARGUMENTS."
  `(flet ((body () ,@body))
     (declare (dynamic-extent #'body))
     (,function #'body ,@arguments)))

;;;; Global values, regardless of bindings in a thread

(declaim (inline global-value (setf global-value)))
(defun global-value (symbol)
  "Return the global value of the variable SYMBOL, regardless of bindings in this thread. Can be
set. Signals UNBOUND-VARIABLE if SYMBOL has no global value."
  (sb-ext:symbol-global-value symbol))

(defun (setf global-value) (value symbol)
  (setf (sb-ext:symbol-global-value symbol) value))

(defmacro define-global (name value documentation)
  "Define the variable NAME with VALUE at load time. Threads cannot bind NAME, so reading is fast."
  `(sb-ext:define-load-time-global ,name ,value ,documentation))

;;;; Hash tables

(defun make-similar-table (table)
  "Return an empty hash table with the test, size and options of TABLE."
  (make-hash-table :test (hash-table-test table)
                   :size (max 7 (hash-table-count table))
                   :weakness (sb-ext:hash-table-weakness table)
                   :synchronized (sb-ext:hash-table-synchronized-p table)))

(defun weak-table-p (table)
  "True if the hash TABLE is weak."
  (and (sb-ext:hash-table-weakness table) t))

;;;; Weak references

(defun make-weak-reference (object)
  "Return a weak reference to OBJECT."
  (sb-ext:make-weak-pointer object))

(defun weak-value (weak)
  "Return the object of the weak reference WEAK; NIL if the object was garbage collected."
  (values (sb-ext:weak-pointer-value weak)))

;;;; Events

;;; An event is a variable with a list of function names, its listeners. The newest is called first.
;;; Because they are names, reloading a file adds none twice, and a redefined function takes effect.

(defmacro define-event (name documentation)
  "Define the variable NAME as an event, a list of listeners. DOCUMENTATION says when to call them."
  `(defvar ,name '() ,documentation))

(defmacro add-listener (event listener)
  "Add the function named LISTENER to EVENT, to be called before the listeners added earlier."
  `(pushnew ',listener ,event))

(defun call-listeners (listeners &rest arguments)
  "Call each function in LISTENERS, the value of an event variable, with ARGUMENTS."
  (dolist (listener listeners)
    (apply listener arguments)))

;;;; Numbers

;;; The library ieee-floats computes the bits from sign, exponent and fraction. That conses, takes
;;; three times as long, which slows digests, and does not handle infinities.

;;; A NaN must not even be compared with a number: that is an arithmetic error.

(declaim (inline finite-double-p finite-p))
(defun finite-double-p (number)
  "True unless NUMBER, a double-float, is infinite or a NaN."
  (declare (type double-float number))
  (/= #x7FF00000 (logand #x7FF00000 (internal (:sb-kernel #:double-float-high-bits) number))))

(defun finite-non-double-p (object)
  (typecase object
    (float (not (or (sb-ext:float-infinity-p object) (sb-ext:float-nan-p object))))
    (real (<= (abs object) most-positive-double-float))))

(defun finite-p (object)
  "True if OBJECT is a real number that is, or can be converted to, a finite float. False for
infinities, NaNs, and integers and ratios that are too large."
  (if (typep object 'double-float)
      (finite-double-p object)
      (finite-non-double-p object)))

(defun positive-infinity-p (object)
  "True if OBJECT is a float that is positive infinity."
  (and (floatp object) (sb-ext:float-infinity-p object) (plusp object)))

(declaim (inline double-to-bits bits-to-double))
(defun double-to-bits (number)
  "Return the 64 bits of NUMBER, a double-float, as a non-negative integer."
  (declare (type double-float number))
  (ldb (byte 64 0) (internal (:sb-kernel #:double-float-bits) number)))

(defun bits-to-double (bits)
  "Return the double-float with BITS, an integer of 64 bits: the inverse of DOUBLE-TO-BITS."
  (declare (type (unsigned-byte 64) bits))
  (let ((high (ldb (byte 32 32) bits)))
    (internal (:sb-kernel #:make-double-float)
              (- (logxor high (ash 1 31)) (ash 1 31))
              (ldb (byte 32 0) bits))))

;;; The number types that all layers share.

(deftype cell-index ()
  "The index of a grid cell: maps have at most 2^30 cells."
  '(unsigned-byte 30))

(deftype tick-count ()
  "A time or a duration in simulated ticks."
  '(unsigned-byte 61))

(declaim (ftype (function (t) double-float) coerce-to-double))
(defun coerce-to-double (number)
  (coerce (the real number) 'double-float))

(declaim (inline double))
(defun double (number)
  "Return NUMBER as a double-float. The usual types of numbers are converted without consing."
  (typecase number
    (double-float number)
    (fixnum (coerce number 'double-float))
    (single-float (coerce number 'double-float))
    (ratio (coerce number 'double-float))
    ;; Not inline, or the compiler would complain where it cannot rule out complex numbers.
    (t (coerce-to-double number))))

;;; In all tested versions of SBCL a random state is 627 words of the Mersenne Twister MT19937: two
;;; constants, the position of the next word, and 624 words.

(deftype random-words ()
  "The type of the words of a random state."
  '(simple-array (unsigned-byte 32) (627)))

(declaim (inline random-state-words fill-random-words))
(defun random-state-words (state)
  "Return the words of the random state STATE itself, not a copy."
  (the random-words (internal (:sb-kernel #:random-state-state) state)))

(defun fill-random-words (seed words)
  "Fill WORDS, the words of a random state, from SEED, an integer of 32 bits."
  (internal (:sb-kernel #:init-random-state) seed words))

(defun wrap-random-renewal (wrapper)
  "When SBCL renews a random state's words, call WRAPPER with SBCL's function and the words."
  (wrap-function (internal-name :sb-kernel '#:random-mt19937-update) wrapper))
