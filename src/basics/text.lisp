;;;; text.lisp -- text on one line, wrapped, without control characters; how data are printed.

(in-package :ars-magna.basics)

(export '(blank-p one-line cut visible obeyed-p sentence wrapped-text call-printing-plainly
          printing-plainly printing-words print-named abridged safe-text unqualified-text
          text-as-typed +more+))

(defun blank-p (char)
  "True if CHAR is a space, newline or the like."
  (member char '(#\Space #\Tab #\Return #\Page #\Newline)))

(defun one-line (text)
  "Return TEXT with each run of blanks as one space."
  (string-trim " " (with-output-to-string (stream)
                     (loop for previous = #\Space then char
                           for char across text
                           for blank = (blank-p char)
                           unless (and blank (blank-p previous))
                             do (write-char (if blank #\Space char) stream)))))

(defun cut (text length)
  "Return TEXT, or its beginning if it is longer than LENGTH."
  (if (> (length text) length)
      (concatenate 'string (subseq text 0 (- length 3)) "...")
      text))

(defun sentence (text)
  "Return TEXT with a full stop, unless it ends in a question."
  (if (ends-with #\? text) text (format nil "~A." text)))

;;; Reports quote files and typed text, which may contain any character.

(defun obeyed-p (char)
  "True if CHAR controls a terminal or the direction of text, instead of being shown."
  (let ((code (char-code char)))
    (or (< code 32) (<= 127 code 159) (<= #x202A code #x202E) (<= #x2066 code #x2069))))

(defun visible (text)
  "Return TEXT with ^ and a letter, or a question mark, for each control character, except newlines
and tabs."
  (if (some #'obeyed-p text)
      (with-output-to-string (stream)
        (loop for char across text
              do (cond ((or (not (obeyed-p char)) (find char '(#\Newline #\Tab)))
                        (write-char char stream))
                       ((< (char-code char) 32)
                        (format stream "^~C" (code-char (+ 64 (char-code char)))))
                       (t (write-char #\? stream)))))
      text))

;;; Lines of limited length, broken between words.

(defun break-place (text width)
  "Return where the first line of TEXT, WIDTH characters at most, ends."
  (flet ((last-place (character)
           (position character text :end (1+ width) :from-end t :start 1)))
    (cond ((<= (length text) width) (length text))
          ((last-place #\Space))
          ((last-place #\No-break_space))
          (t width))))

(defun wrapped-text (text width)
  "Return TEXT, one line, as a list of at least one line of at most WIDTH characters. Lines break at
no-break spaces, which become spaces, only if there is no other space."
  (loop with blanks = '(#\Space #\No-break_space)
        with rest = (string-trim blanks text)
        for end = (break-place rest width)
        collect (substitute #\Space #\No-break_space (string-right-trim blanks (subseq rest 0 end)))
        do (setf rest (string-left-trim blanks (subseq rest end)))
        until (string= "" rest)))

;;;; Printing

;;; *PRINT-BASE* and the like are the user's settings for a REPL. Code that writes data, such as
;;; tables, pictures and JSON, must not depend on them.

(defun call-printing-plainly (function)
  "Call FUNCTION with the printer's variables as a fresh Lisp has them, but without pretty printing.
Return its values."
  (let ((*print-base* 10) (*print-radix* nil) (*print-case* :upcase) (*print-pretty* nil)
        (*print-readably* nil) (*print-escape* t) (*print-circle* nil) (*print-length* nil)
        (*print-level* nil) (*print-lines* nil) (*print-right-margin* nil) (*print-array* t)
        (*print-gensym* t) (*read-default-float-format* 'single-float))
    (funcall function)))

(defmacro printing-plainly (() &body body)
  "Run BODY, which writes data, as CALL-PRINTING-PLAINLY runs a function."
  (form-calling 'call-printing-plainly body))

(defun print-named (object stream name &optional (whole name))
  "Print OBJECT to STREAM: for PRINC as NAME, a symbol or string, else unreadably as WHOLE."
  (if (or *print-escape* *print-readably*)
      (print-unreadable-object (object stream) (princ whole stream))
      (princ name stream)))

;;; Texts for people need decimal numbers and complete lists, too.

(defmacro printing-words (() &body body)
  "Run BODY, which makes text for people, with the printer's variables that change numbers, names
and lists as a fresh Lisp has them."
  `(let ((*print-base* 10) (*print-radix* nil) (*print-case* :upcase) (*print-length* nil)
         (*print-level* nil) (*print-lines* nil) (*print-readably* nil) (*print-array* t))
     ,@body))

;;;; Data in messages

;;; A message quotes what is wrong. That may be circular, a thousand lists deep or megabytes long,
;;; and the message must still be readable.

(defconstant +most-parts+ 150 "The most conses of a datum that a message shows.")
(defconstant +most-characters+ 200 "The most characters of a text that a message shows.")

(defstruct (remark (:constructor make-remark (text)) (:copier nil))
  "TEXT in place of an omitted part of a datum."
  (text "" :type string :read-only t))

(defmethod print-object ((remark remark) stream)
  (write-string (remark-text remark) stream))

(defmethod make-load-form ((remark remark) &optional environment)
  (declare (ignore environment))
  `(make-remark ,(remark-text remark)))

(define-global +more+ (make-remark "...") "The mark for omitted elements.")

(defun abridged-atom (atom)
  (typecase atom
    (string (cut atom +most-characters+))
    (symbol (if (< +most-characters+ (length (symbol-name atom)))
                (make-remark (cut (symbol-name atom) +most-characters+))
                atom))
    (integer (if (< 500 (integer-length atom))
                 (make-remark (format nil "an integer of ~D bits" (integer-length atom)))
                 atom))
    (ratio (if (< 500 (+ (integer-length (numerator atom)) (integer-length (denominator atom))))
               (make-remark (format nil "a ratio near ~A" (ratio-size atom)))
               atom))
    (array (make-remark (format nil "an array of ~{~D~^ by ~}" (array-dimensions atom))))
    (t atom)))

(defun ratio-size (ratio)
  "Return RATIO as a float, or in words if it is too large or too small for one."
  (let ((bits (- (integer-length (numerator ratio)) (integer-length (denominator ratio)))))
    (cond ((< bits -1000) "0")
          ((< 1000 bits) (format nil "2^~D" bits))
          (t (double ratio)))))

(defun abridged (datum)
  "Return DATUM, or the beginning of a long or circular one, with dots for the rest."
  (let ((left +most-parts+))
    (labels ((visit (datum)
               (cond ((atom datum) (abridged-atom datum))
                     ((minusp (decf left)) +more+)
                     (t (list-from datum))))
             (list-from (conses)
               (loop for tail = conses then (cdr tail)
                     while (and (consp tail) (<= 0 left))
                     collect (visit (car tail)) into elements
                     do (decf left)
                     finally (return (nconc elements (rest-of tail)))))
             (rest-of (tail)
               (cond ((null tail) '())
                     ((consp tail) (list +more+))
                     (t (abridged-atom tail)))))
      (visit datum))))

(defun without-packages (datum)
  "Return DATUM, of ABRIDGED, with uninterned symbols of the same names."
  (typecase datum
    (cons (cons (without-packages (car datum))
                (and (cdr datum) (without-packages (cdr datum)))))
    (keyword datum)
    (symbol (make-symbol (symbol-name datum)))
    (t datum)))

(defun unqualified-text (datum)
  "Return DATUM, abridged, as it is printed, without package prefixes."
  (let ((*print-gensym* nil))
    (prin1-to-string (without-packages (abridged datum)))))

(defun text-as-typed (datum)
  "Return DATUM, such as a symbol, as typed in lower case, between bars if necessary."
  (let ((*print-case* :downcase)) (unqualified-text datum)))

(defun safe-text (object &key (escape t) (length 500))
  "Return OBJECT as printed by PRIN1, or by PRINC unless ESCAPE is true, without package prefixes,
in at most LENGTH characters. Deep, long and circular data are shown in part. If OBJECT cannot be
printed, the text says so."
  (handler-case
      (let ((*print-circle* t) (*print-pretty* nil) (*print-readably* nil) (*print-escape* escape)
            (*print-length* (or *print-length* 100))
            (*print-level* (or *print-level* 20))
            (*print-gensym* nil) (*print-base* 10) (*print-radix* nil))
        (cut (write-to-string (if (typep object '(or cons string bit-vector number symbol))
                                  (without-packages (abridged object))
                                  object))
             length))
    ((or error storage-condition) () "what cannot be printed")))
