;;;; backtraces.lisp -- the calls under way.

(in-package :ars-magna.base)

(defun calls-under-way (&optional (limit 100))
  "Return a list of the calls under way, the newest first and at most LIMIT of them, each as
(function argument...) as far as the compiler has kept that."
  (sb-debug:list-backtrace :count limit))
