;;;; process.lisp -- this process: its arguments, standard streams, signals, terminal and end.

(in-package :ars-magna.cli)

(defun process-arguments ()
  (rest (uiop:raw-command-line-arguments)))

(defun end-process (status)
  "End this process with STATUS, at once: nothing is flushed and no thread is waited for."
  (restore-manner)
  (call-allowing-exits (lambda () (uiop:quit status nil))))

;;; Streams.

(defgeneric octets-within-p (stream seconds)
  (:documentation "Wait until STREAM can be read or is at its end, for SECONDS at most. True if
so.")
  (:method ((stream stream) seconds)
    (input-within-p stream seconds)))

(defun say-on-error-output (text)
  "Write TEXT to the error output as a line that names the program, whatever state streams are in."
  (flet ((write-to (output)
           (write-string (concatenate 'string "ars-magna: " text '(#\Newline)) output)
           (finish-output output)))
    ;; A stream cannot be made where numbers cannot be printed.
    (handler-case (write-to (text-output 2))
      (error () (ignore-errors (write-to *error-output*))))))

;;; Control-C. It reaches this process's first thread, between any two of its instructions. The
;;; prompt catches it, so that it ends only what the user wants to end: see RUN-SESSION.

(defvar *interrupts-while-ending* nil
  "How often control C has come since one began to end this process; NIL while none has.")

(defconstant +patience-of-users+ 3
  "How often control C may come while this process ends before it ends at once.")

(defun end-interrupted ()
  (say-on-error-output "stopped.")
  (end-process 130))

(defun heed-interrupt ()
  "Let the handlers of this thread end what it does, or continue by the restart GO-ON."
  (allowing-interrupts
    (with-simple-restart (go-on "Go on.")
      (signal-user-interrupt))))

;; After Control-C, cleanup must finish before this process ends; Control-C often comes twice.
(defun take-interrupt ()
  "Heed that control C has come, unless it has already begun to end this process."
  (cond ((null *interrupts-while-ending*) (heed-interrupt))
        ((< (incf *interrupts-while-ending*) +patience-of-users+))
        (t (end-interrupted))))

(defvar *hearer* nil "The stream that has this thread's error output until it begins to end.")

(defun begin-to-end (condition)
  "Suppress other output between CONDITION, an interrupt, and the message on it: the compiler would
report that it has been left."
  (declare (ignore condition))
  (setf *interrupts-while-ending* 0
        *hearer* (make-broadcast-stream)))

(defun call-until-interrupted (function then)
  "Call FUNCTION and return its values. If control C ends it, this process is ending: return the
values of THEN, another function, which is not interrupted."
  (let ((*hearer* *error-output*))
    (handler-case
        (handler-bind ((user-interrupt #'begin-to-end))
          (let ((*error-output* (make-synonym-stream '*hearer*)))
            (funcall function)))
      (user-interrupt () (funcall then)))))

;; Users' code may handle this signal as an error of its own, or block interrupts. The function that
;; counts how often Control-C comes runs in any thread and calls no users' code.

(defvar *before-ending-at-once* nil
  "A function of no arguments to call before Control-C ends this process at once; NIL at a terminal
or window, where the user may press it any number of times.")

(defvar *interrupt-times* '() "When control C came, in seconds, newest first.")

(defparameter *interrupt-span* 5
  "Within how many seconds control C has to come again to end this process at once.")

(defun ends-at-once-p (now times)
  "True if control C, which comes at NOW and has come at TIMES, is to end this process at once: the
third time, or, unless it came twice for once, the second if the first has had no effect."
  (and times
       (or (rest times)
           (and (null *interrupts-while-ending*) (< 1/3 (- now (first times)))))))

(defun note-interrupt ()
  "Note that control C has come. End this process if it has done so too often."
  (let* ((now (seconds-now))
         (times (remove-if (lambda (time) (< time (- now *interrupt-span*))) *interrupt-times*)))
    (setf *interrupt-times* (cons now times))
    (when (and *before-ending-at-once* (ends-at-once-p now times))
      (funcall *before-ending-at-once*)
      (end-process 130))))

(defun mind-interrupts ()
  "Let Control-C interrupt this thread, the process's first."
  (let ((thread (current-thread)))
    (call-on-interrupt (lambda ()
                         (note-interrupt)
                         (interrupt-thread thread #'take-interrupt)))))

;;;; The terminal

;;; By default, a terminal passes on whole lines, and echoes what is typed wherever the cursor is.
;;; While the prompt edits lines itself, the terminal passes on each key at once without echo.
;;; Control-C works in two ways: while a line runs, it is a signal; while one is typed, it is a key
;;; like others, so that the order of keys is kept.

(defvar *first-manner* nil "The manner of the terminal before the prompt changed it, or NIL.")
(defvar *keys-interrupt-p* nil "True if control C and its like are signals, as said last.")
(defvar *continued-p* nil "True if this process was stopped and continues, and this has not been
noticed yet.")

(defun manner ()
  "Return the mode of the terminal, as the system keeps it, or NIL if there is no terminal."
  (ignore-errors (sb-posix:tcgetattr 0)))

(defun set-manner (manner)
  "Set the mode of the terminal to MANNER. Do nothing if it is gone."
  (ignore-errors (sb-posix:tcsetattr 0 sb-posix:tcsanow manner)))

(defun hand-over-keys (&key interrupts)
  "Let the terminal pass on keys as they are pressed, without echo. If INTERRUPTS is true, Control-C
and the like are signals instead, which let pending output reach the screen. Only within
CALL-HANDING-OVER-KEYS."
  (setf *keys-interrupt-p* interrupts)
  (let ((manner (manner))
        (line-manner (logior sb-posix:icanon sb-posix:echo sb-posix:iexten sb-posix:isig)))
    (when (and manner *first-manner*)
      (setf (sb-posix:termios-lflag manner)
            (logior (logandc2 (sb-posix:termios-lflag manner) line-manner)
                    (if interrupts (logior sb-posix:isig sb-posix:noflsh) 0))
            (aref (sb-posix:termios-cc manner) sb-posix:vmin) 1
            (aref (sb-posix:termios-cc manner) sb-posix:vtime) 0)
      (set-manner manner))))

(defun restore-manner ()
  "Let the terminal pass on lines again, if the prompt had begun to edit them."
  (when *first-manner* (set-manner *first-manner*)))

(defun call-handing-over-keys (function)
  (setf *first-manner* (manner))
  (unwind-protect (progn (hand-over-keys :interrupts t)
                         (funcall function))
    (restore-manner)
    (setf *first-manner* nil)))

(defun stop-for-a-while ()
  "Give the terminal to the parent process, as Control-Z does, until this process continues."
  (restore-manner)
  (sb-posix:kill 0 sb-posix:sigtstp)
  (hand-over-keys))

;; Another program, such as a shell, may have changed the mode of the terminal meanwhile.
(defun take-terminal-again ()
  "Let the terminal pass on keys again, as this process continues after a stop."
  (hand-over-keys :interrupts *keys-interrupt-p*)
  (setf *continued-p* t))

(defun quit-by-signal ()
  "End this process as Control-\\ does when keys are not passed on."
  (restore-manner)
  (sb-posix:kill (process-number) sb-posix:sigquit))

;;; How large the window is.

(defun window-size ()
  (multiple-value-bind (rows columns) (rows-and-columns)
    (values (if (plusp columns) columns 80)
            (if (plusp rows) rows 24))))
