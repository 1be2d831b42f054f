;;;; growing.lisp -- a text as a stream that goes on, line by line, as it is read.

(in-package :ars-magna.cli)

;;; One text grows in place. Copied for each line, long forms would take quadratic time.

(defclass growing-text (fundamental-character-input-stream)
  ((text :initarg :text :reader grown-text)
   (position :initarg :position :accessor grown-position)
   (more :initarg :more :reader text-grower))
  (:documentation "The characters of TEXT, which has a fill pointer, from POSITION on. After its end
comes a newline, and then the line that the function MORE returns of the text so far; or its own
end, if that is NIL."))

(defun extensible-text (text)
  "Return TEXT if lines can be put behind it, or else a copy for which they can."
  (if (array-has-fill-pointer-p text)
      text
      (make-array (length text) :element-type 'character :adjustable t :fill-pointer t
                                :initial-contents text)))

(defun extend-text (text line)
  (vector-push-extend #\Newline text)
  (loop for char across line do (vector-push-extend char text)))

(defun text-stream (text start more)
  "Return a growing text of TEXT from START on; see MORE there."
  (make-instance 'growing-text :text (extensible-text text) :position start :more more))

(defun next-line-p (stream)
  "Let the text of STREAM, of which all has been read, have another line. True if there is one."
  (let ((line (funcall (text-grower stream) (grown-text stream))))
    (when line (extend-text (grown-text stream) line))
    (and line t)))

(defmethod stream-read-char ((stream growing-text))
  (if (or (<= (grown-position stream) (length (grown-text stream)))
          (next-line-p stream))
      (let ((text (grown-text stream)) (position (grown-position stream)))
        (incf (grown-position stream))
        (if (< position (length text)) (char text position) #\Newline))
      :eof))

(defmethod stream-unread-char ((stream growing-text) char)
  (declare (ignore char))
  (decf (grown-position stream))
  nil)

(defun grown-out-p (stream)
  (<= (length (grown-text stream)) (grown-position stream)))
