;;;; memory.lisp -- free memory on heap and stack, and recovery when either is full.

(in-package :ars-magna.host)

(export '(heap-bytes collect-garbage-early heap-room-p dynamic-usage collection-epoch recover-memory
          stack-full-p))

(defun dynamic-usage ()
  "Return the number of bytes on the heap that are in use, including garbage."
  (internal (:sb-kernel #:dynamic-usage)))

(defun octets-until-collection ()
  "Return how many bytes can be allocated before the next collection; a large number if unknown."
  (let ((trigger (ignore-errors
                  (internal (:sb-sys #:sap-ref-word)
                            (internal (:sb-sys #:foreign-symbol-sap) "auto_gc_trigger" t)
                            0))))
    (if trigger (- trigger (dynamic-usage)) most-positive-fixnum)))

(defun scrub-stack ()
  "Clear the unused part of the stack, whose old values would keep objects from being collected."
  (internal (:sb-sys #:scrub-control-stack)))

(defun collection-epoch ()
  "Return an object that is replaced by a new object after each garbage collection."
  (internal-value :sb-kernel #:*gc-epoch*))

(defun heap-bytes ()
  "Return the size of the heap in bytes."
  (sb-ext:dynamic-space-size))

;; The stack is scrubbed, because its old values would keep objects alive.
(defun collect-garbage-early (octets)
  "Collect garbage now if a garbage collection would otherwise occur while OCTETS of new objects are
allocated. A later collection would have to copy the new objects."
  (when (< (octets-until-collection) octets (sb-ext:bytes-consed-between-gcs))
    (scrub-stack)
    (sb-ext:gc)))

(defun heap-room-p (octets)
  "True if OCTETS of new objects fit on the heap. Collects garbage first if OCTETS is large."
  (flet ((enough-p () (< (+ (dynamic-usage) octets) (* 9/10 (heap-bytes)))))
    (or (< octets (/ (heap-bytes) 100))
        (enough-p)
        (progn (scrub-stack) (sb-ext:gc :full t) (enough-p)))))

;;; A stack ends in guard pages that must not be touched. The first is opened when a program touches
;;; it, so that handlers have room. The page before it closes it again when the program returns. A
;;; program that leaves by a non-local exit may never touch that page. Its thread, or the next one
;;; with that stack, then dies of its second overflow.

(defun restore-stack-guard ()
  "Restore the guard pages of this thread's stack. Only a small part of the stack may be in use."
  (let ((end (internal (:sb-kernel #:get-lisp-obj-address)
                       (internal-value :sb-vm #:*control-stack-start*))))
    ;; That page can always be written, and this closes the guard page if it is open.
    (setf (internal (:sb-sys #:sap-ref-8)
                    (internal (:sb-sys #:int-sap)
                              (+ end (* 2 (internal-value :sb-c #:+backend-page-bytes+))))
                    0)
          0))
  (values))

(defun stack-full-p (condition)
  "True if CONDITION, a STORAGE-CONDITION, is a stack overflow."
  (search "STACK" (string (type-of condition))))

(defun recover-memory (condition)
  "After a non-local exit for CONDITION, restore a full stack's guard pages or collect garbage."
  (when (typep condition 'storage-condition)
    (if (stack-full-p condition)
        (restore-stack-guard)
        (sb-ext:gc :full t))))
