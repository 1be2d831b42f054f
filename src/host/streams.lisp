;;;; streams.lisp -- streams on file descriptors, the size of the terminal, where LOAD is.

(in-package :ars-magna.host)

(export '(octet-input text-output descriptor-stream input-within-p rows-and-columns char-width
          form-start line-reached line-of-next encapsulated-condition undecodable-format))

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

;;;; The terminal

(defconstant +ask-for-size+ (if (uiop:featurep :linux) #x5413 #x40087468)
  "The number of the system's request for the size of a terminal's window.")

(defun rows-and-columns ()
  "Return how many rows and columns the window of this process's terminal has; zeros if the system
does not know."
  (sb-alien:with-alien ((size (array sb-alien:unsigned-short 4)))
    (setf (sb-alien:deref size 0) 0
          (sb-alien:deref size 1) 0)
    (sb-alien:alien-funcall
     (sb-alien:extern-alien "ioctl" (function sb-alien:int sb-alien:int sb-alien:unsigned-long
                                              (* (array sb-alien:unsigned-short 4))))
     1 +ask-for-size+ (sb-alien:addr size))
    (values (sb-alien:deref size 0) (sb-alien:deref size 1))))

(defun char-width (char)
  "Return how many columns of a terminal CHAR takes: 0 for accents, 2 for characters of East Asia."
  (cond ((member (internal (:sb-unicode #:general-category) char) '(:mn :me :cf)) 0)
        ((member (internal (:sb-unicode #:east-asian-width) char) '(:w :f)) 2)
        (t 1)))

;;;; Where LOAD is in a file when it cannot read on

(defun form-start (stream)
  "Return at which character the form begins that LOAD reads from STREAM, or 0 if not even its first
character can be read; NIL of other streams."
  (and (internal-type-p stream :sb-int #:form-tracking-stream)
       (or (internal (:sb-int #:form-tracking-stream-form-start-char-pos) stream) 0)))

(defun line-of-next (stream)
  "Return on which line the character is that LOAD reads next from STREAM, for which FORM-START is
not NIL."
  (car (internal (:sb-int #:line/col-from-charpos) stream)))

;; What ends a word may be the newline behind it, and has been read by then.
(defun line-reached (stream)
  "Return on which line the last character is that LOAD has read from STREAM, for which FORM-START
is not NIL."
  (destructuring-bind (line . column) (internal (:sb-int #:line/col-from-charpos) stream)
    (if (plusp column) line (max 1 (1- line)))))

(defun encapsulated-condition (condition)
  "Return the condition that CONDITION only gives a place to, as LOAD's do; NIL of others."
  (and (internal-type-p condition :sb-int #:encapsulated-condition)
       (internal (:sb-int #:encapsulated-condition) condition)))

(defun undecodable-format (condition)
  "Return the name, a string, of the external format in which a stream has bytes that are no text,
if that is what CONDITION says; else NIL."
  (when (internal-type-p condition :sb-int #:stream-decoding-error)
    (let ((format (if-internal (:sb-kernel #:character-coding-error-external-format)
                    (internal (:sb-kernel #:character-coding-error-external-format) condition)
                    :utf-8)))
      (string (first (ensure-list format))))))
