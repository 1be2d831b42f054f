;;;; csv.lisp -- a line of a table, with commas: the one door to cl-csv.

(in-package :ars-magna.experiment)

;;; A row is one line: texts have no line ends in them (see PLAIN-TEXT).

(define-condition broken-line (ars-magna-error)
  ((line :initarg :line :reader broken-line-text))
  (:report (lambda (condition stream)
             (format stream "No row of a table: ~A" (cut (broken-line-text condition) 200))))
  (:documentation "A line of a table cannot be taken apart."))

;; Most texts need no quotes, and most lines have none; these are put together and taken apart here,
;; in a tenth of the time.

(defun quotable-p (text)
  (declare (type simple-string text))
  (find-if (lambda (char) (member char '(#\, #\" #\Newline #\Return))) text))

(defun line-of (texts)
  (let ((line (make-string (loop for text in texts sum (1+ (length (the string text))))))
        (place 0))
    (declare (type fixnum place))
    (dolist (text texts line)
      (replace line (the string text) :start1 place)
      (incf place (length (the string text)))
      (setf (char line place) #\,)
      (incf place))))

(defun csv-line (texts)
  "Return TEXTS, strings, as a line of a table, with its end (RFC 4180, but for a plain newline)."
  (if (some #'quotable-p texts)
      (with-output-to-string (line)
        (cl-csv:write-csv-row texts :stream line :newline (string #\Newline)))
      (let ((line (line-of texts)))
        (setf (char line (1- (length line))) #\Newline)
        line)))

(defun texts-between-commas (line)
  (declare #.*hot* (type (simple-array character (*)) line))
  (loop with start = 0
        for comma = (position #\, line :start start)
        collect (subseq line start comma)
        while comma
        do (setf start (1+ comma))))

(defun csv-texts (line)
  "Return the texts in LINE, of a table. Signals BROKEN-LINE."
  (if (find #\" (the simple-string line))
      (handler-case (cl-csv:read-csv-row line)
        (error () (error 'broken-line :line line)))
      (texts-between-commas line)))
