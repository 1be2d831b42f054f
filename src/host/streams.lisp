;;;; streams.lisp -- streams on file descriptors, the size of the terminal, where LOAD is.

(in-package :ars-magna.host)

(export '(octet-input text-output descriptor-stream input-within-p rows-and-columns char-width
          form-start line-reached line-of-next encapsulated-condition undecodable-format))

(deftype descriptor-stream ()
  "A stream on a file, pipe or terminal of this process."
  (internal-name :sb-sys '#:fd-stream))

(defun octet-input (descriptor)
  "Return an input stream on the file DESCRIPTOR, with one character for each octet."
  (internal (:sb-sys #:make-fd-stream) descriptor :input t :buffering :full
                                                  :external-format :latin-1))

(defun text-output (descriptor)
  "Return a UTF-8 output stream on the file DESCRIPTOR."
  (internal (:sb-sys #:make-fd-stream) descriptor :output t :buffering :full
                                                  :external-format '(:utf-8 :replacement #\?)))

(defun input-within-p (stream seconds)
  "Wait at most SECONDS until STREAM, on a descriptor, has input or is at its end. True if so."
  (or (listen stream)
      (internal (:sb-sys #:wait-until-fd-usable)
                (internal (:sb-sys #:fd-stream-fd) stream) :input seconds)))

;;;; The terminal

(defconstant +ask-for-size+ (if (uiop:featurep :linux) #x5413 #x40087468)
  "The system's request number for the size of a terminal window.")

(defun rows-and-columns ()
  "Return the rows and columns of the window of this process's terminal; zeros if not known."
  (sb-alien:with-alien ((size (array sb-alien:unsigned-short 4)))
    (setf (sb-alien:deref size 0) 0
          (sb-alien:deref size 1) 0)
    (sb-alien:alien-funcall
     (sb-alien:extern-alien "ioctl" (function sb-alien:int sb-alien:int sb-alien:unsigned-long
                                              (* (array sb-alien:unsigned-short 4))))
     1 +ask-for-size+ (sb-alien:addr size))
    (values (sb-alien:deref size 0) (sb-alien:deref size 1))))

(defun char-width (char)
  "Return the columns that CHAR takes on a terminal: 0 for accents, 2 for East Asian characters."
  (cond ((member (internal (:sb-unicode #:general-category) char) '(:mn :me :cf)) 0)
        ((member (internal (:sb-unicode #:east-asian-width) char) '(:w :f)) 2)
        (t 1)))

;;;; The position of LOAD in a file that it cannot read

(defun form-start (stream)
  "Return the position, in characters, of the form that LOAD reads from STREAM, or 0 if not even its
first character can be read; NIL for other streams."
  (and (internal-type-p stream :sb-int #:form-tracking-stream)
       (or (internal (:sb-int #:form-tracking-stream-form-start-char-pos) stream) 0)))

(defun line-of-next (stream)
  "Return the line of the character that LOAD reads next from STREAM, for which FORM-START is not
NIL."
  (car (internal (:sb-int #:line/col-from-charpos) stream)))

;; A word may end by the newline after it, which has been read by then.
(defun line-reached (stream)
  "Return the line of the last character that LOAD has read from STREAM, for which FORM-START is not
NIL."
  (destructuring-bind (line . column) (internal (:sb-int #:line/col-from-charpos) stream)
    (if (plusp column) line (max 1 (1- line)))))

(defun encapsulated-condition (condition)
  "Return the condition that CONDITION wraps to add a position, as LOAD's do; NIL for others."
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
