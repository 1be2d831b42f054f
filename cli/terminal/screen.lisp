;;;; screen.lisp -- a screen of its own on a console, as for WATCH.

(in-package :ars-magna.cli)

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
      (put-string string console stream))
    (finish-output stream)))

(defun call-with-screen (function console)
  "Call FUNCTION while CONSOLE, on a terminal that hands over keys, shows a screen that is written
over by WRITE-AT-ONCE and OVER-SCREEN. What others write meanwhile comes afterwards."
  (call-holding-interrupts
   (lambda ()
     (begin-screen console)
     (unwind-protect (call-open-to-interrupts function)
       (end-screen console)))))
