;;;; console.lisp -- an output stream that knows where the cursor is and whether a prompt stands.

(in-package :ars-magna.cli)

;;; What the simulator and the user's programs print comes from other threads, at any time. The
;;; console keeps what each of them writes in one piece, and knows when a prompt has been written
;;; over and must be shown again. A terminal moves the cursor when the user presses return; nobody
;;; but ANSWERED can know. When what is written cannot be delivered, it is lost, and the program
;;; ends.

(defclass console (fundamental-character-output-stream)
  ((stream :initarg :stream :reader console-stream)
   (lock :initform (make-lock "console") :reader console-lock)
   (column :initform 0 :accessor console-column)
   (question :initform nil :accessor console-prompt)
   (overwritten-p :initform nil :accessor console-overwritten-p)
   (trouble :initform nil :accessor console-trouble)
   (colored-p :initform nil :accessor console-colored-p)
   (held-back-p :initform nil :accessor console-held-back-p)
   (held-back :initform '() :accessor console-held-back))
  (:documentation "An output stream on top of another. QUESTION is what stands there for the user to
answer, or NIL; OVERWRITTEN-P is true if something was written after it. TROUBLE is the condition
that what was written could not be delivered, or NIL. COLORED-P is true if its messages and prompts
have colours. While HELD-BACK-P is true, what is written is kept in HELD-BACK, a list of strings,
newest first."))

(defun make-console (stream)
  (if (typep stream 'console) stream (make-instance 'console :stream stream)))

(defvar *leave-unheard-p* nil
  "True in the thread that ends this process, when there is nobody any more to write for.")

(defun try-to-write (function console)
  "Call FUNCTION with the stream below CONSOLE, unless that has failed before. True if it fails
now."
  (with-lock ((console-lock console))
    (unless (console-trouble console)
      (handler-case (progn (funcall function (console-stream console)) nil)
        (stream-error (trouble) (setf (console-trouble console) trouble))))))

(defun call-with-console (function console)
  "Call FUNCTION with the stream below CONSOLE, unless it has failed before."
  (when (and (call-holding-interrupts (lambda () (try-to-write function console)))
             *leave-unheard-p*)
    (throw 'leave 1)))

(defmacro with-console ((stream console) &body body)
  "Run BODY with STREAM bound to the stream below CONSOLE, nobody else writing to it."
  `(call-with-console (lambda (,stream) ,@body) ,console))

(defun painted (text ink console)
  "Return TEXT as CONSOLE shows it: in INK, if it has colours."
  (if (console-colored-p console) (paint text ink) text))

(defmethod stream-line-column ((console console))
  (console-column console))

(defconstant +most-held-back+ 1000 "How many strings a console holds back; older ones are lost.")

(defun hold-back (string console)
  (let ((held (cons string (console-held-back console))))
    (setf (console-held-back console)
          (if (nthcdr (* 2 +most-held-back+) held) (subseq held 0 +most-held-back+) held))))

(defun put-string (string console stream &optional (start 0) (end (length string)))
  "Write STRING from START to END to STREAM, which is below CONSOLE, where nobody else writes now."
  (let ((newline (position #\Newline string :start start :end end :from-end t)))
    (if (console-held-back-p console)
        (hold-back (subseq string start end) console)
        (write-string string stream :start start :end end))
    (setf (console-overwritten-p console) t
          (console-column console) (if newline
                                       (- end newline 1)
                                       (+ (console-column console) (- end start))))))

(defmethod stream-write-string ((console console) string &optional (start 0) end)
  (with-console (stream console)
    (put-string string console stream start (or end (length string))))
  string)

(defun write-fresh (text console)
  "Write TEXT from the beginning of a line of CONSOLE on, all of it in one piece."
  (with-console (stream console)
    (when (plusp (console-column console)) (put-string (string #\Newline) console stream))
    (put-string text console stream)))

(defmethod stream-write-char ((console console) char)
  (stream-write-string console (string char))
  char)

(defmethod stream-force-output ((console console))
  (with-console (stream console) (force-output stream)))

(defmethod stream-finish-output ((console console))
  (with-console (stream console) (finish-output stream)))

;;; Prompts.

(defun show-prompt (console prompt)
  "Write PROMPT, a string, at the start of a line."
  (fresh-line console)
  (write-string (painted prompt :bold console) console)
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

;;; A screen of its own.

(defun write-at-once (text console)
  "Write TEXT to what is below CONSOLE, whether or not that holds back what is written to it."
  (with-console (stream console)
    (write-string text stream)
    (finish-output stream)))

(defun last-held-back (console)
  "Return the last line that CONSOLE holds back, without colours, or an empty string."
  (let* ((text (find-if (lambda (string) (find #\Newline string :test #'char/=))
                        (console-held-back console)))
         (text (string-right-trim '(#\Newline) (unpainted-text (or text "")))))
    (subseq text (1+ (or (position #\Newline text :from-end t) -1)))))

(defun begin-screen (console)
  (setf (console-held-back-p console) t)
  (write-at-once (screen-begun) console))

(defun end-screen (console)
  (write-at-once (screen-ended) console)
  (with-console (stream console)
    (setf (console-held-back-p console) nil)
    (dolist (string (reverse (shiftf (console-held-back console) '())))
      (write-string string stream))
    (finish-output stream)))

(defun call-with-screen (function console)
  "Call FUNCTION while CONSOLE, on a terminal, shows a screen that is written over by WRITE-AT-ONCE
and OVER-SCREEN, and gives each key as it is pressed. What others write meanwhile comes afterwards."
  (call-holding-interrupts
   (lambda ()
     (call-with-keys
      (lambda ()
        (begin-screen console)
        (unwind-protect (call-open-to-interrupts function)
          (end-screen console)))))))
