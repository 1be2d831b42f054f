;;;; interrupts.lisp -- where a thread may be interrupted from outside, and by what.

(in-package :ars-magna.base)

;;; What interrupts a thread is a time limit, Ctrl-C, another thread, or that it is to end. It may
;;; leave what it interrupts. So it waits while a run's own code works, which could be left halfway,
;;; and is let in where users' code runs and between ticks.

(deftype time-limit ()
  "The condition that is signalled when the time for a form is up, as by WITH-TIMEOUT."
  'sb-ext:timeout)

(defmacro deferring-interrupts (&body body)
  "Run BODY. What interrupts this thread waits, but for the extent of ALLOWING-INTERRUPTS."
  `(sb-sys:without-interrupts (sb-sys:allow-with-interrupts ,@body)))

(defmacro allowing-interrupts (&body body)
  "Run BODY, in which this thread can be interrupted."
  `(sb-sys:with-interrupts ,@body))

(declaim (inline let-interrupts-in))
(defun let-interrupts-in ()
  "Let what has been waiting interrupt this thread now."
  (when sb-sys:*interrupt-pending* (allowing-interrupts nil)))
