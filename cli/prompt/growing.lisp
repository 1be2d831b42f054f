;;;; growing.lisp -- a text as a stream that goes on, line by line, as it is read.

(in-package :ars-magna.cli)

(defclass growing-text (fundamental-character-input-stream)
  ((text :initarg :text :accessor grown-text)
   (position :initarg :position :accessor grown-position)
   (more :initarg :more :reader text-grower))
  (:documentation "The characters of TEXT from POSITION on. After its end comes a newline, and then
what the function MORE returns of it: the same text, that newline and another line."))

(defmethod stream-read-char ((stream growing-text))
  (when (< (length (grown-text stream)) (grown-position stream))
    (setf (grown-text stream) (funcall (text-grower stream) (grown-text stream))))
  (let ((text (grown-text stream)) (position (grown-position stream)))
    (incf (grown-position stream))
    (if (< position (length text)) (char text position) #\Newline)))

(defmethod stream-unread-char ((stream growing-text) char)
  (declare (ignore char))
  (decf (grown-position stream))
  nil)

(defun grown-out-p (stream)
  "True if all of the text of STREAM has been read, as far as it has grown."
  (<= (length (grown-text stream)) (grown-position stream)))
