;;;; markup.lisp -- texts as strings of JSON, and within XML and HTML.

(in-package :ars-magna.basics)

(export '(write-json-string write-xml-text *entities*))

(defun write-json-string (text stream &key in-page)
  "Write TEXT to STREAM as a string of JSON, which JavaScript reads too. If IN-PAGE, nothing in it
can end the script of a page that it stands in."
  (write-char #\" stream)
  (loop for char across text
        for code = (char-code char)
        do (cond ((find char "\"\\") (format stream "\\~C" char))
                 ((or (< code 32) (<= #xD800 code #xDFFF) (and in-page (char= char #\<)))
                  (format stream "\\u~4,'0X" code))
                 (t (write-char char stream))))
  (write-char #\" stream))

(defparameter *entities*
  '((#\& . "&amp;") (#\< . "&lt;") (#\> . "&gt;") (#\" . "&quot;"))
  "What XML and HTML write for the characters that they take for their own.")

(defun write-xml-text (text stream)
  "Write TEXT to STREAM as it stands in XML and HTML, between tags or in an attribute's double
quotes."
  (loop for char across text
        for entity = (cdr (assoc char *entities*))
        do (if entity (write-string entity stream) (write-char char stream))))
