;;;; tables.lisp -- hash tables by other tests than Lisp's own.

(in-package :ars-magna.base)

(defmacro define-table-test (test hash)
  "Let MAKE-HASH-TABLE take the function called TEST as its test; HASH is the name of a function
that returns equal integers, not negative, for what TEST holds equal."
  `(sb-ext:define-hash-table-test ,test ,hash))
