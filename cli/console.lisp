;;;; console.lisp -- an output stream that knows where the cursor is and whether a prompt stands.

(in-package :ars-magna.cli)

;;; What the simulator and the user's programs print comes from other threads, at any time. The
;;; console keeps what each of them writes in one piece, and knows when a prompt has been written
;;; over and must be shown again. A terminal moves the cursor when the user presses return; nobody
;;; but ANSWERED can know.

(defclass console (sb-gray:fundamental-character-output-stream)
  ((stream :initarg :stream :reader console-stream)
   (lock :initform (make-lock "console") :reader console-lock)
   (column :initform 0 :accessor console-column)
   (prompt :initform nil :accessor console-prompt)
   (overwritten-p :initform nil :accessor console-overwritten-p))
  (:documentation "An output stream on top of another. PROMPT is what stands there for the user to
answer, or NIL; OVERWRITTEN-P is true if something was written after it."))

(defun make-console (stream)
  (if (typep stream 'console) stream (make-instance 'console :stream stream)))

(defmethod sb-gray:stream-line-column ((console console))
  (console-column console))

(defmethod sb-gray:stream-write-string ((console console) string &optional (start 0) end)
  (let* ((end (or end (length string)))
         (newline (position #\Newline string :start start :end end :from-end t)))
    (with-lock ((console-lock console))
      (write-string string (console-stream console) :start start :end end)
      (setf (console-overwritten-p console) t
            (console-column console) (if newline
                                         (- end newline 1)
                                         (+ (console-column console) (- end start))))))
  string)

(defmethod sb-gray:stream-write-char ((console console) char)
  (sb-gray:stream-write-string console (string char))
  char)

(defmethod sb-gray:stream-force-output ((console console))
  (with-lock ((console-lock console)) (force-output (console-stream console))))

(defmethod sb-gray:stream-finish-output ((console console))
  (with-lock ((console-lock console)) (finish-output (console-stream console))))

;;; Prompts.

(defun show-prompt (console prompt)
  "Write PROMPT, a string, at the start of a line."
  (fresh-line console)
  (write-string prompt console)
  (finish-output console)
  (setf (console-overwritten-p console) nil
        (console-prompt console) prompt))

(defun unanswered-p (console)
  "True if a prompt stands and nothing has been written after it."
  (and (console-prompt console) (not (console-overwritten-p console))))

(defun spoilt-p (console)
  "True if a prompt stands and something has been written after it."
  (and (console-prompt console) (console-overwritten-p console)))

(defun restore-prompt (console)
  "Show the prompt that stands again if something was written after it."
  (when (spoilt-p console)
    (show-prompt console (console-prompt console))))

(defun answered (console)
  "Note that the user has ended the line of the prompt."
  (setf (console-prompt console) nil
        (console-column console) 0))
