;;;; reading.lisp -- where LOAD is in a file when it cannot read on.

(in-package :ars-magna.host)

(export '(form-start line-reached line-of-next encapsulated-condition undecodable-format))

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
