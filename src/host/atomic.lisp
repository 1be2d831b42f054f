;;;; atomic.lisp -- changes that no other thread can come between.

(in-package :ars-magna.host)

(export '(atomic-count swap-if memory-barrier))

;;; A PLACE here is the slot of a structure, by its accessor, the CAR or CDR of a cons, or the value
;;; of a symbol.

(deftype atomic-count ()
  "The type of a structure's slot that ATOMIC-INCF and ATOMIC-DECF can change."
  'sb-ext:word)

(defmacro swap-if (place old new)
  "Set PLACE to NEW if it is OLD, the same object. True if it was."
  (with-gensyms (before)
    `(let ((,before ,old))
       (eq ,before (compare-and-swap ,place ,before ,new)))))

(defmacro memory-barrier ()
  "Let other threads see what this one has written so far before it reads or writes any more."
  '(sb-thread:barrier (:memory)))
