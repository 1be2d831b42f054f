;;;; process.lisp -- this process: its arguments, standard streams and signals, and its end.

(in-package :ars-magna.cli)

(defun process-arguments ()
  "Return the arguments that this process was started with, strings."
  (rest (uiop:raw-command-line-arguments)))

(defun end-process (status)
  "End this process with STATUS, at once: nothing is flushed and no thread is waited for."
  (call-allowing-exits (lambda () (uiop:quit status nil))))

;;; Streams.

(defun octet-input (descriptor)
  "Return an input stream on the file DESCRIPTOR, each character of which stands for an octet."
  (sb-sys:make-fd-stream descriptor :input t :buffering :full :external-format :latin-1))

(defun text-output (descriptor)
  "Return an output stream of UTF-8 on the file DESCRIPTOR."
  (sb-sys:make-fd-stream descriptor :output t :buffering :full
                                    :external-format '(:utf-8 :replacement #\?)))

(deftype descriptor-stream ()
  "A stream on a file, pipe or terminal of this process."
  'sb-sys:fd-stream)

(defun octets-within-p (stream seconds)
  "Wait until STREAM, a descriptor-stream, can be read or is at its end, for SECONDS at most. True
if so."
  (or (listen stream)
      (sb-sys:wait-until-fd-usable (sb-sys:fd-stream-fd stream) :input seconds)))

;;; Control C. It reaches this process's first thread, between any two of its instructions. So that
;;; it ends what the user wants to end and nothing else, the prompt holds it: see RUN-SESSION.

(deftype user-interrupt ()
  "The condition that the user has pressed control C."
  'sb-sys:interactive-interrupt)

(defun take-interrupt ()
  "Let the handlers of this thread end what it is at, or let it go on, by the restart GO-ON."
  (allowing-interrupts
    (with-simple-restart (go-on "Go on.")
      (error 'sb-sys:interactive-interrupt))))

(defun mind-interrupts ()
  "Let control C interrupt this thread, which is the process's first."
  (let ((thread (current-thread)))
    (sb-sys:enable-interrupt sb-unix:sigint
                             (lambda (signal info context)
                               (declare (ignore signal info context))
                               (interrupt-thread thread #'take-interrupt)))))

;;; Other signals. There are states in which no Lisp runs any more that would heed one, so the
;;; system itself ends the process. (With a terminal that goes away it does so anyway, unless it was
;;; told NOHUP.)

(defun die-of-termination ()
  "Let this process end at once when it is told to terminate."
  (sb-sys:enable-interrupt sb-unix:sigterm :default))

(defun die-of-interrupts ()
  "Let control C end this process at once, as when its memory is being saved."
  (sb-sys:enable-interrupt sb-unix:sigint :default))
