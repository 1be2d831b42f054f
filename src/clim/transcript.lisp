;;;; transcript.lisp -- the messages of a window, also of errors in it.

(in-package :ars-magna.clim)

;;; The thread of a window handles mouse and keys. If it waited in a debugger, no one could answer.

(defun signal-debugger-refused (condition hook)
  "Signal MISUSE instead of entering the debugger for CONDITION in the thread of a window."
  (declare (ignore hook))
  (reject-use "Drawing code has called the debugger (~A), which a window does not allow. Call ~
               SAVE-PICTURE at the prompt: it draws the same, and the debugger works."
              (one-line-text condition)))

(defmacro without-debugger (&body body)
  "Run BODY. An attempt in BODY to enter the debugger signals an error instead."
  `(let ((*break-on-user-error* nil) (*debugger-refused-p* t))
     (with-debugger-hook (#'signal-debugger-refused) ,@body)))

(defun call-guarded-command (window title function)
  (handler-case (funcall function)
    (error (condition)
      (write-in-window window "~A~%"
                       (ars-magna.cli:paint (format nil "*ERROR* -> ~A: ~A." title
                                                    (one-line-text condition))
                                            :red)))))

(defmacro with-guarded-command ((window title) &body body)
  "Run BODY, which executes the command TITLE. If BODY signals an error, print it in WINDOW."
  `(call-guarded-command ,window ,title (lambda () ,@body)))

;; The window may show another run than when its thread began.
(defun call-with-messages-of-run (function window)
  "Call FUNCTION, which draws. Messages, such as errors in drawing code, go to the run of WINDOW."
  (let* ((simulation (window-simulation window))
         (*message-queue* (if simulation (simulation-messages simulation) *message-queue*)))
    (funcall function)))

;;;; The transcript

;;; Any thread may add lines; they are kept newest first, the last few thousand of them. Each has a
;;; number, counted from the first there was. Lines have colours in them as at a terminal.

(defconstant +transcript-length+ 2000 "The number of lines of a transcript that are kept.")
(defconstant +longest-line+ 4000
  "The largest number of characters of a line. A longer line is continued as another line.")

(defstruct (transcript (:constructor make-transcript (news)) (:copier nil))
  "A window's text: lines, newest first. NEWS, a function of no arguments, is called on each
change."
  (news nil :type function :read-only t)
  (lock (make-lock "transcript") :read-only t)
  (lines (list "") :type list)
  (count 1 :type fixnum)
  ;; The number of the newest line.
  (newest 0 :type fixnum)
  ;; How many messages there have been, to see whether there are new ones.
  (total 0 :type fixnum)
  ;; How many lines the user has entered.
  (entered 0 :type fixnum))

(defun begin-transcript-line (transcript)
  (push "" (transcript-lines transcript))
  (incf (transcript-count transcript))
  (incf (transcript-newest transcript)))

(defconstant +tab-width+ 8 "The number of columns from one tab stop to the next.")

