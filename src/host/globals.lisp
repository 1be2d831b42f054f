;;;; globals.lisp -- values at top level, beneath whatever a thread has bound.

(in-package :ars-magna.host)

(export '(global-value define-global))

(declaim (inline global-value (setf global-value)))
(defun global-value (symbol)
  "Return the value that the variable SYMBOL has at top level, whatever this thread has bound it to.
Can be set. Signals UNBOUND-VARIABLE if it has none."
  (sb-ext:symbol-global-value symbol))

(defun (setf global-value) (value symbol)
  (setf (sb-ext:symbol-global-value symbol) value))

(defmacro define-global (name value documentation)
  "Define the variable NAME with VALUE, once it is loaded; it is never bound, and quick to read."
  `(sb-ext:define-load-time-global ,name ,value ,documentation))
