;;;; prompt.lisp -- the lines that the user types in the window go to a prompt of the window's own.

(in-package :ars-magna.clim)

;;; The prompt runs in a thread, reads from a stream that the window feeds and writes to the
;;; transcript. So a line that takes long does not keep the window from painting. It begins with
;;; the first line typed: until then messages stay with whoever else shows them.

(defclass line-stream (fundamental-character-input-stream)
  ((lock :initform (make-lock "lines") :reader stream-lock)
   (ready :initform (make-semaphore "line") :reader stream-ready)
   ;; Lines not read yet, oldest first, and what is left of the one that is being read.
   (lines :initform '() :accessor stream-lines)
   (rest :initform "" :accessor stream-rest)
   (over-p :initform nil :accessor stream-over-p))
  (:documentation "An input stream of the lines given to FEED; reading waits for them."))

(defun feed (stream line)
  "Let whoever reads STREAM read LINE, a string; NIL ends the stream."
  (with-lock ((stream-lock stream))
    (if line
        (setf (stream-lines stream) (append (stream-lines stream) (list line)))
        (setf (stream-over-p stream) t)))
  (signal-semaphore (stream-ready stream)))

(defun await-line (stream)
  "Return the next line given to STREAM, or NIL if it is over."
  (loop
    (with-lock ((stream-lock stream))
      (cond ((stream-lines stream) (return (pop (stream-lines stream))))
            ((stream-over-p stream) (return nil))))
    (wait-on-semaphore (stream-ready stream))))

(defmethod stream-read-line ((stream line-stream))
  (let ((rest (shiftf (stream-rest stream) "")))
    (if (string= rest "")
        (let ((line (await-line stream)))
          (values (or line "") (null line)))
        (values (string-right-trim '(#\Newline) rest) nil))))

(defmethod stream-read-char ((stream line-stream))
  (when (string= (stream-rest stream) "")
    (let ((line (await-line stream)))
      (when line (setf (stream-rest stream) (format nil "~A~%" line)))))
  (let ((rest (stream-rest stream)))
    (cond ((string= rest "") :eof)
          (t (setf (stream-rest stream) (subseq rest 1))
             (char rest 0)))))

(defmethod stream-unread-char ((stream line-stream) char)
  (setf (stream-rest stream) (concatenate 'string (string char) (stream-rest stream)))
  nil)

;;; A prompt at work.

(defstruct (conversation (:constructor make-conversation (input output over)) (:copier nil))
  "The prompt of a window. OVER is called, with no arguments, when its user has left it."
  (input nil :type line-stream :read-only t)
  (output nil :type stream :read-only t)
  (over nil :type function :read-only t)
  (thread nil))

(defun begin-conversation (transcript over)
  "Return a prompt that writes to TRANSCRIPT; OVER is called when its user leaves it."
  (make-conversation (make-instance 'line-stream)
                     (make-instance 'transcript-stream :transcript transcript)
                     over))

(defun converse (conversation)
  (let ((output (conversation-output conversation)))
    (let ((*standard-output* output))
      (ars-magna.cli:run-session
       (ars-magna.cli:make-session :input (conversation-input conversation) :output output
                                   :echo t)))
    (funcall (conversation-over conversation))))

(defun give-line (conversation line)
  "Let the prompt do what LINE, a string, says."
  (unless (conversation-thread conversation)
    (setf (conversation-thread conversation)
          (start-thread (lambda () (converse conversation)) "prompt of a window")))
  (feed (conversation-input conversation) line))

(defun end-conversation (conversation)
  "Let the prompt end after the line that it is at work on. Return nothing."
  (feed (conversation-input conversation) nil)
  (values))
