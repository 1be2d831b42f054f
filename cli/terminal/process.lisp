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
  (:documentation "Wait until STREAM can be read or is at its end, for SECONDS at most. True if it
can, or is.")
  (:method ((stream stream) seconds)
    (input-within-p stream seconds)))

(defun say-on-error-output (text)
  "Write TEXT to the error output, whatever state streams are in, as a line that says who says so."
  (flet ((write-to (output)
           (write-string (concatenate 'string "ars-magna: " text '(#\Newline)) output)
           (finish-output output)))
    ;; A stream cannot be made where numbers cannot be printed.
    (handler-case (write-to (text-output 2))
      (error () (ignore-errors (write-to *error-output*))))))

;;; Control C. It reaches this process's first thread, between any two of its instructions. So that
;;; it ends what the user wants to end and nothing else, the prompt holds it: see RUN-SESSION.

(defvar *interrupts-while-ending* nil
  "How often control C has come since one began to end this process; NIL while none has.")

(defconstant +patience-of-users+ 3
  "How often control C may come while this process ends before it ends at once.")

(defun end-interrupted ()
  (say-on-error-output "stopped.")
  (end-process 130))

(defun heed-interrupt ()
  "Let the handlers of this thread end what it is at, or let it go on, by the restart GO-ON."
  (allowing-interrupts
    (with-simple-restart (go-on "Go on.")
      (signal-user-interrupt))))

;; What control C ends is to be put in order before this process ends; often it comes twice.
(defun take-interrupt ()
  "Heed that control C has come, unless it has already begun to end this process."
  (cond ((null *interrupts-while-ending*) (heed-interrupt))
        ((< (incf *interrupts-while-ending*) +patience-of-users+))
        (t (end-interrupted))))

(defvar *hearer* nil "The stream that hears this thread's error output until it begins to end.")

(defun begin-to-end (condition)
  "Let nothing come between what CONDITION, an interrupt, leaves and what is said of it: the
compiler would say that it has been left."
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

;; Users' code may take what is signalled here for an error of its own, or let no interrupt in. What
;; counts how often control C comes is called in any thread, and lets no code be called but ours.

(defvar *before-ending-at-once* nil
  "A function of no arguments to call before control C ends this process at once; NIL where somebody
sits, who may press it as often as he likes.")

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
  "Let control C interrupt this thread, which is the process's first."
  (let ((thread (current-thread)))
    (call-on-interrupt (lambda ()
                         (note-interrupt)
                         (interrupt-thread thread #'take-interrupt)))))

;;;; The terminal

;;; Left alone, a terminal hands over whole lines, and shows what is typed wherever the cursor is.
;;; While the prompt edits lines itself, it hands over each key at once and shows nothing. What
;;; control C does is told apart: while a line is carried out, it is a signal; while one is typed, a
;;; key like others, so that nothing typed before or after it comes in another order.

(defvar *first-manner* nil "The manner of the terminal before the prompt changed it, or NIL.")
(defvar *keys-interrupt-p* nil "True if control C and its like are signals, as said last.")
(defvar *continued-p* nil "True if this process was stopped and goes on, and nobody has seen that.")

(defun manner ()
  "Return the manner of the terminal, as the system keeps it, or NIL if there is no terminal."
  (ignore-errors (sb-posix:tcgetattr 0)))

(defun set-manner (manner)
  "Let the terminal have MANNER. One that is gone needs none."
  (ignore-errors (sb-posix:tcsetattr 0 sb-posix:tcsanow manner)))

(defun hand-over-keys (&key interrupts)
  "Let the terminal hand over keys as they are pressed, without showing them. If INTERRUPTS is true,
control C and its like are signals instead, which let what is on its way to the screen arrive. Only
within CALL-HANDING-OVER-KEYS."
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
  "Let the terminal hand over lines, as it did before the prompt began to edit them, if it did."
  (when *first-manner* (set-manner *first-manner*)))

(defun call-handing-over-keys (function)
  (setf *first-manner* (manner))
  (unwind-protect (progn (hand-over-keys :interrupts t)
                         (funcall function))
    (restore-manner)
    (setf *first-manner* nil)))

(defun stop-for-a-while ()
  "Let whoever started this process have the terminal, as control Z wants, until this process is
told to go on."
  (restore-manner)
  (sb-posix:kill 0 sb-posix:sigtstp)
  (hand-over-keys))

;; Whoever had the terminal meanwhile, such as a shell, has left it in a manner of his own.
(defun take-terminal-again ()
  "Let the terminal hand over keys as before, as this process goes on that was stopped."
  (hand-over-keys :interrupts *keys-interrupt-p*)
  (setf *continued-p* t))

(defun quit-by-signal ()
  "End this process as control \\ does where no keys are handed over."
  (restore-manner)
  (sb-posix:kill (process-number) sb-posix:sigquit))

;;; How large the window is.

(defun window-size ()
  (multiple-value-bind (rows columns) (rows-and-columns)
    (values (if (plusp columns) columns 80)
            (if (plusp rows) rows 24))))
