;;;; stacks.lisp -- making room after a stack, or the memory, has overflowed.

(in-package :ars-magna.base)

(export '(regain-room))

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
