;;;; streams.lisp -- streams on file descriptors of this process.

(in-package :ars-magna.host)

(export '(octet-input text-output descriptor-stream input-within-p))

(deftype descriptor-stream ()
  "A stream on a file, pipe or terminal of this process."
  (internal-name :sb-sys '#:fd-stream))

(defun octet-input (descriptor)
  "Return an input stream on the file DESCRIPTOR, each character of which stands for an octet."
  (internal (:sb-sys #:make-fd-stream) descriptor :input t :buffering :full
                                                  :external-format :latin-1))

(defun text-output (descriptor)
  "Return an output stream of UTF-8 on the file DESCRIPTOR."
  (internal (:sb-sys #:make-fd-stream) descriptor :output t :buffering :full
                                                  :external-format '(:utf-8 :replacement #\?)))

(defun input-within-p (stream seconds)
  "Wait until STREAM, on a descriptor, can be read or is at its end, for SECONDS at most. True if it
can, or is."
  (or (listen stream)
      (internal (:sb-sys #:wait-until-fd-usable)
                (internal (:sb-sys #:fd-stream-fd) stream) :input seconds)))
