;;;; yaml.lisp -- UNUSABLE-FLOOR, decimal numbers, and the subset of YAML that describes floors.

(in-package :ars-magna.floors)

(addition unusable-floor)

(define-condition unusable-floor (ars-magna-error)
  ((file   :initarg :file   :reader unusable-floor-file)
   (line   :initarg :line   :initform nil :reader unusable-floor-line)
   (reason :initarg :reason :reader unusable-floor-reason))
  (:report (lambda (condition stream)
             (format stream "~A~@[, line ~D~]: ~A."
                     (file-name-text (unusable-floor-file condition))
                     (unusable-floor-line condition)
                     (unusable-floor-reason condition))))
  (:documentation "IMPORT-MAP cannot read a file, or EXPORT-MAP cannot write a file."))

(setf (documentation 'unusable-floor-file 'function)
      "Return the file that an UNUSABLE-FLOOR error is about, a pathname or string."
      (documentation 'unusable-floor-line 'function)
      "Return the number of the line that an UNUSABLE-FLOOR error is about, or NIL."
      (documentation 'unusable-floor-reason 'function)
      "Return a text that says what is wrong with the file, and what to do about it.")

(defun reject-floor (file line control &rest arguments)
  "Signal UNUSABLE-FLOOR about LINE of FILE, or about FILE if LINE is NIL. The format string CONTROL
says what is wrong and names the remedy."
  (error 'unusable-floor :file file :line line :reason (apply #'format nil control arguments)))

