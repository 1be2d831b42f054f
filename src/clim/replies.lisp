;;;; replies.lisp -- waiting for what the X server says, in several threads of one connection.

(in-package :ars-magna.clim)

;;; A thread that waits for an answer of the X server, or for an event, first looks whether that has
;;; come. Then CLX lets it read, as the only thread, and wait until there is something. What came in
;;; between was read by the thread that had its turn before; then the new reader would wait for the
;;; next event, perhaps for ever: the picture would stand still until the mouse is moved. So it is
;;; made to look once more, now that nobody else reads.

(defvar *come-p* (constantly nil)
  "A function that says whether what the X server is read for, in this thread, has come.")

(defun read-for (read display timeout force-output-p come-p &rest arguments)
  "Do what READ, CLX's function, does with DISPLAY and the other arguments. What it reads for has
come when COME-P is true of ARGUMENTS."
  (let* ((*come-p* (lambda () (apply come-p arguments)))
         (end (apply read display timeout force-output-p come-p arguments)))
    (if (eq end :come) nil end)))

(defun wait-unless-come (wait display timeout)
  "Do what WAIT, CLX's function, does with DISPLAY and TIMEOUT, but return :COME if what is read for
has come."
  (if (funcall *come-p*) :come (funcall wait display timeout)))

(wrap-function (find-symbol "READ-INPUT" "XLIB") #'read-for)
(wrap-function (find-symbol "BUFFER-INPUT-WAIT" "XLIB") #'wait-unless-come)
