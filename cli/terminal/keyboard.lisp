;;;; keyboard.lisp -- this process's terminal: in what manner it hands over keys, and its size.

(in-package :ars-magna.cli)

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
