;;;; handed-text.lisp -- a line that is typed elsewhere than at this process's terminal.

(in-package :ars-magna.cli)

;;; A window hands over keys, and shows the line on a console of its own. All else is as at a
;;; terminal: what keys do, the history, Tab. What the terminal does meanwhile is not touched.

(defclass handed-text (edited-text) ()
  (:default-initargs :by-hand-p t)
  (:documentation "The text that somebody types in a window."))

(defun make-handed-text (console)
  "Return what is typed elsewhere, with its line shown on CONSOLE. It has the history that the
prompt at the terminal has."
  (make-instance 'handed-text :console console :history (make-history (file-for-history))
                              :octets (make-instance 'handed-octets)))

(defmethod take-keys ((stream handed-text) &key interrupts)
  (declare (ignore interrupts)))

(defmethod stop-here ((stream handed-text)))

(defmethod call-typing (function (stream handed-text))
  (unwind-protect (funcall function)
    (save-entry (edited-history stream))
    (answered (edited-console stream))))

(defun being-typed-p (stream)
  "True if a line is being typed into STREAM: nothing is under way that would have to end first."
  (and (line-of stream) t))

(defun press-key (stream key)
  "Let whoever reads STREAM read KEY, as in keys.lisp."
  (hand-over (typed-octets stream) (octets-of-key key)))

(defun end-keys (stream)
  "Let STREAM end after the keys that were pressed."
  (hand-over (typed-octets stream) nil))
