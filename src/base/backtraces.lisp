;;;; backtraces.lisp -- the calls under way, and what is called instead of the debugger.

(in-package :ars-magna.base)

(defun calls-under-way (&optional (limit 100))
  "Return a list of the calls under way, the newest first and at most LIMIT of them, each as
(function argument...) as far as the compiler has kept that."
  (sb-debug:list-backtrace :count limit))

(defun debugger-hook ()
  "Return the function that is called instead of Lisp's debugger, with a condition and itself, in
whatever thread that has not bound one; or NIL. Can be set."
  sb-ext:*invoke-debugger-hook*)

(defun (setf debugger-hook) (function)
  (setf sb-ext:*invoke-debugger-hook* function))
