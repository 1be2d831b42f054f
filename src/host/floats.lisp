;;;; floats.lisp -- floats from and to their bits.

(in-package :ars-magna.host)

(export '(double-high-bits double-bits make-double make-single))

;;; Tried with SBCL 2.2.9, 2.5.2 and 2.6.4.

(declaim (inline double-high-bits double-bits make-double make-single))
(defun double-high-bits (number)
  "Return the upper 32 bits of the double-float NUMBER, as a signed integer."
  (declare (type double-float number))
  (internal (:sb-kernel #:double-float-high-bits) number))

(defun double-bits (number)
  "Return an integer whose lower 64 bits are those of the double-float NUMBER."
  (declare (type double-float number))
  (internal (:sb-kernel #:double-float-bits) number))

(defun make-double (high low)
  "Return the double-float whose bits are HIGH, a signed, and LOW, an unsigned integer of 32 bits."
  (declare (type (signed-byte 32) high) (type (unsigned-byte 32) low))
  (internal (:sb-kernel #:make-double-float) high low))

(defun make-single (bits)
  "Return the single-float whose bits are BITS, a signed integer of 32 bits."
  (declare (type (signed-byte 32) bits))
  (internal (:sb-kernel #:make-single-float) bits))
