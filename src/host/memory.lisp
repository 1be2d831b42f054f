;;;; memory.lisp -- how much room there is for objects and on the stack, and how it is regained.

(in-package :ars-magna.host)

(export '(heap-bytes make-room room-p dynamic-usage collections regain-room stack-full-p))

(defun dynamic-usage ()
  "Return how many bytes objects take, including garbage."
  (internal (:sb-kernel #:dynamic-usage)))

(defun octets-before-garbage ()
  "Return how many bytes of objects can be made before SBCL next collects garbage; a very large
number if this SBCL does not say."
  (let ((trigger (ignore-errors
                  (internal (:sb-sys #:sap-ref-word)
                            (internal (:sb-sys #:foreign-symbol-sap) "auto_gc_trigger" t)
                            0))))
    (if trigger (- trigger (dynamic-usage)) most-positive-fixnum)))

(defun scrub-stack ()
  "Clear what calls that have returned left on the stack, which would keep objects from being
collected."
  (internal (:sb-sys #:scrub-control-stack)))

(defun collections ()
  "Return an object that is another one after each garbage collection."
  (internal-value :sb-kernel #:*gc-epoch*))

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

;;; Near its end a stack has pages that must not be touched. The first is opened when a program
;;; touches it, so that there is room for the handlers; the page before it then closes it again as
;;; soon as the program comes back. One that leaves by a jump may never touch that: its thread, or
;;; the next that gets the same stack, dies of its second overflow.

(defun restore-stack ()
  "Guard the stack of this thread, of which little is in use again, as at first."
  (let ((end (internal (:sb-kernel #:get-lisp-obj-address)
                       (internal-value :sb-vm #:*control-stack-start*))))
    ;; Opened or not, the page may be written to: if it is closed, that is what is waited for.
    (setf (internal (:sb-sys #:sap-ref-8)
                    (internal (:sb-sys #:int-sap)
                              (+ end (* 2 (internal-value :sb-c #:+backend-page-bytes+))))
                    0)
          0))
  (values))

(defun stack-full-p (condition)
  "True if CONDITION, a STORAGE-CONDITION, is that a stack has overflowed."
  (search "STACK" (string (type-of condition))))

(defun regain-room (condition)
  "Make room again for what comes next, after what CONDITION came up in has been left: if it is that
there was no room on the stack, or for objects."
  (when (typep condition 'storage-condition)
    (if (stack-full-p condition)
        (restore-stack)
        (give-memory-back))))
