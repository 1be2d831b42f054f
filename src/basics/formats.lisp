;;;; formats.lisp -- CSV lines (RFC 4180); texts in JSON, XML and HTML.

(in-package :ars-magna.basics)

(export '(csv-number-p csv-line csv-fields broken-line write-json-string write-xml-text *entities*))

;;; A row is one line: texts have no line ends (see PLAIN-TEXT). A CSV library would be ten times
;;; slower and loads half of Unicode.

(define-condition broken-line (ars-magna-error)
  ((line :initarg :line :reader broken-line-text))
  (:report (lambda (condition stream)
             (format stream "The quotes in this line of a CSV table are wrong: ~A"
                     (cut (broken-line-text condition) 200))))
  (:documentation "A line of a CSV table cannot be parsed."))

(setf (documentation 'broken-line-text 'function)
      "Return the line that cannot be parsed.")

;;; Spreadsheets execute what begins with = + - or @ as a formula. Such a text, unless it is a
;;; number, gets a ' before it, which marks it as text. So does a text that begins with ' and would
;;; be taken for a marked one. Reading removes the mark.

(defun formula-p (text)
  "True if TEXT begins like a spreadsheet formula, perhaps after one or more quotes (')."
  (declare (type simple-string text))
  (let ((first (find #\' text :test #'char/=)))
    (and first (find first "=+-@") t)))

(defun csv-number-p (text)
  "True if TEXT is a number as Lisp prints it, so that TEXT cannot be a name."
  (declare (type simple-string text))
  (let ((place 0) (length (length text)))
    (declare (type fixnum place))
    (flet ((skip-one (chars)
             (when (and (< place length) (find (char text place) (the simple-string chars)))
               (incf place)))
           (skip-digits ()
             (setf place (or (position-if-not #'digit-char-p text :start place) length))))
      (declare (inline skip-one))
      (and (plusp length)
           (digit-char-p (char text (1- length)))
           ;; An exponent alone is a name.
           (progn (skip-one "+-") (find (char text place) "0123456789."))
           (progn (skip-digits)
                  (when (skip-one "./") (skip-digits))
                  (when (skip-one "esfdESFD") (skip-one "+-") (skip-digits))
                  (= place length))))))

(defun mark-formula (text)
  "Return TEXT, preceded by a quote (') if a spreadsheet would execute TEXT as a formula."
  (if (and (formula-p text) (not (csv-number-p text)))
      (concatenate 'string "'" text)
      text))

(defun unmark-formula (text)
  (declare (type simple-string text))
  (if (and (plusp (length text)) (char= #\' (char text 0)) (formula-p text))
      (subseq text 1)
      text))

;;; Writing.

(defun quote-csv-field (text)
  (declare (type simple-string text))
  (if (find-if (lambda (char) (member char '(#\, #\" #\Newline #\Return))) text)
      (with-output-to-string (out)
        (write-char #\" out)
        (loop for char across text
              do (when (char= #\" char) (write-char #\" out))
                 (write-char char out))
        (write-char #\" out))
      text))

(defun csv-line (texts)
  "Return a CSV line, with its newline, of the strings TEXTS."
  (let* ((texts (mapcar (lambda (text) (quote-csv-field (mark-formula text))) texts))
         (line (make-string (loop for text in texts sum (1+ (length (the string text))))))
         (place 0))
    (declare (type fixnum place))
    (dolist (text texts)
      (replace line (the string text) :start1 place)
      (incf place (length (the string text)))
      (setf (char line place) #\,)
      (incf place))
    (setf (char line (1- (length line))) #\Newline)
    line))

;;; Reading.

(defun fields-between-commas (line)
  (declare #.*hot* (type (simple-array character (*)) line))
  (loop with start = 0
        for comma = (position #\, line :start start)
        collect (subseq line start comma)
        while comma
        do (setf start (1+ comma))))

(defun end-of-quoted-field (line start)
  "Return the end position of the quoted field that begins in LINE at START. Signals BROKEN-LINE."
  (loop for quote = (position #\" line :start (1+ start))
          then (position #\" line :start (+ 2 quote))
        unless quote do (error 'broken-line :line line)
        unless (and (< (1+ quote) (length line)) (char= #\" (char line (1+ quote))))
          return (1+ quote)))

(defun undouble-quotes (text)
  (with-output-to-string (out)
    (loop with i = 0
          while (< i (length text))
          do (write-char (char text i) out)
             (incf i (if (char= #\" (char text i)) 2 1)))))

(defun next-field (line start)
  "Return the field that begins in LINE at START, and its end position. Signals BROKEN-LINE."
  (cond ((and (< start (length line)) (char= #\" (char line start)))
         (let ((end (end-of-quoted-field line start)))
           (values (undouble-quotes (subseq line (1+ start) (1- end))) end)))
        (t (let ((end (or (position #\, line :start start) (length line))))
             (when (find #\" line :start start :end end) (error 'broken-line :line line))
             (values (subseq line start end) end)))))

(defun fields-with-quotes (line)
  (loop with start = 0
        collect (multiple-value-bind (text end) (next-field line start)
                  (unless (or (= end (length line)) (char= #\, (char line end)))
                    (error 'broken-line :line line))
                  (setf start (1+ end))
                  text)
        while (<= start (length line))))

(defun csv-fields (line)
  "Return a list of the fields of LINE, a line of a CSV table. Signals BROKEN-LINE."
  ;; Most lines have no quotes, and are split faster this way.
  (let ((texts (if (find #\" (the simple-string line))
                   (fields-with-quotes line)
                   (fields-between-commas line))))
    (if (find #\' (the simple-string line)) (mapcar #'unmark-formula texts) texts)))

;;;; JSON, XML and HTML

(defun write-json-string (text stream &key in-page)
  "Write TEXT to STREAM as a JSON string, valid in JavaScript too. If IN-PAGE is true, escape TEXT
so that it cannot end the script element of its web page."
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
  "The entities of XML and HTML for their special characters.")

(defun write-xml-text (text stream)
  "Write TEXT to STREAM escaped for XML and HTML, between tags or in double-quoted attributes."
  (loop for char across text
        for entity = (cdr (assoc char *entities*))
        do (if entity (write-string entity stream) (write-char char stream))))
