;;;; handed-text.lisp -- a line that is typed elsewhere than at this process's terminal.

(in-package :ars-magna.cli)

(export '(make-handed-text press-key typed-ahead))

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

(defmethod keep-ahead ((stream handed-text))
  (let ((octets (coerce (take-all-octets (edited-ahead stream)) 'string)))
    (revise-octets (typed-octets stream) (lambda (left) (concatenate 'string octets left)))))

(defun ahead-of (stream octets)
  (ahead-in octets (history-entries (edited-history stream))))

(defun with-key (stream octets key)
  "Return OCTETS, which STREAM has not read yet, with those of KEY. Until it reads, they are what is
typed ahead."
  (cond ((being-typed-p stream) (uiop:strcat octets (octets-of-key key)))
        (t (let ((ahead (ahead-of stream octets)))
             (press-ahead ahead key (history-entries (edited-history stream)))
             (octets-of-ahead ahead)))))

(defun press-key (stream key)
  "Let whoever reads STREAM read KEY, as in keys.lisp."
  (revise-octets (typed-octets stream) (lambda (octets) (with-key stream octets key))))

;;; What waits.

(defun typed-ahead (stream)
  "Return how many lines wait to be read of STREAM, and what is being typed after them: its text,
and where in it the cursor is."
  (let ((ahead (ahead-of stream (handed-left (typed-octets stream)))))
    (values (+ (length (edited-lines stream)) (length (ahead-lines ahead)))
            (ahead-text ahead)
            (ahead-point ahead))))

(defmethod take-waiting ((stream handed-text))
  (let ((lines '()))
    (revise-octets (typed-octets stream)
                   (lambda (octets)
                     (let ((ahead (ahead-of stream octets)))
                       (setf lines (shiftf (ahead-lines ahead) '()))
                       (octets-of-ahead ahead))))
    (append (call-next-method) lines)))
