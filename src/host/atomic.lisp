;;;; atomic.lisp -- changes that no other thread can come between.

(in-package :ars-magna.host)

(export '(atomic-count compare-and-swap swap-if atomic-push atomic-incf atomic-decf memory-barrier))

;;; A PLACE here is the slot of a structure, by its accessor, the CAR or CDR of a cons, or the value
;;; of a symbol.

(deftype atomic-count ()
  "The type of a structure's slot that ATOMIC-INCF and ATOMIC-DECF can change."
  'sb-ext:word)

(defmacro compare-and-swap (place old new)
  "Set PLACE to NEW if it is OLD, the same object. Return what it was before."
  `(sb-ext:compare-and-swap ,place ,old ,new))

(defmacro swap-if (place old new)
  "Set PLACE to NEW if it is OLD, the same object. True if it was."
  (with-gensyms (before)
    `(let ((,before ,old))
       (eq ,before (compare-and-swap ,place ,before ,new)))))

(defmacro atomic-push (object place)
  "Add OBJECT in front of the list in PLACE. Return the new list."
  `(sb-ext:atomic-push ,object ,place))

(defmacro atomic-incf (place &optional (count 1))
  "Add COUNT to PLACE, a slot of type ATOMIC-COUNT. Return what it was before."
  `(sb-ext:atomic-incf ,place ,count))

(defmacro atomic-decf (place &optional (count 1))
  "Take COUNT from PLACE, a slot of type ATOMIC-COUNT. Return what it was before."
  `(sb-ext:atomic-decf ,place ,count))

(defmacro memory-barrier ()
  "Let other threads see what this one has written so far before it reads or writes any more."
  '(sb-thread:barrier (:memory)))
