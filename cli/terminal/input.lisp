;;;; input.lisp -- lines as they are typed: any bytes, any length, from streams that may end.

(in-package :ars-magna.cli)

;;; Bytes that are not UTF-8 are read as question marks. A line that is too long is an error after
;;; all of it has been read, so that the next line is read correctly. A stream that can no longer be
;;; read, such as a terminal that is gone, counts as ended.

(defconstant +longest-line-typed+ 1000000 "The largest number of bytes in a line.")

;; What follows so many bytes of one line may be misread.
(defconstant +longest-line-searched+ 50000000
  "How many bytes of a line are searched for parentheses, quotes and comments.")

(define-condition line-too-long (bad-line)
  ((beginning :initarg :beginning :reader line-beginning)
   (outline :initarg :outline :reader line-outline))
  (:documentation "A typed line is too long. BEGINNING is its first part. OUTLINE is a shorter text
with the same parentheses, quotes, comment marks and beginnings of words."))

(defvar *before-program-reads* nil
  "A function to call before a user's program reads a typed line. NIL while the prompt reads.")

(defclass typed-text (fundamental-character-input-stream)
  ((octets :initarg :octets :reader typed-octets)
   (by-hand-p :initarg :by-hand-p :initform nil :reader typed-by-hand-p)
   ;; The rest of the line that is being read, and where that begins.
   (rest :initform "" :accessor typed-line)
   (position :initform 0 :accessor typed-position)
   (count :initform 0 :accessor typed-count)
   (followed-p :initform nil :accessor typed-followed-p))
  (:documentation "A stream of the UTF-8 text in OCTETS, a stream of octets. BY-HAND-P is true if a
user types the text. COUNT is the number of lines read. FOLLOWED-P is true if more input was
available when the last line was read."))

(defun input-available-p (stream)
  "True if STREAM, a stream of octets, has more input that can be read without waiting."
  (handler-case (listen stream)
    (stream-error () nil)))

(defgeneric count-of-lines-read (stream)
  (:documentation "Return the number of lines that the prompt and programs have read from STREAM.")
  (:method (stream)
    (declare (ignore stream))
    0)
  (:method ((stream typed-text)) (typed-count stream)))

(defmethod typed-input-p ((stream typed-text))
  t)

(defmethod typed-by-hand-p ((stream stream))
  (interactive-stream-p stream))

(defun outline-char-p (char last)
  "True if CHAR, after LAST, belongs to a line's outline: Lisp punctuation, or the start of a word."
  (flet ((mark-p (char) (find char "()\"\\|;#")))
    (or (mark-p char) (mark-p last) (char= char #\Newline)
        (and (blank-character-p last) (not (blank-character-p char))))))

(defun read-octet-line (octets)
  "Read a line from the stream OCTETS. Return the line with its newline, and true if it was too
long. The end of a line that is too long is only an outline."
  (let* ((count 0)
         (line (with-output-to-string (out)
                 (handler-case
                     (loop for last = #\Newline then char
                           for char = (read-char octets nil)
                           while char
                           do (when (or (<= count +longest-line-typed+)
                                        (and (<= count +longest-line-searched+)
                                             (outline-char-p char last)))
                                (write-char char out))
                              (incf count)
                           until (char= char #\Newline))
                   (stream-error () nil)))))
    (values line (< (1+ +longest-line-typed+) count))))

(defun reject-long-line (octets)
  "Signal LINE-TOO-LONG for a line with the outline OCTETS."
  (let ((outline (string-right-trim '(#\Newline) (utf-8-decoded octets))))
    (error 'line-too-long
           :beginning (cut outline 60) :outline outline
           :text (format nil "The line is longer than ~D bytes. Put its text into a file, and ~
                              (load \"FILE\")."
                         +longest-line-typed+))))

(defgeneric next-typed-line (stream)
  (:documentation "Return the next line typed into STREAM, with its newline if it has one; \"\" at
the end of the input. Signals BAD-LINE if the line is too long.")
  (:method ((stream typed-text))
    (multiple-value-bind (octets too-long-p) (read-octet-line (typed-octets stream))
      (when too-long-p (reject-long-line octets))
      ;; Some editors begin files with a byte order mark.
      (string-left-trim '(#.(code-char #xFEFF)) (utf-8-decoded octets)))))

(defun ensure-unread-line (stream)
  "Read the next line of STREAM if the current line has been used up."
  (when (= (typed-position stream) (length (typed-line stream)))
    (when *before-program-reads* (funcall *before-program-reads*))
    (setf (typed-position stream) 0
          (typed-line stream) "")
    (incf (typed-count stream))
    (setf (typed-line stream) (next-typed-line stream)
          (typed-followed-p stream) (input-available-p (typed-octets stream)))))

(defun unread-line-p (stream)
  (< (typed-position stream) (length (typed-line stream))))

(defmethod stream-read-line ((stream typed-text))
  (ensure-unread-line stream)
  (let* ((line (typed-line stream))
         (start (shiftf (typed-position stream) (length line)))
         (end (position #\Newline line :start start)))
    (values (subseq line start end) (null end))))

(defmethod stream-read-char ((stream typed-text))
  (ensure-unread-line stream)
  (let ((position (typed-position stream)))
    (cond ((= position (length (typed-line stream))) :eof)
          (t (incf (typed-position stream))
             (char (typed-line stream) position)))))

(defmethod stream-unread-char ((stream typed-text) char)
  (declare (ignore char))
  (decf (typed-position stream))
  nil)

;; A stream for questions that is built on this one calls this.
(defmethod stream-line-column ((stream typed-text))
  nil)

(defgeneric typed-ahead-p (stream)
  (:documentation "True if STREAM has typed input that can be read without waiting.")
  (:method ((stream typed-text)) (unread-line-p stream)))

(defmethod stream-listen ((stream typed-text))
  (or (typed-ahead-p stream) (listen (typed-octets stream))))

;; Only what a user has typed is cleared; what a script or program sends is kept. But the rest of a
;; line that a program has begun to read, as Y-OR-N-P reads "yes", is no line for the prompt.
(defmethod stream-clear-input ((stream typed-text))
  (when (or (typed-by-hand-p stream)
            (plusp (typed-position stream)))
    (setf (typed-position stream) (length (typed-line stream))))
  (when (typed-by-hand-p stream) (clear-input (typed-octets stream)))
  nil)

;;; Only streams of this process can be checked, without waiting, for typed input.

(defun source-stream (stream)
  "Return the stream from which STREAM gets its input."
  (typecase stream
    (typed-text (typed-octets stream))
    (synonym-stream (source-stream (symbol-value (synonym-stream-symbol stream))))
    (t stream)))

(defun terminal-stream-p (stream)
  "True if STREAM is on a terminal, as far as that can be found out."
  (let ((source (source-stream stream)))
    (and (typep source 'descriptor-stream) (interactive-stream-p source))))

(defun typed-input-within-p (stream seconds)
  "Wait up to SECONDS for typed input in STREAM, or for its end. Return false if neither came."
  (or (and (typep stream 'typed-text) (typed-ahead-p stream))
      (octets-within-p (source-stream stream) seconds)))

;;;; What another thread hands over

;;; A terminal's keys come from a file, a window's from such a stream, whose characters are octets.

(defclass queued-octets (fundamental-character-input-stream)
  ((lock :initform (make-lock "octets") :reader queued-lock)
   (ready :initform (make-semaphore "octets") :reader queued-ready)
   ;; The last octets, how many of them have been read, and whether more may come.
   (octets :initform "" :accessor queued-string)
   (start :initform 0 :accessor queued-start)
   (over-p :initform nil :accessor queued-over-p))
  (:documentation "An input stream of octets supplied by other threads. Reading waits for octets."))

(defun unread-octets (stream)
  (subseq (queued-string stream) (queued-start stream)))

(defun set-unread-octets (stream octets)
  "Replace the unread octets of STREAM by OCTETS, a string. The lock of STREAM must be held."
  (setf (queued-string stream) octets
        (queued-start stream) 0))

(defun change-unread-octets (stream function)
  "Call FUNCTION with the unread octets of STREAM, a string, and replace them by the string that
FUNCTION returns. No other thread reads from STREAM meanwhile."
  (with-lock ((queued-lock stream))
    (set-unread-octets stream (funcall function (unread-octets stream))))
  (signal-semaphore (queued-ready stream))
  (values))

(defun end-queued-input (stream)
  (with-lock ((queued-lock stream)) (setf (queued-over-p stream) t))
  (signal-semaphore (queued-ready stream))
  (values))

(defun next-queued-octet (stream)
  "Return the next octet of STREAM, :EOF at the end, or NIL if no octet is available yet."
  (with-lock ((queued-lock stream))
    (cond ((listen stream) (prog1 (char (queued-string stream) (queued-start stream))
                             (incf (queued-start stream))))
          ((queued-over-p stream) :eof))))

(defmethod stream-read-char-no-hang ((stream queued-octets))
  (next-queued-octet stream))

(defmethod stream-read-char ((stream queued-octets))
  (loop (let ((char (next-queued-octet stream)))
          (when char (return char)))
        (wait-on-semaphore (queued-ready stream))))

(defmethod stream-unread-char ((stream queued-octets) char)
  (with-lock ((queued-lock stream))
    (set-unread-octets stream (uiop:strcat (string char) (unread-octets stream))))
  nil)

(defmethod stream-listen ((stream queued-octets))
  (< (queued-start stream) (length (queued-string stream))))

(defmethod stream-clear-input ((stream queued-octets))
  (with-lock ((queued-lock stream)) (set-unread-octets stream ""))
  nil)

(defmethod octets-within-p ((stream queued-octets) seconds)
  ;; What has been read already may have left its signals.
  (loop until (or (listen stream) (queued-over-p stream))
        always (wait-on-semaphore (queued-ready stream) seconds)))
