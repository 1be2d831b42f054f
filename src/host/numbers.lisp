;;;; numbers.lisp -- floats as bits, the number types of all layers, the words of random states.

(in-package :ars-magna.host)

(export '(make-double make-single finite-p positive-infinity-p double-to-bits bits-to-double
          finite-double-p cell-index tick-count double random-words words-of-state fill-words
          wrap-renewal))

(declaim (inline make-double make-single))
(defun make-double (high low)
  "Return the double-float whose bits are HIGH, a signed, and LOW, an unsigned integer of 32 bits."
  (declare (type (signed-byte 32) high) (type (unsigned-byte 32) low))
  (internal (:sb-kernel #:make-double-float) high low))

(defun make-single (bits)
  "Return the single-float whose bits are BITS, a signed integer of 32 bits."
  (declare (type (signed-byte 32) bits))
  (internal (:sb-kernel #:make-single-float) bits))

;;; The library ieee-floats reckons the bits from sign, exponent and fraction. That conses and
;;; takes three times as long, which digests would feel, and it does not know the infinities.

;;; What is no number must not even be compared with one: that is an arithmetic error.

(declaim (inline finite-double-p finite-p))
(defun finite-double-p (number)
  "True unless NUMBER, a double-float, is infinite or no number."
  (declare (type double-float number))
  (/= #x7FF00000 (logand #x7FF00000 (internal (:sb-kernel #:double-float-high-bits) number))))

(defun other-finite-p (object)
  (typecase object
    (float (not (or (sb-ext:float-infinity-p object) (sb-ext:float-nan-p object))))
    (real (<= (abs object) most-positive-double-float))))

(defun finite-p (object)
  "True of real numbers that are, or could be made, finite floats: not of the infinities, what is no
number, and integers and ratios that are too large."
  (if (typep object 'double-float)
      (finite-double-p object)
      (other-finite-p object)))

(defun positive-infinity-p (object)
  "True of the floats that are positive infinity."
  (and (floatp object) (sb-ext:float-infinity-p object) (plusp object)))

(declaim (inline double-to-bits bits-to-double))
(defun double-to-bits (number)
  "Return the 64 bits of NUMBER, a double-float, as an integer that is not negative."
  (declare (type double-float number))
  (ldb (byte 64 0) (internal (:sb-kernel #:double-float-bits) number)))

(defun bits-to-double (bits)
  "Return the double-float with BITS, an integer of 64 bits: DOUBLE-TO-BITS undone."
  (declare (type (unsigned-byte 64) bits))
  (let ((high (ldb (byte 32 32) bits)))
    (make-double (- (logxor high (ash 1 31)) (ash 1 31))
                 (ldb (byte 32 0) bits))))

;;; The number types that all layers share.

(deftype cell-index ()
  "The index of a grid cell: maps have at most 2^30 cells."
  '(unsigned-byte 30))

(deftype tick-count ()
  "A moment or a span of simulated time, in ticks."
  '(unsigned-byte 61))

(declaim (ftype (function (t) double-float) other-double))
(defun other-double (number)
  (coerce (the real number) 'double-float))

(declaim (inline double))
(defun double (number)
  "Return NUMBER as a double-float. Conses nothing for the usual kinds of numbers."
  (typecase number
    (double-float number)
    (fixnum (coerce number 'double-float))
    (single-float (coerce number 'double-float))
    (ratio (coerce number 'double-float))
    ;; Not inline, so that the compiler does not complain where it cannot rule out complex numbers.
    (t (other-double number))))

;;; In all versions of SBCL that were tried a random state is 627 words of the Mersenne Twister
;;; MT19937: two constants, the place of the next word, and 624 words.

(deftype random-words ()
  "What is in a random state."
  '(simple-array (unsigned-byte 32) (627)))

(declaim (inline words-of-state fill-words))
(defun words-of-state (state)
  "Return the words of the random state STATE, not a copy."
  (the random-words (internal (:sb-kernel #:random-state-state) state)))

(defun fill-words (seed words)
  "Seed WORDS, of a random state, by SEED, an integer of 32 bits."
  (internal (:sb-kernel #:init-random-state) seed words))

(defun wrap-renewal (wrapper)
  "Call WRAPPER, with SBCL's function and the words, where SBCL makes new words of words that have
all been read."
  (wrap-function (internal-name :sb-kernel '#:random-mt19937-update) wrapper))
