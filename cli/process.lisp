;;;; process.lisp -- this process: its arguments, standard streams and interrupts, and its end.

(in-package :ars-magna.cli)

(deftype user-interrupt ()
  "The condition that the user has pressed control C."
  'sb-sys:interactive-interrupt)

(defun process-arguments ()
  "Return the arguments that this process was started with, strings."
  (rest (uiop:raw-command-line-arguments)))

(defun standard-stream (descriptor direction)
  "Return a stream on the file DESCRIPTOR that no bytes can upset."
  (sb-sys:make-fd-stream descriptor direction t :buffering :full
                                    :external-format '(:utf-8 :replacement #\?)))

(defun end-process (status)
  "End this process with STATUS, at once: nothing is flushed and no thread is waited for."
  (uiop:quit status nil))
