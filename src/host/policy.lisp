;;;; policy.lisp -- how code is compiled, its room, and the number types that all layers share.

(in-package :ars-magna.host)

(export '(*hot* compiler-note declaim-final double heap-bytes make-room room-p cell-index surely
          tick-count form-calling))

(eval-when (:compile-toplevel :load-toplevel :execute)
  (defparameter *hot* '(optimize (speed 3) (safety 1) (debug 0) (sb-ext:inhibit-warnings 3))
    "How a function that a profile pointed at is compiled: (declare #.*hot*)."))

(deftype compiler-note ()
  "The condition by which the compiler says that it cannot make code fast."
  'sb-ext:compiler-note)

(defmacro declaim-final (&rest types)
  "Promise the compiler that no type will include one of the structures TYPES from here on."
  `(declaim (sb-ext:freeze-type ,@types)))

(defun heap-bytes ()
  "Return for how many bytes of objects this Lisp has room, in use or not."
  (sb-ext:dynamic-space-size))

(defun give-memory-back ()
  "Make room for objects where there are others that nobody can reach any more."
  (sb-ext:gc :full t))

;; The stack is scrubbed, as what is left there of calls that have returned would keep objects.
(defun make-room (octets)
  "Let Lisp look now for objects that nobody can reach if else it would while OCTETS of new ones are
made: by then these would be in its way, since it moves what can be reached."
  (when (< (octets-before-garbage) octets (sb-ext:bytes-consed-between-gcs))
    (scrub-stack)
    (sb-ext:gc)))

(defun room-p (octets)
  "True if this Lisp has room for OCTETS of new objects; garbage is collected if they are many."
  (flet ((enough-p () (< (+ (dynamic-usage) octets) (* 9/10 (heap-bytes)))))
    (or (< octets (/ (heap-bytes) 100))
        (enough-p)
        (progn (scrub-stack) (give-memory-back) (enough-p)))))

(defun form-calling (function body &rest arguments)
  "Return a form that calls FUNCTION with a function that runs BODY, forms, and then ARGUMENTS. The
function is on the stack, and ends with the call."
  `(flet ((body () ,@body))
     (declare (dynamic-extent #'body))
     (,function #'body ,@arguments)))

(deftype cell-index ()
  "The index of a grid cell: maps have at most 2^30 cells."
  '(unsigned-byte 30))

;; For what has been checked already, but in a way that the compiler does not see through.
(defmacro surely (type form)
  "Return the value of FORM, of which the compiler may believe that it is of TYPE."
  `(sb-ext:truly-the ,type ,form))

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
