;;;; tables.lisp -- hash tables beyond what Lisp has: other tests, and tables like others.

(in-package :ars-magna.host)

(export '(define-table-test weak-table-p like-table))

(defmacro define-table-test (test hash)
  "Let MAKE-HASH-TABLE take the function called TEST as its test; HASH is the name of a function
that returns equal integers, not negative, for what TEST holds equal."
  `(sb-ext:define-hash-table-test ,test ,hash))

(defun like-table (table)
  "Return an empty hash table like TABLE."
  (make-hash-table :test (hash-table-test table)
                   :size (max 7 (hash-table-count table))
                   :weakness (sb-ext:hash-table-weakness table)
                   :synchronized (sb-ext:hash-table-synchronized-p table)))

(defun weak-table-p (table)
  "True if the hash TABLE loses entries when nothing else holds them."
  (and (sb-ext:hash-table-weakness table) t))
