;;;; debugger.lisp -- the calls under way, and the terminal that threads share with the debugger.

(in-package :ars-magna.host)

(export '(calls-under-way disabled-hook-p take-foreground yield-foreground))

(defun calls-under-way (&optional (limit 100))
  "Return a list of the calls under way, the newest first and at most LIMIT of them, each as
\(function argument...) as far as the compiler has kept that."
  (internal (:sb-debug #:list-backtrace) :count limit))

(defun disabled-hook-p (hook)
  "True if HOOK is the one by which SBCL has no debugger, as in scripts."
  (and (symbolp hook) (string= hook "DEBUGGER-DISABLED-HOOK")))

(defun take-foreground ()
  "Wait until this thread has the terminal, as one that enters the debugger does."
  (internal (:sb-thread #:get-foreground)))

(defun yield-foreground ()
  "If another thread wants to enter Lisp's own debugger, for which this one, which waits, would have
to leave it the terminal, do so, until it has left the debugger."
  (let ((threads (internal (:sb-thread #:interactive-threads))))
    (when (and (eq (first threads) sb-thread:*current-thread*) (rest threads))
      (sb-thread:release-foreground)
      (take-foreground))))
