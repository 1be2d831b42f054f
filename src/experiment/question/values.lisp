;;;; values.lisp -- which values a table may have, and how they are written.

(in-package :ars-magna.experiment)

(export '(number-from-text))

;;; R, pandas and sqlite must read numbers as numbers. So floats have no Lisp exponent marker,
;;; ratios become floats, booleans are TRUE or FALSE, and lists and vectors are JSON.

;;; Reader and printer.

(defun call-with-trial-syntax (function &optional (package *package*))
  "Call FUNCTION in PACKAGE, with the reader and printer variables that every trial has."
  (let ((*package* package) (*readtable* (global-value '*readtable*)) (*read-base* 10))
    (call-printing-plainly function)))

;;; Values.

(defconstant +longest-text+ 500
  "The maximum number of characters of a text in a table.")

(defun address-end (text start)
  "Return the end of the address at START in TEXT, as in #<HASH-TABLE {10042BD5D3}>, or NIL."
  (let ((end (and (char= #\{ (char text start))
                  (position #\} text :start start))))
    (and end (> end (+ 6 start))
         (every (lambda (char) (digit-char-p char 16)) (subseq text (1+ start) end))
         (1+ end))))

(defun without-addresses (text)
  (if (find #\{ text)
      (with-output-to-string (out)
        (loop with i = 0
              while (< i (length text))
              do (let ((end (address-end text i)))
                   (unless end (write-char (char text i) out))
                   (setf i (or end (1+ i))))))
      text))

(defun writable-char-p (char)
  "True if CHAR is visible and can be written to a file."
  (and (graphic-char-p char) (not (<= #xD800 (char-code char) #xDFFF))))

(defun plain-text (text)
  "Return TEXT on one line, cut to +LONGEST-TEXT+, with only visible characters and no addresses, so
that it is the same in each run."
  (cut (one-line (without-addresses (substitute-if-not #\Space #'writable-char-p text)))
       +longest-text+))

(defun float-text (number)
  "Return the shortest text that reads back as NUMBER, a finite float."
  (let ((*read-default-float-format* (type-of number)))
    (prin1-to-string number)))

(defun unquoted-text (object)
  "Return OBJECT, a symbol, string or character, in lower case, without package and quotes."
  (format nil "~(~A~)" (safe-text object :escape nil)))

(defun finite-value-p (value)
  (and (realp value) (finite-p value)))

(defun simple-table-value-p (value)
  (typecase value
    (number (finite-value-p value))
    ((or symbol string character) t)
    (cons (and (proper-list-p value) (every #'simple-table-value-p value)))))

(defun table-value-p (value)
  "True if VALUE may be in a table: a number, symbol, string, character, or a list of these."
  (and (tree-p value) (simple-table-value-p value)))

(defun measured-value-p (value)
  "True if VALUE may be the value of a measure: plain data, things and robots, as in run variables."
  (or (table-value-p value)
      (plain-datum-p value (lambda (object) (typep object '(or thing robot))))))

(defun integer-text (integer)
  (format nil "~D" integer))

(defun exact-number-text (number)
  (etypecase number
    (integer (integer-text number))
    (ratio (float-text (float number 1d0)))
    (float (float-text number))))

;; Programs that read tables can take JSON lists apart, but not Lisp lists. An empty list is NIL.
(defun json-text (value)
  (typecase value
    (boolean (if value "true" "false"))
    (number (exact-number-text value))
    ((or cons simple-vector)
     (format nil "[~{~A~^, ~}]" (cl:map 'list #'json-text value)))
    (string (json-string-text value))
    (t (json-string-text (unquoted-text value)))))

(defun json-string-text (text)
  (with-output-to-string (out) (write-json-string (plain-text text) out)))

(defun plain-value-text (value)
  (typecase value
    (number (exact-number-text value))
    ((or cons simple-vector) (plain-text (json-text value)))
    (string (plain-text value))
    (t (plain-text (unquoted-text value)))))

;; Forms of a trial may set the printer's variables.
(defun value-text (value)
  "Return the text of VALUE in tables. Reader and printer variables do not affect it."
  (case value
    ((t) "TRUE")
    ((nil) "FALSE")
    (:none "")
    (t (call-with-trial-syntax (lambda () (plain-value-text value))))))

(defun setting-text (value)
  "Return the text of VALUE, of a factor or knob, in tables: that of :NONE is not empty."
  (if (eq :none value) "none" (value-text value)))

;;; Robots. Names that differ only in their packages are written in full.

(defun names-in-value (value)
  (cond ((consp value) (append (names-in-value (car value)) (names-in-value (cdr value))))
        ((and value (symbolp value) (not (keywordp value))) (list value))))

(defun with-full-names (value all)
  "Return VALUE with the full name of each symbol in it that has the name of another symbol in ALL."
  (flet ((ambiguous-p (name)
           (some (lambda (other) (and (not (eq name other)) (same-name-p name other))) all)))
    (let ((names (remove-if-not #'ambiguous-p (names-in-value value))))
      (sublis (mapcar (lambda (name) (cons name (qualified-name name))) names) value))))

;;; Back from a table.

(defun number-from-text (text)
  "Return the number that TEXT, a cell of a table, represents, or NIL."
  (and (csv-number-p text)
       (notany (lambda (char) (find char "/dDfFsS")) text)
       (char/= #\+ (char text 0))
       ;; A symbol, such as e5, is no number.
       (let* ((*read-default-float-format* 'double-float) (*read-base* 10)
              (value (ignore-errors (values (read-from-string text)))))
         (and (realp value) value))))

(defun text-before-p (a b)
  (let ((number (number-from-text a)) (other (number-from-text b)))
    (cond ((and number other (/= number other)) (< number other))
          ((eq (null number) (null other)) (string< a b))
          (t number))))

(defun texts-before-p (a b)
  (loop for (text . nil) on a
        for (other . nil) on b
        do (cond ((text-before-p text other) (return t))
                 ((text-before-p other text) (return nil)))))
