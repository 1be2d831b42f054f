;;;; digest.lisp -- one number for a state, so that "exactly the same" can be checked.

(in-package :ars-magna.basics)

(export '(text-checksum digest make-digest digest-add digest-word digest-mention))

(define-record (digest (:constructor make-digest ()
                         "Return a digest to which nothing has been added."))
  "A sum over data, in order, that differs if any of them differs (FNV-1a, 64 bits)."
  (value #xCBF29CE484222325 word "the digest's sum so far, 64 bits" :writable :export))

(declaim (inline digest-word))
(defun digest-word (digest word)
  "Add WORD, 64 bits, to DIGEST."
  (setf (digest-value digest)
        (mix-word (ldb (byte 64 0) (* (logxor (digest-value digest) word) #x100000001B3)))))

(defgeneric digest-mention (object digest)
  (:documentation "Add to DIGEST what tells OBJECT apart from others, or else what is in it. Return
DIGEST."))

(defun digest-add (digest datum)
  "Add DATUM to DIGEST: numbers to the bit, symbols and strings by name, lists and vectors by
their elements, functions as such, other objects by what tells them apart. Return DIGEST."
  (declare #.*hot* (type digest digest))
  (typecase datum
    (null (digest-word digest (load-time-value (name-word nil))))
    (double-float
     (digest-word digest (double-to-bits datum)))
    (fixnum (digest-word digest (ldb (byte 64 0) datum)))
    (integer (digest-word digest (ldb (byte 64 0) datum)))
    (ratio (if (finite-p datum)
               (digest-add digest (coerce datum 'double-float))
               (digest-add digest (list (numerator datum) (denominator datum)))))
    (real (digest-add digest (coerce datum 'double-float)))
    ((or symbol string) (digest-word digest (name-word datum)))
    (character (digest-word digest (char-code datum)))
    (cons (digest-word digest 3)
     (loop for tail = datum then (cdr tail)
           while (consp tail)
           do (digest-add digest (car tail))
           finally (digest-add digest tail)))
    ((simple-array (unsigned-byte 8) (*)) (digest-word digest (length datum))
     (loop for octet across datum do (digest-word digest octet)))
    (simple-vector (digest-word digest (length datum))
     (loop for element across datum do (digest-add digest element)))
    (vector (digest-word digest (length datum))
     (loop for element across datum do (digest-add digest element)))
    (function (digest-word digest 1))
    (t (digest-mention datum digest)))
  digest)

(defun text-checksum (text &optional (before 0))
  "Return a number of 32 bits for the characters of TEXT, and for BEFORE, a number of that kind."
  (ldb (byte 32 0) (mix-word (logxor before (text-word text)))))
