;;;; stacks.lisp -- a thread's stack or the memory, after it has overflowed.

(in-package :ars-magna.host)

(export '(restore-stack regain-room stack-full-p))

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
