;;;; process.lisp -- this process: its arguments, standard streams, signals, terminal and end.

(in-package :ars-magna.cli)

(defun process-arguments ()
  (rest (uiop:raw-command-line-arguments)))

(defun end-process (status)
  "End this process with STATUS, at once: nothing is flushed and no thread is waited for."
  (restore-terminal-mode)
  (call-allowing-exits (lambda () (uiop:quit status nil))))

;;; Streams.

(defgeneric octets-within-p (stream seconds)
  (:documentation "Wait up to SECONDS for input in STREAM or its end. Return true if one comes.")
  (:method ((stream stream) seconds)
    (wait-for-input stream seconds)))

(defun say-on-error-output (text)
  "Write the program's name and TEXT to the error output, whatever the state of the streams."
  (flet ((write-to (output)
           (write-string (concatenate 'string "ars-magna: " text '(#\Newline)) output)
           (finish-output output)))
    ;; A stream cannot be made where numbers cannot be printed.
    (handler-case (write-to (text-output-stream 2))
      (error () (ignore-errors (write-to *error-output*))))))

;;; Control-C. It reaches this process's first thread, between any two of its instructions. The
;;; prompt catches it, so that it ends only what the user wants to end: see RUN-SESSION.

(defvar *interrupts-while-ending* nil
  "The number of times Control-C was pressed while this process was ending; NIL before it ends.")

(defconstant +interrupts-before-exit+ 3
  "How many presses of Control-C, while this process is ending, end it at once.")

(defun exit-after-interrupts ()
  (say-on-error-output "stopped.")
  (end-process 130))

(defun handle-interrupt ()
  "Signal a user interrupt in this thread. The restart GO-ON continues the interrupted code."
  (allowing-interrupts
    (with-simple-restart (go-on "Go on.")
      (signal-user-interrupt))))

;; After Control-C, cleanup must finish before this process ends; Control-C often comes twice.
(defun handle-or-count-interrupt ()
  "Handle Control-C. If this process is ending, count the interrupt, and exit after too many."
  (cond ((null *interrupts-while-ending*) (handle-interrupt))
        ((< (incf *interrupts-while-ending*) +interrupts-before-exit+))
        (t (exit-after-interrupts))))

(defvar *ending-error-output* nil
  "The stream for this thread's error output. It discards output once the process is ending.")

(defun mark-process-ending (condition)
  "Record that CONDITION, an interrupt, ends this process. Until the final message, discard error
output, such as the compiler's report that it was aborted."
  (declare (ignore condition))
  (setf *interrupts-while-ending* 0
        *ending-error-output* (make-broadcast-stream)))

(defun call-until-interrupted (function then)
  "Call FUNCTION and return its values. If Control-C interrupts FUNCTION, this process is ending:
call THEN, which is not interrupted, and return the values of THEN."
  (let ((*ending-error-output* *error-output*))
    (handler-case
        (handler-bind ((user-interrupt #'mark-process-ending))
          (let ((*error-output* (make-synonym-stream '*ending-error-output*)))
            (funcall function)))
      (user-interrupt () (funcall then)))))

;; Users' code may handle this signal as its own error, or block interrupts. The function that
;; counts how often Control-C comes runs in any thread and calls no users' code.

(defvar *before-ending-at-once* nil
  "A function of no arguments to call before Control-C ends this process at once; NIL at a terminal
or window, where the user may press Control-C at will.")

(defvar *interrupt-times* '() "When Control-C was pressed, in seconds, newest first.")

(defparameter *interrupt-window-seconds* 5
  "The number of seconds within which repeated presses of Control-C end this process at once.")

(defun exit-at-once-p (now times)
  "True if Control-C, pressed at NOW and earlier at TIMES, should end this process at once. The
third press does. So does the second if the first had no effect and was over 1/3 s earlier."
  (and times
       (or (rest times)
           (and (null *interrupts-while-ending*) (< 1/3 (- now (first times)))))))

(defun note-interrupt ()
  "Record a Control-C. End this process after too many presses."
  (let* ((now (seconds-now))
         (times (remove-if (lambda (time) (< time (- now *interrupt-window-seconds*)))
                           *interrupt-times*)))
    (setf *interrupt-times* (cons now times))
    (when (and *before-ending-at-once* (exit-at-once-p now times))
      (funcall *before-ending-at-once*)
      (end-process 130))))

(defun accept-interrupts ()
  "Make Control-C interrupt this thread, the first thread of the process."
  (let ((thread (current-thread)))
    (call-on-interrupt (lambda ()
                         (note-interrupt)
                         (interrupt-thread thread #'handle-or-count-interrupt)))))

;;;; The terminal

;;; By default, a terminal passes on whole lines, and echoes what is typed wherever the cursor is.
;;; While the prompt edits lines itself, the terminal passes on each key at once without echo.
;;; Control-C works in two ways: while a line runs, it is a signal; while one is typed, it is a key
;;; like others, so that the order of keys is kept.

(defvar *original-mode* nil "The mode of the terminal before the prompt changed it, or NIL.")
(defvar *keys-interrupt-p* nil
  "True if the terminal turns Control-C and similar keys into signals.")
(defvar *continued-p* nil
  "True from the time when a suspended process continues until the prompt has redrawn its line.")

(defun terminal-mode ()
  (ignore-errors (sb-posix:tcgetattr 0)))

(defun set-terminal-mode (terminal-mode)
  (ignore-errors (sb-posix:tcsetattr 0 sb-posix:tcsanow terminal-mode)))

(defun enter-key-mode (&key interrupts)
  "Make the terminal pass on each key at once, without echo. If INTERRUPTS, Control-C and similar
keys are signals instead; pending output is kept. ENTER-KEY-MODE works only in CALL-IN-KEY-MODE."
  (setf *keys-interrupt-p* interrupts)
  (let ((terminal-mode (terminal-mode))
        (line-flags (logior sb-posix:icanon sb-posix:echo sb-posix:iexten sb-posix:isig)))
    (when (and terminal-mode *original-mode*)
      (setf (sb-posix:termios-lflag terminal-mode)
            (logior (logandc2 (sb-posix:termios-lflag terminal-mode) line-flags)
                    (if interrupts (logior sb-posix:isig sb-posix:noflsh) 0))
            (aref (sb-posix:termios-cc terminal-mode) sb-posix:vmin) 1
            (aref (sb-posix:termios-cc terminal-mode) sb-posix:vtime) 0)
      (set-terminal-mode terminal-mode))))

(defun restore-terminal-mode ()
  "Restore the original mode of the terminal, if the prompt has changed it."
  (when *original-mode* (set-terminal-mode *original-mode*)))

(defun call-in-key-mode (function)
  (setf *original-mode* (terminal-mode))
  (unwind-protect (progn (enter-key-mode :interrupts t)
                         (funcall function))
    (restore-terminal-mode)
    (setf *original-mode* nil)))

(defun suspend-process ()
  "Suspend this process, as Control-Z does. Until it continues, the terminal has its original mode."
  (restore-terminal-mode)
  (sb-posix:kill 0 sb-posix:sigtstp)
  (enter-key-mode))

;; Another program, such as a shell, may have changed the mode of the terminal meanwhile.
(defun resume-terminal ()
  "Make the terminal pass on each key again, after this process was suspended."
  (enter-key-mode :interrupts *keys-interrupt-p*)
  (setf *continued-p* t))

(defun exit-by-sigquit ()
  "End this process by the signal SIGQUIT, as Control-\\ does in other programs."
  (restore-terminal-mode)
  (sb-posix:kill (process-id) sb-posix:sigquit))

;;; How large the window is.

(defun window-size ()
  (multiple-value-bind (rows columns) (window-rows-and-columns)
    (values (if (plusp columns) columns 80)
            (if (plusp rows) rows 24))))
