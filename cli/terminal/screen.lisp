;;;; screen.lisp -- output that is updated in place: a screen, as of WATCH, and a line.

(in-package :ars-magna.cli)

(defun write-immediately (text console)
  "Write TEXT to the stream of CONSOLE at once, even while CONSOLE holds back output."
  (with-console (stream console)
    (write-string text stream)
    (finish-output stream)))

(defun last-held-back-line (console)
  "Return the last line that CONSOLE holds back, without colours, or an empty string."
  (let* ((text (find-if (lambda (string) (find #\Newline string :test #'char/=))
                        (console-held-back console)))
         (text (string-right-trim '(#\Newline) (unpainted-text (or text "")))))
    (subseq text (1+ (or (position #\Newline text :from-end t) -1)))))

(defun begin-screen (console)
  (setf (console-held-back-p console) t)
  (write-immediately (begin-screen-code) console))

(defun end-screen (console)
  (write-immediately (end-screen-code) console)
  (with-console (stream console)
    (setf (console-held-back-p console) nil)
    (dolist (string (reverse (shiftf (console-held-back console) '())))
      (write-or-hold-back string console stream))
    (finish-output stream)))

(defun call-with-screen (function console)
  "Call FUNCTION while CONSOLE, on a terminal that passes on keys, shows a separate screen. FUNCTION
draws by WRITE-IMMEDIATELY and OVERWRITE-SCREEN-CODE. Other output is held back until the end."
  (call-holding-interrupts
   (lambda ()
     (begin-screen console)
     (unwind-protect (call-releasing-interrupts function)
       (end-screen console)))))

;;; A line that shows progress.

(defstruct (progress-line (:constructor make-progress-line (console)) (:copier nil))
  "A line of CONSOLE that shows the progress of a slow operation. DUE is the time of the next
update, WIDTH the length of the text shown."
  (console nil :type console :read-only t)
  (due (+ (seconds-now) 0.5d0) :type double-float)
  (width 0 :type fixnum))

(defun rewrite-progress (progress text)
  (with-console (stream (progress-line-console progress))
    (format stream "~C~VA~:[~C~;~]" #\Return (progress-line-width progress) text
            (string/= text "") #\Return)
    (force-output stream))
  (setf (progress-line-width progress) (length text)))

(defun note-progress (progress control &rest arguments)
  "If an update is due, show CONTROL formatted with ARGUMENTS in PROGRESS, a progress line or NIL."
  (when (and progress (>= (seconds-now) (progress-line-due progress)))
    (setf (progress-line-due progress) (+ (seconds-now) 0.2d0))
    (rewrite-progress progress (apply #'format nil control arguments))))

(defun end-progress (progress)
  (when (plusp (progress-line-width progress)) (rewrite-progress progress "")))

;;; Beside it.

(defun print-notice (control &rest arguments)
  "Format CONTROL with ARGUMENTS, and write the message to the error output."
  ;; A line that shows progress may be there.
  (when (interactive-stream-p *error-output*)
    (format *error-output* "~C~A" #\Return (clear-row-code)))
  (format *error-output* "ars-magna: ~?~%" control arguments)
  (finish-output *error-output*))
