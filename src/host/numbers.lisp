;;;; numbers.lisp -- floats as bits, the number types of all layers, the words of random states.

(in-package :ars-magna.host)

(export '(finite-p positive-infinity-p double-to-bits bits-to-double
          finite-double-p cell-index tick-count double random-words words-of-state fill-words
          wrap-renewal))

;;; The library ieee-floats computes the bits from sign, exponent and fraction. That conses, takes
;;; three times as long, which slows digests, and does not handle infinities.

;;; A NaN must not even be compared with a number: that is an arithmetic error.

(declaim (inline finite-double-p finite-p))
(defun finite-double-p (number)
  "True unless NUMBER, a double-float, is infinite or a NaN."
  (declare (type double-float number))
  (/= #x7FF00000 (logand #x7FF00000 (internal (:sb-kernel #:double-float-high-bits) number))))

(defun other-finite-p (object)
  (typecase object
    (float (not (or (sb-ext:float-infinity-p object) (sb-ext:float-nan-p object))))
    (real (<= (abs object) most-positive-double-float))))

(defun finite-p (object)
  "True if OBJECT is a real number that is, or can be converted to, a finite float. False for
infinities, NaNs, and integers and ratios that are too large."
  (if (typep object 'double-float)
      (finite-double-p object)
      (other-finite-p object)))

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

(declaim (ftype (function (t) double-float) other-double))
(defun other-double (number)
  (coerce (the real number) 'double-float))

(declaim (inline double))
(defun double (number)
  "Return NUMBER as a double-float. Does not cons for the usual kinds of numbers."
  (typecase number
    (double-float number)
    (fixnum (coerce number 'double-float))
    (single-float (coerce number 'double-float))
    (ratio (coerce number 'double-float))
    ;; Not inline, or the compiler would complain where it cannot rule out complex numbers.
    (t (other-double number))))

;;; In all tested versions of SBCL a random state is 627 words of the Mersenne Twister MT19937: two
;;; constants, the position of the next word, and 624 words.

(deftype random-words ()
  "The words of a random state."
  '(simple-array (unsigned-byte 32) (627)))

(declaim (inline words-of-state fill-words))
(defun words-of-state (state)
  "Return the words of the random state STATE, not a copy."
  (the random-words (internal (:sb-kernel #:random-state-state) state)))

(defun fill-words (seed words)
  "Seed WORDS, of a random state, with SEED, an integer of 32 bits."
  (internal (:sb-kernel #:init-random-state) seed words))

(defun wrap-renewal (wrapper)
  "Call WRAPPER, with SBCL's function and the words, when SBCL renews used-up words."
  (wrap-function (internal-name :sb-kernel '#:random-mt19937-update) wrapper))
