;;;; progress.lisp -- how far something has come, on a terminal: a line that changes in its place.

(in-package :ars-magna.cli)

(defstruct (progress-line (:constructor make-progress-line (console)) (:copier nil))
  "A line of CONSOLE that says how far something has come, once that takes a while."
  (console nil :type console :read-only t)
  (due (+ (seconds-now) 0.5d0) :type double-float)
  (width 0 :type fixnum))

(defun write-over (progress text)
  (with-console (stream (progress-line-console progress))
    (format stream "~C~VA~:[~C~;~]" #\Return (progress-line-width progress) text
            (string/= text "") #\Return)
    (force-output stream))
  (setf (progress-line-width progress) (length text)))

(defun note-progress (progress control &rest arguments)
  "Let the line of PROGRESS, unless that is NIL, say what is formatted from CONTROL and ARGUMENTS,
if it is time to."
  (when (and progress (>= (seconds-now) (progress-line-due progress)))
    (setf (progress-line-due progress) (+ (seconds-now) 0.2d0))
    (write-over progress (apply #'format nil control arguments))))

(defun end-progress (progress)
  (when (plusp (progress-line-width progress)) (write-over progress "")))

;;; Beside it.

(defun say (control &rest arguments)
  "Tell the user something beside what he has asked for."
  ;; A line that tells of progress may stand there.
  (when (interactive-stream-p *error-output*)
    (format *error-output* "~C~A" #\Return (row-cleared)))
  (format *error-output* "ars-magna: ~?~%" control arguments)
  (finish-output *error-output*))
