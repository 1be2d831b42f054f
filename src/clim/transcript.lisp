;;;; transcript.lisp -- the messages of a window, also of errors in it.

(in-package :ars-magna.clim)

;;; The thread of a window handles its mouse and its keys. If it waited in a debugger, no one could
;;; answer there.

(defun refuse-debugger (condition hook)
  "Signal MISUSE, as CONDITION calls for a debugger in the thread of a window."
  (declare (ignore hook))
  (reject-use "It calls for the debugger (~A), and a window does not wait for that. SAVE-PICTURE ~
               at the prompt draws it where the debugger answers."
              (one-line-text condition)))

(defmacro without-debugger (&body body)
  "Run BODY; anything in it that would call a debugger is an error."
  `(let ((*break-on-user-error* nil) (*debugger-refused-p* t))
     (with-debugger-hook (#'refuse-debugger) ,@body)))

(defun call-guarded-command (window title function)
  (handler-case (funcall function)
    (error (condition)
      (say-in-window window "*ERROR* -> ~A: ~A.~%" title (one-line-text condition)))))

(defmacro with-guarded-command ((window title) &body body)
  "Run BODY, the work of the command TITLE; write its error, if any, into WINDOW."
  `(call-guarded-command ,window ,title (lambda () ,@body)))

;;;; The transcript

;;; Any thread may add lines; they are kept newest first, the last few thousand of them. Each has a
;;; number, counted from the first there was. Lines have colours in them as at a terminal.

(defconstant +transcript-length+ 2000 "How many lines of a transcript are kept.")
(defconstant +longest-line+ 4000 "Most characters in a line; a longer one continues as another.")

(defstruct (transcript (:constructor make-transcript (news)) (:copier nil))
  "Lines of text, newest first. NEWS is called, with no arguments, when there is more."
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

(defun begin-line-of (transcript)
  (push "" (transcript-lines transcript))
  (incf (transcript-count transcript))
  (incf (transcript-newest transcript)))

(defun add-part (transcript part)
  "Add PART to the last line of TRANSCRIPT; a return character goes back to the line's beginning."
  (let ((return (position #\Return part :from-end t)))
    (when return (setf (first (transcript-lines transcript)) ""))
    (when (< +longest-line+ (length (first (transcript-lines transcript))))
      (begin-line-of transcript))
    (setf (first (transcript-lines transcript))
          (uiop:strcat (first (transcript-lines transcript))
                       (subseq part (if return (1+ return) 0))))))

(defun add-text (transcript text)
  (loop for (part . more) on (uiop:split-string text :separator '(#\Newline))
        do (add-part transcript part)
           (when more (begin-line-of transcript))))

(defun forget-lines (transcript)
  "Keep only the newest lines of TRANSCRIPT, if there are many; the first says that others are
gone."
  (when (> (transcript-count transcript) (* 2 +transcript-length+))
    (setf (transcript-lines transcript)
          (append (subseq (transcript-lines transcript) 0 (1- +transcript-length+))
                  (list "(Earlier lines are no longer kept.)"))
          (transcript-count transcript) +transcript-length+)))

(defun call-changing-transcript (transcript function)
  "Call FUNCTION, which changes TRANSCRIPT, and report that change."
  (with-lock ((transcript-lock transcript))
    (funcall function)
    (incf (transcript-total transcript))
    (forget-lines transcript))
  (funcall (transcript-news transcript)))

(defun say (transcript text)
  (call-changing-transcript transcript (lambda () (add-text transcript text))))

(defun say-in-window (window &rest arguments)
  "Add the text that FORMAT makes of ARGUMENTS to the transcript of WINDOW."
  (say (window-transcript window) (apply #'format nil arguments)))

(defun say-entered (transcript text)
  (call-changing-transcript transcript (lambda ()
                                         (incf (transcript-entered transcript))
                                         (add-text transcript text))))

(defun unsay (transcript text)
  "Remove TEXT if it is the whole last line of TRANSCRIPT."
  (call-changing-transcript
   transcript
   (lambda ()
     (when (string= text (first (transcript-lines transcript)))
       (setf (first (transcript-lines transcript)) "")))))

(defun go-on-from (transcript lines)
  "Make TRANSCRIPT, which has not been shown yet, begin with LINES, newest first."
  (call-changing-transcript
   transcript
   (lambda ()
     (setf (transcript-lines transcript) lines
           (transcript-count transcript) (length lines)
           (transcript-newest transcript) (1- (length lines))))))

(defun empty-transcript (transcript)
  (call-changing-transcript
   transcript
   (lambda ()
     (incf (transcript-newest transcript))
     (setf (transcript-lines transcript) (list "")
           (transcript-count transcript) 1))))

(defun numbered-lines (transcript count &optional last)
  "Return at most COUNT lines of TRANSCRIPT up to the one numbered LAST, by default the newest,
which comes first; each as a list of its number and its text."
  (with-lock ((transcript-lock transcript))
    (let* ((newest (transcript-newest transcript))
           (skip (if last (max 0 (- newest last)) 0)))
      (loop for line in (nthcdr skip (transcript-lines transcript))
            for number downfrom (- newest skip)
            repeat count
            collect (list number line)))))

(defun latest-lines (transcript count)
  "Return a list of the last COUNT lines of TRANSCRIPT, oldest first."
  (reverse (mapcar #'second (numbered-lines transcript count))))

(defun text-between (transcript from to)
  "Return the text of TRANSCRIPT between the places FROM and TO, each a list of the number of a line
and a column, without colours."
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
  (say (stream-transcript stream) (subseq string start end))
  string)

(defmethod stream-write-char ((stream transcript-stream) char)
  (say (stream-transcript stream) (string char))
  char)

(defmethod stream-line-column ((stream transcript-stream))
  (length (first (latest-lines (stream-transcript stream) 1))))
