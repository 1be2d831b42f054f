;;;; inflating.lisp -- what zlib has compressed, decompressed bit by bit: the one door to chipz.

(in-package :ars-magna.floors)

;;; Of data that are damaged chipz says so with errors of its own, or runs into others, such as an
;;; index that is too large. All of them mean the same.

(defstruct (inflater (:constructor make-inflater (octets)) (:copier nil))
  "Decompresses OCTETS, which are in zlib's format; those before POSITION are done."
  (octets (make-array 0 :element-type '(unsigned-byte 8)) :type octets :read-only t)
  (position 0 :type fixnum)
  (state (chipz:make-dstate 'chipz:zlib) :read-only t))

(defun inflate-into (buffer end inflater)
  "Put what comes next of INFLATER into BUFFER, up to END. Return how many octets these are, fewer
if there are no more; NIL if the data are damaged."
  (handler-case
      (multiple-value-bind (used made)
          (chipz:decompress buffer (inflater-state inflater) (inflater-octets inflater)
                            :input-start (inflater-position inflater) :output-end end)
        (incf (inflater-position inflater) used)
        made)
    (error () nil)))

(defun inflated-p (inflater)
  "True if INFLATER is at the end of its data, and their check sum was right."
  (handler-case (chipz:finish-dstate (inflater-state inflater))
    (error () nil)))