(defun resolve-file-name (name)
  "Return the pathname for NAME, a string or pathname, which may begin with ~/. Signals
UNUSABLE-FLOOR for ~user."
  (when (and (stringp name) (starts-with-subseq "~" name) (not (starts-with-subseq "~/" name)))
    (reject-floor name nil "~~ is supported only in ~~/, your home directory; write the whole name ~
of the file"))
  (path-of-name name))

(defun check-readable (file)
  (let ((trouble (unusable-file-text file)))
    (when trouble
      (reject-floor file nil "~A (relative names begin in ~A)"
                    trouble (native-name (base-directory))))))

;;;; Decimals

(defconstant +longest-decimal+ 60 "The largest number of characters in a number.")
(defconstant +largest-exponent+ 330
  "The largest exponent of a number: no double-float has a larger exponent.")

(defun digits-end (text start)
  (or (position-if-not (lambda (char) (find char "0123456789")) text :start start)
      (length text)))

(defun sign-at (text start)
  "Return the sign at START in TEXT, 1 or -1, and its end. Without a sign, return 1 and START."
  (case (and (< start (length text)) (char text start))
    (#\+ (values 1 (1+ start)))
    (#\- (values -1 (1+ start)))
    (t (values 1 start))))

(defun parse-digits (text start end)
  (if (< start end) (parse-integer text :start start :end end) 0))

(defun exponent-at (text start)
  "Return the exponent in TEXT from START on, 0 if TEXT ends at START, or NIL if invalid."
  (cond ((= start (length text)) 0)
        ((char-equal #\e (char text start))
         (multiple-value-bind (sign digits) (sign-at text (1+ start))
           (when (and (< digits (length text)) (= (length text) (digits-end text digits)))
             (let ((size (parse-digits text digits (length text))))
               (and (<= size +largest-exponent+) (* sign size))))))))

(defun decimal-at (text start)
  "Return the exact value of the unsigned number in TEXT from START on, or NIL if there is none."
  (let* ((point (digits-end text start))
         (pointed (and (< point (length text)) (char= #\. (char text point))))
         (end (if pointed (digits-end text (1+ point)) point))
         (places (if pointed (- end point 1) 0))
         (exponent (exponent-at text end)))
    (when (and exponent (plusp (+ places (- point start))))
      (* (+ (parse-digits text start point)
            (/ (parse-digits text (1+ point) end) (expt 10 places)))
         (expt 10 exponent)))))

(defun read-decimal (text)
  "Return the exact value of the number TEXT, such as -12.5, .5 or 1e-2; NIL if TEXT is no number."
  (when (<= (length text) +longest-decimal+)
    (multiple-value-bind (sign start) (sign-at text 0)
      (let ((number (decimal-at text start)))
        (and number (* sign number))))))

(defun decimal-notation (number)
  "Return the shortest text from which READ-DECIMAL reads the double-float nearest to NUMBER."
  (let ((*read-default-float-format* 'double-float)
        (value (double number)))
    (if (and (= value (ftruncate value)) (< (abs value) 1d15))
        (format nil "~D.0" (truncate value))
        (prin1-to-string value))))

;;;; YAML

;;; This reads only the flat form of YAML that map savers write: lines `key: value', each key once.
;;; A value is a word, a text in quotes, or a list [a, b, c], which may also be below its key, with
;;; a dash before each item. Everything else in YAML is refused with the number of its line. Values
;;; are strings; nothing is evaluated.

(defstruct (entry (:constructor make-entry (key line value)) (:copier nil))
  "An entry of a YAML file: KEY on the line LINE, with VALUE, a string or a list of strings."
  (key "" :type string :read-only t)
  (line 1 :type (integer 1) :read-only t)
  (value "" :type (or string list)))

(defun find-entry (key entries)
  (find key entries :key #'entry-key :test #'string=))

(defun trim-blanks (text)
  (string-trim '(#\Space #\Tab #\Return) text))

(defun strip-comment (text)
  "Return TEXT without a comment. A comment begins at the start of TEXT or after a blank."
  (loop for start = (position #\# text) then (position #\# text :start (1+ start))
        while start
        when (or (zerop start) (blank-character-p (char text (1- start))))
          return (trim-blanks (subseq text 0 start))
        finally (return (trim-blanks text))))

(defun closing-quote-position (file line text)
  "Return the position of the closing quote of TEXT, which begins with a quote. In single quotes a
doubled quote, and in double quotes a quote after a backslash, belongs to the text."
  (loop with quote = (char text 0)
        for i from 1 below (length text)
        for char = (char text i)
        do (cond ((and (char= #\\ char) (char= #\" quote)) (incf i))
                 ((char/= char quote))
                 ((and (char= #\' quote) (< (1+ i) (length text)) (char= #\' (char text (1+ i))))
                  (incf i))
                 (t (return i)))
        finally (reject-floor file line "the closing quote is missing; add a ~C at the end" quote)))

(defun text-in-quotes (file line text end)
  "Return the text between the quotes of TEXT, whose closing quote is at END."
  (with-output-to-string (out)
    (loop with quote = (char text 0) and i = 1
          while (< i end)
          do (let ((char (char text i)))
               (when (or (and (char= #\' quote) (char= #\' char))
                         (and (char= #\" quote) (char= #\\ char)))
                 (setf char (char text (incf i)))
                 (unless (find char "'\"\\")
                   (reject-floor file line "\\~C in quotes is not supported; write the text in ~
                                            'single quotes', where a backslash stands for itself"
                                 char)))
               (write-char char out)
               (incf i)))))

(defun read-quoted-text (file line text)
  (let ((end (closing-quote-position file line text)))
    (unless (string= "" (strip-comment (concatenate 'string " " (subseq text (1+ end)))))
      (reject-floor file line "there is text after the closing quote; leave that text out"))
    (text-in-quotes file line text end)))

(defun read-yaml-list (file line text)
  (let ((text (strip-comment text)))
    (unless (eql (position #\] text) (1- (length text)))
      (reject-floor file line "a list must be complete on one line, with nothing after it, as in ~
                               [0.0, 0.0, 0.0]"))
    (mapcar #'trim-blanks (uiop:split-string (subseq text 1 (1- (length text))) :separator ","))))

(defun parse-yaml-value (file line text)
  "Return the value in TEXT, the rest of LINE of FILE: a string or a list of strings."
  (case (if (string= "" text) #\Space (char text 0))
    ((#\" #\') (read-quoted-text file line text))
    (#\[ (read-yaml-list file line text))
    ((#\& #\* #\! #\| #\> #\{ #\% #\@ #\`)
     (reject-floor file line "a value that begins with ~C is not supported; write a number, a name ~
                              of a file, or a list [a, b, c]"
                   (char text 0)))
    (t (strip-comment text))))

(defun key-end (text)
  "Return the position of the colon after the key at the beginning of TEXT, or NIL."
  (let ((end (position-if-not (lambda (char) (or (alphanumericp char) (find char "_-"))) text)))
    (and end
         (plusp end)
         (char= #\: (char text end))
         (or (= (1+ end) (length text)) (blank-character-p (char text (1+ end))))
         end)))

(defun read-entry (file line text entries)
  "Return the entry in TEXT, LINE of FILE. Signals UNUSABLE-FLOOR if ENTRIES have its key already."
  (let* ((end (key-end text)) (key (subseq text 0 end)) (other (find-entry key entries)))
    (unless end
      (reject-floor file line "~S must be a key at the left edge, a colon, a blank and a value, as ~
                               in resolution: 0.05"
                    (cut text 60)))
    (when other
      (reject-floor file line "~A is on line ~D already; leave one of the two lines out"
                    key (entry-line other)))
    (make-entry key line (parse-yaml-value file line (trim-blanks (subseq text (1+ end)))))))

(defun list-item-p (text)
  "True if TEXT is an item of a list that is written below its key."
  (let ((text (trim-blanks text)))
    (and (starts-with-subseq "-" text)
         (or (= 1 (length text)) (blank-character-p (char text 1))))))

(defun add-list-item (file line text entry)
  "Append the item in TEXT, which is LINE of FILE, to the list of ENTRY, the entry above the item."
  (unless (and entry (or (consp (entry-value entry)) (string= "" (entry-value entry))))
    (reject-floor file line "an item of a list has no key above it; write the list after its key, ~
                             as in origin: [0.0, 0.0, 0.0]"))
  (setf (entry-value entry)
        (append (and (consp (entry-value entry)) (entry-value entry))
                (list (strip-comment (trim-blanks (subseq (trim-blanks text) 1)))))))

(defun read-entries (file text)
  "Return the entries in TEXT, the content of FILE, in order. Signals UNUSABLE-FLOOR."
  (let ((entries '()))
    (loop for line from 1
          for whole in (uiop:split-string text :separator '(#\Newline))
          for text = (string-right-trim '(#\Return) whole)
          until (string= "..." (trim-blanks text))
          do (cond ((string= "" (strip-comment text)))
                   ((and (null entries) (string= "---" (strip-comment text))))
                   ((list-item-p text) (add-list-item file line text (first entries)))
                   (t (push (read-entry file line text entries) entries))))
    (nreverse entries)))
