;;;; text.lisp -- text on one line, wrapped, without control characters; comparing names.

(in-package :ars-magna.basics)

(export '(blank-character-p one-line cut escape-controls control-character-p add-full-stop
                            wrapped-text
          call-printing-plainly printing-plainly printing-text print-named abridged safe-text
          unqualified-text text-as-typed +more+ same-name-p nearest-name misspelling-p value-equal
          name-string qualified-name name-before-p))

(defun blank-character-p (char)
  "True if CHAR is a space, newline or the like."
  (member char '(#\Space #\Tab #\Return #\Page #\Newline)))

(defun one-line (text)
  "Return TEXT with each run of blanks as one space."
  (string-trim " " (with-output-to-string (stream)
                     (loop for previous = #\Space then char
                           for char across text
                           for blank = (blank-character-p char)
                           unless (and blank (blank-character-p previous))
                             do (write-char (if blank #\Space char) stream)))))

(defun cut (text length)
  "Return TEXT. If TEXT is longer than LENGTH, return its beginning, with three dots."
  (if (> (length text) length)
      (concatenate 'string (subseq text 0 (- length 3)) "...")
      text))

(defun add-full-stop (text)
  "Return TEXT with a full stop, unless TEXT ends with a question mark."
  (if (ends-with #\? text) text (format nil "~A." text)))

;;; Reports quote files and typed text, which may contain any character.

(defun control-character-p (char)
  "True if CHAR is not shown, but controls a terminal or the direction of text."
  (let ((code (char-code char)))
    (or (< code 32) (<= 127 code 159) (<= #x202A code #x202E) (<= #x2066 code #x2069))))

(defun escape-controls (text)
  "Return TEXT. Replace control characters, except newlines and tabs, by ^ and a letter, or by ?."
  (if (some #'control-character-p text)
      (with-output-to-string (stream)
        (loop for char across text
              do (cond ((or (not (control-character-p char)) (find char '(#\Newline #\Tab)))
                        (write-char char stream))
                       ((< (char-code char) 32)
                        (format stream "^~C" (code-char (+ 64 (char-code char)))))
                       (t (write-char #\? stream)))))
      text))

;;; Lines of limited length, broken between words.

(defun line-end-position (text width)
  "Return the position at which to break TEXT after a first line of at most WIDTH characters."
  (flet ((last-place (character)
           (position character text :end (1+ width) :from-end t :start 1)))
    (cond ((<= (length text) width) (length text))
          ((last-place #\Space))
          ((last-place #\No-break_space))
          (t width))))

(defun wrapped-text (text width)
  "Wrap TEXT, a single line. Return a list of lines of at most WIDTH characters. Lines break at
no-break spaces only if they have no other space. No-break spaces become spaces."
  (loop with blanks = '(#\Space #\No-break_space)
        with rest = (string-trim blanks text)
        for end = (line-end-position rest width)
        collect (substitute #\Space #\No-break_space (string-right-trim blanks (subseq rest 0 end)))
        do (setf rest (string-left-trim blanks (subseq rest end)))
        until (string= "" rest)))

;;;; Printing

;;; *PRINT-BASE* and the like are the user's settings for a REPL. Code that writes data, such as
;;; tables, pictures and JSON, must not depend on them.

(defun call-printing-plainly (function)
  "Return the values of FUNCTION, called with the printer's defaults, but without pretty printing."
  (let ((*print-base* 10) (*print-radix* nil) (*print-case* :upcase) (*print-pretty* nil)
        (*print-readably* nil) (*print-escape* t) (*print-circle* nil) (*print-length* nil)
        (*print-level* nil) (*print-lines* nil) (*print-right-margin* nil) (*print-array* t)
        (*print-gensym* t) (*read-default-float-format* 'single-float))
    (funcall function)))

(defmacro printing-plainly (() &body body)
  "Run BODY, which writes data, with the printer's variables as in CALL-PRINTING-PLAINLY."
  (form-calling 'call-printing-plainly body))

(defun print-named (object stream name &optional (whole name))
  "Print OBJECT to STREAM: for PRINC as NAME, a symbol or string; otherwise as #<WHOLE>."
  (if (or *print-escape* *print-readably*)
      (print-unreadable-object (object stream) (princ whole stream))
      (princ name stream)))

;;; Texts for people need decimal numbers and complete lists, too.

(defmacro printing-text (() &body body)
  "Run BODY, which makes text for people, with the printer's defaults for numbers, names and lists."
  `(let ((*print-base* 10) (*print-radix* nil) (*print-case* :upcase) (*print-length* nil)
         (*print-level* nil) (*print-lines* nil) (*print-readably* nil) (*print-array* t))
     ,@body))

;;;; Data in messages

;;; A message quotes readably what is wrong, even if circular, very deep or megabytes long.

(defconstant +shown-cons-limit+ 150 "The largest number of conses of a datum that a message shows.")
(defconstant +shown-character-limit+ 200 "The largest number of characters of a text in a message.")

(defstruct (omission (:constructor make-omission (text)) (:copier nil))
  "The TEXT that replaces an omitted part of a datum."
  (text "" :type string :read-only t))

(defmethod print-object ((remark omission) stream)
  (write-string (omission-text remark) stream))

(defmethod make-load-form ((remark omission) &optional environment)
  (declare (ignore environment))
  `(make-omission ,(omission-text remark)))

(define-global +more+ (make-omission "...") "The mark for omitted elements.")

(defun abridged-atom (atom)
  (typecase atom
    (string (cut atom +shown-character-limit+))
    (symbol (if (< +shown-character-limit+ (length (symbol-name atom)))
                (make-omission (cut (symbol-name atom) +shown-character-limit+))
                atom))
    (integer (if (< 500 (integer-length atom))
                 (make-omission (format nil "an integer of ~D bits" (integer-length atom)))
                 atom))
    (ratio (if (< 500 (+ (integer-length (numerator atom)) (integer-length (denominator atom))))
               (make-omission (format nil "a ratio near ~A" (approximate-ratio atom)))
               atom))
    (array (make-omission (format nil "an array of ~{~D~^ by ~}" (array-dimensions atom))))
    (t atom)))

(defun approximate-ratio (ratio)
  "Return RATIO as a float, or as a text if RATIO is too large or too small for a float."
  (let ((bits (- (integer-length (numerator ratio)) (integer-length (denominator ratio)))))
    (cond ((< bits -1000) "0")
          ((< 1000 bits) (format nil "2^~D" bits))
          (t (double ratio)))))

(defun short-vector-p (datum)
  "True if DATUM is a simple vector of at most ten numbers, symbols, characters and strings."
  (and (simple-vector-p datum)
       (<= (length datum) 10)
       (every (lambda (element) (typep element '(or number symbol character string))) datum)))

(defun abridged (datum)
  "Return DATUM; if DATUM is long or circular, return its beginning, with dots for the rest."
  (let ((left +shown-cons-limit+))
    (labels ((visit (datum)
               (cond ((short-vector-p datum) (map 'simple-vector #'abridged-atom datum))
                     ((atom datum) (abridged-atom datum))
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
  "Return DATUM, a value of ABRIDGED, with each symbol replaced by an uninterned namesake."
  (typecase datum
    (cons (cons (without-packages (car datum))
                (and (cdr datum) (without-packages (cdr datum)))))
    (simple-vector (map 'simple-vector #'without-packages datum))
    (keyword datum)
    (symbol (make-symbol (symbol-name datum)))
    (t datum)))

(defun unqualified-text (datum)
  "Return the printed form of DATUM, abridged, without package prefixes."
  (let ((*print-gensym* nil))
    (prin1-to-string (without-packages (abridged datum)))))

(defun text-as-typed (datum)
  "Return DATUM, such as a symbol, as text to type: in lower case, with bars (|) if necessary."
  (let ((*print-case* :downcase)) (unqualified-text datum)))

(defun safe-text (object &key (escape t) (length 500))
  "Return OBJECT as printed by PRIN1 (PRINC if not ESCAPE), without package prefixes, in at most
LENGTH characters. Deep, long and circular data are abridged. If printing fails, the text says so."
  (handler-case
      (let ((*print-circle* t) (*print-pretty* nil) (*print-readably* nil) (*print-escape* escape)
            (*print-length* (or *print-length* 100))
            (*print-level* (or *print-level* 20))
            (*print-gensym* nil) (*print-base* 10) (*print-radix* nil))
        (cut (write-to-string (if (typep object '(or cons string bit-vector number symbol))
                                  (without-packages (abridged object))
                                  object))
             length))
    ((or error storage-condition) () "an object that cannot be printed")))

;;;; Names

;;; The manual compares attribute values, place types, substances, maps and manipulations by name:
;;; `red' read in the user's package is the `red' of the definition.

(defun name-string (name)
  "Return NAME, a symbol or string, as a string in upper case."
  (string-upcase (string name)))

(defun qualified-name (symbol)
  "Return a string that names SYMBOL with its package, for FIND-ROBOT and similar functions."
  (format nil "~@[~A::~]~A" (and (symbol-package symbol) (package-name (symbol-package symbol)))
          (symbol-name symbol)))

(defun %same-name-p (a b)
  "True if the symbols or strings A and B have the same name, regardless of package and case."
  (declare #.*hot*)
  (let ((a (if (symbolp a) (symbol-name a) (string a)))
        (b (if (symbolp b) (symbol-name b) (string b))))
    (and (= (length a) (length b))
         ;; Names such as BOX-1 and BOX-2 differ at their ends.
         (or (not (typep a '(simple-array character 1)))
             (not (typep b '(simple-array character 1)))
             (zerop (length a))
             (let ((last (1- (length a)))) (char-equal (schar a last) (schar b last))))
         (string-equal a b))))

(declaim (inline same-name-p))
(defun same-name-p (a b)
  "True if the symbols or strings A and B have the same name, regardless of package and case."
  (or (eq a b) (%same-name-p a b)))

(defun value-equal (a b)
  "True if A and B are equal attribute values; symbols are compared by name (reading 38)."
  (cond ((eq a b) t)
        ((and (symbolp a) (symbolp b)) (and a b (same-name-p a b)))
        ((and (numberp a) (numberp b)) (= a b))
        ((and (stringp a) (stringp b)) (string= a b))
        ((and (consp a) (consp b))
         (and (value-equal (car a) (car b)) (value-equal (cdr a) (cdr b))))
        ((and (simple-vector-p a) (simple-vector-p b))
         (and (= (length a) (length b)) (every #'value-equal a b)))))

(defun edit-distance (a b)
  "Return how many insertions, deletions, replacements and swaps of neighbours turn A into B."
  (let ((rows (make-array (list (1+ (length a)) (1+ (length b))))))
    (dotimes (i (1+ (length a)) (aref rows (length a) (length b)))
      (dotimes (j (1+ (length b)))
        (setf (aref rows i j)
              (if (or (zerop i) (zerop j))
                  (+ i j)
                  (min (1+ (aref rows (1- i) j))
                       (1+ (aref rows i (1- j)))
                       (if (char-equal (char a (1- i)) (char b (1- j)))
                           (aref rows (1- i) (1- j))
                           (1+ (aref rows (1- i) (1- j))))
                       (if (swapped-letters-p a i b j)
                           (1+ (aref rows (- i 2) (- j 2)))
                           (+ i j)))))))))

(defun swapped-letters-p (a i b j)
  "True if the two characters before I in A are the two before J in B, in reverse order."
  (and (< 1 i) (< 1 j)
       (char-equal (char a (- i 1)) (char b (- j 2)))
       (char-equal (char a (- i 2)) (char b (- j 1)))))

(defun nearest-name (name names)
  "Return the name in NAMES most like NAME; NIL if none is similar or NAME has over 100 characters."
  (let ((names (and (<= (length (string name)) 100) names))
        (best nil)
        (least (max 2 (floor (length (string name)) 2))))
    (dolist (candidate names best)
      (let ((distance (edit-distance (string name) (string candidate))))
        (when (< distance least)
          (setf best candidate least distance))))))

(defparameter *similar-letters* '("AEIOUY" "CKQ" "CSZ" "FVW" "GJ")
  "Groups of letters that may sound alike.")

(defun similar-letters-p (letter other)
  "True if the characters LETTER and OTHER are equal or may sound alike."
  (or (char-equal letter other)
      (some (lambda (letters)
              (and (find letter letters :test #'char-equal)
                   (find other letters :test #'char-equal)))
            *similar-letters*)))

(defun distinct-short-words-p (a b)
  "True if A and B are short names of equal length with one different letter, and the two letters
do not sound alike. (SISE may be a misspelling of SIZE, but SIDE is another word.)"
  (and (= (length a) (length b))
       (< (length a) 6)
       (= 1 (count nil (map 'list #'char-equal a b)))
       (notevery #'similar-letters-p a b)))

(defun misspelling-p (a b)
  "True if the name A may be a misspelling of the different name B. They differ by one letter, or by
two if both are long. In short names, and at the beginning, the two letters must sound alike."
  (let* ((a (string a)) (b (string b)) (shorter (min (length a) (length b))))
    (and (plusp shorter)
         (<= (abs (- (length a) (length b))) 2)
         (or (similar-letters-p (char a 0) (char b 0))
             (and (/= (length a) (length b)) (<= 3 shorter)))
         (<= 1 (edit-distance a b) (if (<= 8 shorter) 2 1))
         (not (distinct-short-words-p a b)))))

;;; Natural order of names: box 2 before box 10.

(defun first-name-part (text start)
  "Return the number at START in TEXT, or else the character there, and the position after it."
  (let ((end (or (position-if-not #'digit-char-p text :start start) (length text))))
    (if (> end start)
        (values (parse-integer text :start start :end end) end)
        (values (char text start) (1+ start)))))

(defun name-part-before-p (one other)
  "True if ONE, a number or character, sorts before OTHER. Numbers sort before characters."
  (cond ((and (numberp one) (numberp other)) (< one other))
        ((and (characterp one) (characterp other)) (char< one other))
        (t (numberp one))))

(defun name-before-p (a b)
  "True if the string A sorts before the string B. Numbers in the strings are compared by value."
  (loop with at-a = 0 and at-b = 0
        do (cond ((= at-b (length b)) (return nil))
                 ((= at-a (length a)) (return t)))
           (multiple-value-bind (part-a next-a) (first-name-part a at-a)
             (multiple-value-bind (part-b next-b) (first-name-part b at-b)
               (unless (eql part-a part-b) (return (name-part-before-p part-a part-b)))
               (setf at-a next-a at-b next-b)))))