(defun expand-tabs (text column)
  "Return TEXT, which begins at COLUMN of a line, with spaces in place of tabs."
  (with-output-to-string (out)
    (loop for (part . more) on (uiop:split-string text :separator '(#\Tab))
          do (write-string part out)
             (incf column (length (ars-magna.cli:unpainted-text part)))
             (when more
               (let ((width (- +tab-width+ (mod column +tab-width+))))
                 (incf column width)
                 (format out "~VA" width ""))))))

(defun add-to-last-line (transcript part)
  "Add PART to the last line of TRANSCRIPT. A return character in PART erases the text before it."
  (let ((return (position #\Return part :from-end t)))
    (when return (setf (first (transcript-lines transcript)) ""))
    (when (< +longest-line+ (length (first (transcript-lines transcript))))
      (begin-transcript-line transcript))
    (let ((line (first (transcript-lines transcript)))
          (text (subseq part (if return (1+ return) 0))))
      (setf (first (transcript-lines transcript))
            (uiop:strcat line
                         (if (find #\Tab text)
                             (expand-tabs text (length (ars-magna.cli:unpainted-text line)))
                             text))))))

(defun add-text (transcript text)
  (loop for (part . more) on (uiop:split-string text :separator '(#\Newline))
        do (add-to-last-line transcript part)
           (when more (begin-transcript-line transcript))))

(defun drop-old-lines (transcript)
  "Drop the oldest lines of TRANSCRIPT if there are too many. A new first line says so."
  (when (> (transcript-count transcript) (* 2 +transcript-length+))
    (setf (transcript-lines transcript)
          (append (subseq (transcript-lines transcript) 0 (1- +transcript-length+))
                  (list "(Earlier lines are no longer kept.)"))
          (transcript-count transcript) +transcript-length+)))

(defun call-changing-transcript (transcript function)
  (with-lock ((transcript-lock transcript))
    (funcall function)
    (incf (transcript-total transcript))
    (drop-old-lines transcript))
  (funcall (transcript-news transcript)))

(defun write-to-transcript (transcript text)
  (call-changing-transcript transcript (lambda () (add-text transcript text))))

(defun write-in-window (window &rest arguments)
  (write-to-transcript (window-transcript window) (apply #'format nil arguments)))

(defun write-entered-line (transcript text)
  (call-changing-transcript transcript (lambda ()
                                         (incf (transcript-entered transcript))
                                         (add-text transcript text))))

(defun erase-last-line (transcript text)
  (call-changing-transcript
   transcript
   (lambda ()
     (when (string= text (first (transcript-lines transcript)))
       (setf (first (transcript-lines transcript)) "")))))

(defun set-initial-lines (transcript lines)
  "Make LINES, newest first, the lines of TRANSCRIPT, which has not been shown yet. The user has
entered at least one of them."
  (call-changing-transcript
   transcript
   (lambda ()
     (setf (transcript-lines transcript) lines
           (transcript-count transcript) (length lines)
           (transcript-newest transcript) (1- (length lines))
           (transcript-entered transcript) 1))))

(defun clear-transcript (transcript)
  (call-changing-transcript
   transcript
   (lambda ()
     (incf (transcript-newest transcript))
     (setf (transcript-lines transcript) (list "")
           (transcript-count transcript) 1))))

(defun numbered-lines (transcript count &optional last)
  "Return the last COUNT lines of TRANSCRIPT up to line number LAST, by default the newest. Each
line is a list (number text); the newest comes first."
  (with-lock ((transcript-lock transcript))
    (let* ((newest (transcript-newest transcript))
           (skip (if last (max 0 (- newest last)) 0)))
      (loop for line in (nthcdr skip (transcript-lines transcript))
            for number downfrom (- newest skip)
            repeat count
            collect (list number line)))))

(defun latest-lines (transcript count)
  "Return the texts of the last COUNT lines of TRANSCRIPT, oldest first."
  (reverse (mapcar #'second (numbered-lines transcript count))))

(defun text-between (transcript from to)
  "Return the text of TRANSCRIPT from FROM to TO, without colours. FROM and TO are lists (number
column) of a line and a column."
  (with-output-to-string (out)
    (loop for ((number text) . more) on (reverse (numbered-lines transcript (transcript-count
                                                                             transcript)
                                                                 (first to)))
          for plain = (ars-magna.cli:unpainted-text text)
          for start = (if (= number (first from)) (min (second from) (length plain)) 0)
          for end = (and (= number (first to)) (min (second to) (length plain)))
          when (<= (first from) number)
            do (write-string plain out :start start :end end)
               (when more (terpri out)))))

;;; As a stream.

(defclass transcript-stream (fundamental-character-output-stream)
  ((transcript :initarg :transcript :reader stream-transcript))
  (:documentation "An output stream that adds its output to a transcript."))

(defmethod stream-write-string ((stream transcript-stream) string &optional (start 0) end)
  (write-to-transcript (stream-transcript stream) (subseq string start end))
  string)

(defmethod stream-write-char ((stream transcript-stream) char)
  (write-to-transcript (stream-transcript stream) (string char))
  char)

(defmethod stream-line-column ((stream transcript-stream))
  (length (first (latest-lines (stream-transcript stream) 1))))
