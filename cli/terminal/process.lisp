;;;; process.lisp -- this process: its arguments, standard streams and signals, and its end.

(in-package :ars-magna.cli)

(defun process-arguments ()
  "Return the arguments that this process was started with, strings."
  (rest (uiop:raw-command-line-arguments)))

(defun end-process (status)
  "End this process with STATUS, at once: nothing is flushed and no thread is waited for."
  (restore-manner)
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

(defgeneric octets-within-p (stream seconds)
  (:documentation "Wait until STREAM can be read or is at its end, for SECONDS at most. True if it
can, or is.")
  (:method ((stream stream) seconds)
    (or (listen stream)
        (sb-sys:wait-until-fd-usable (sb-sys:fd-stream-fd stream) :input seconds))))

(defun say-on-error-output (text)
  "Write TEXT to the error output, whatever state streams are in, as a line that says who says so."
  (ignore-errors
   (let ((output (text-output 2)))
     (format output "ars-magna: ~A~%" text)
     (finish-output output))))

;;; Control C. It reaches this process's first thread, between any two of its instructions. So that
;;; it ends what the user wants to end and nothing else, the prompt holds it: see RUN-SESSION.

(deftype user-interrupt ()
  "The condition that the user has pressed control C."
  'sb-sys:interactive-interrupt)

(defvar *interrupts-while-ending* nil
  "How often control C has come since one began to end this process; NIL while none has.")

(defconstant +patience-of-users+ 3
  "How often control C may come while this process ends before it ends at once.")

(defun end-interrupted ()
  "End this process at once, as control C wants."
  (say-on-error-output "stopped.")
  (end-process 130))

(defun heed-interrupt ()
  "Let the handlers of this thread end what it is at, or let it go on, by the restart GO-ON."
  (allowing-interrupts
    (with-simple-restart (go-on "Go on.")
      (error 'sb-sys:interactive-interrupt))))

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
  "Let this process end at once when it is told to terminate, as by control \\."
  (sb-sys:enable-interrupt sb-unix:sigterm :default)
  (sb-sys:enable-interrupt sb-unix:sigquit :default))

(defun die-of-interrupts ()
  "Let control C end this process at once, as when its memory is being saved."
  (sb-sys:enable-interrupt sb-unix:sigint :default))
