;;;; formats.lisp -- lines of tables as RFC 4180 has them; texts within JSON, XML and HTML.

(in-package :ars-magna.basics)

(export '(csv-number-p csv-line csv-texts broken-line write-json-string write-xml-text *entities*))

;;; A row is one line: texts have no line ends in them (see PLAIN-TEXT). The library for this would
;;; take ten times as long, and loads half of Unicode to do so.

(define-condition broken-line (ars-magna-error)
  ((line :initarg :line :reader broken-line-text))
  (:report (lambda (condition stream)
             (format stream "No row of a table: ~A" (cut (broken-line-text condition) 200))))
  (:documentation "A line of a table cannot be taken apart."))

(setf (documentation 'broken-line-text 'function)
      "Return the line that cannot be taken apart.")

;;; Spreadsheets take what begins with = + - or @ for a formula, and carry it out. Such a text, if
;;; it is no number, has ' before it, which says that it is text; so has one that begins with a '
;;; already and would be mistaken for that. Reading takes it away.

(defun formula-p (text)
  "True if TEXT begins as a formula of a spreadsheet does, perhaps after some ' and no others."
  (declare (type simple-string text))
  (let ((first (find #\' text :test #'char/=)))
    (and first (find first "=+-@") t)))

(defun csv-number-p (text)
  "True if TEXT is a number as Lisp writes it: no name would be made of it."
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

(defun escaped (text)
  "Return TEXT as a spreadsheet is to see it."
  (if (and (formula-p text) (not (csv-number-p text)))
      (concatenate 'string "'" text)
      text))

(defun unescaped (text)
  "Return the text that ESCAPED made TEXT of."
  (declare (type simple-string text))
  (if (and (plusp (length text)) (char= #\' (char text 0)) (formula-p text))
      (subseq text 1)
      text))

;;; Writing.

(defun quoted (text)
  "Return TEXT as it stands in a line, in quotes if it needs some."
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
  "Return TEXTS, strings, as a line of a table, with its end."
  (let* ((texts (mapcar (lambda (text) (quoted (escaped text))) texts))
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

(defun texts-between-commas (line)
  (declare #.*hot* (type (simple-array character (*)) line))
  (loop with start = 0
        for comma = (position #\, line :start start)
        collect (subseq line start comma)
        while comma
        do (setf start (1+ comma))))

(defun end-of-quoted (line start)
  "Return where the text in quotes that begins in LINE at START ends. Signals BROKEN-LINE."
  (loop for quote = (position #\" line :start (1+ start))
          then (position #\" line :start (+ 2 quote))
        unless quote do (error 'broken-line :line line)
        unless (and (< (1+ quote) (length line)) (char= #\" (char line (1+ quote))))
          return (1+ quote)))

(defun without-doubles (text)
  "Return TEXT with one quote for each two."
  (with-output-to-string (out)
    (loop with i = 0
          while (< i (length text))
          do (write-char (char text i) out)
             (incf i (if (char= #\" (char text i)) 2 1)))))

(defun next-text (line start)
  "Return the text that begins in LINE at START, and where it ends. Signals BROKEN-LINE."
  (cond ((and (< start (length line)) (char= #\" (char line start)))
         (let ((end (end-of-quoted line start)))
           (values (without-doubles (subseq line (1+ start) (1- end))) end)))
        (t (let ((end (or (position #\, line :start start) (length line))))
             (when (find #\" line :start start :end end) (error 'broken-line :line line))
             (values (subseq line start end) end)))))

(defun texts-with-quotes (line)
  (loop with start = 0
        collect (multiple-value-bind (text end) (next-text line start)
                  (unless (or (= end (length line)) (char= #\, (char line end)))
                    (error 'broken-line :line line))
                  (setf start (1+ end))
                  text)
        while (<= start (length line))))

(defun csv-texts (line)
  "Return the texts in LINE, of a table. Signals BROKEN-LINE."
  ;; Most lines have no quotes, and are taken apart faster so.
  (let ((texts (if (find #\" (the simple-string line))
                   (texts-with-quotes line)
                   (texts-between-commas line))))
    (if (find #\' (the simple-string line)) (mapcar #'unescaped texts) texts)))

;;;; JSON, XML and HTML

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
