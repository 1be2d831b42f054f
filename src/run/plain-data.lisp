;;;; plain-data.lisp -- writing and reading lists, numbers, strings and names as text.

(in-package :ars-magna.run)

(export '(tree-p))

;;; A bare name is a keyword, NIL or T; other symbols are written between bars, with their package.
;;; In strings and between bars, a backslash begins the code of a character, in hexadecimal, up to a
;;; semicolon; so each datum is one line. The Lisp reader only gets numbers. Reading interns
;;; nothing: a name without a symbol becomes an uninterned one.
;;;
;;; Saved runs have two extensions: @7 is the object with the number 7, and a list may end in
;;; ". tail". Unknown keywords are interned there.

(defconstant +deepest-nesting+ 200 "The deepest nesting of lists.")
(defconstant +max-datum-conses+ 100000 "The most conses of a datum.")
(defconstant +longest-number+ 1000 "The most characters of a number.")

(defun tree-p (datum)
  "True if DATUM has no cycles and does not exceed +MAX-DATUM-CONSES+ and +DEEPEST-NESTING+."
  (let ((left +max-datum-conses+))
    (labels ((visit (datum depth)
               (loop while (consp datum)
                     do (when (or (minusp (decf left)) (> depth +deepest-nesting+))
                          (return-from tree-p nil))
                        (visit (pop datum) (1+ depth)))))
      (visit datum 1)
      t)))

(defun short-text (object)
  "Return the printed form of OBJECT, shortened if it is long or circular."
  (let* ((*print-length* 8) (*print-level* 4) (*print-circle* nil)
         (text (if (and (integerp object) (< 1000 (integer-length object)))
                   (format nil "an integer of ~D bits" (integer-length object))
                   (princ-to-string object))))
    (subseq text 0 (min 80 (length text)))))

;;; Writing.

(defun unprintable-atom-p (atom)
  (typecase atom
    (string nil)
    (symbol (and (symbol-package atom) (search "::" (package-name (symbol-package atom)))))
    (rational (< (* 3 +longest-number+)
                 (+ (integer-length (numerator atom)) (integer-length (denominator atom)))))
    (float (not (finite-p atom)))
    (t t)))

(defun unprintable-part (tree)
  (cond ((atom tree) (and (unprintable-atom-p tree) tree))
        ((proper-list-p tree) (some #'unprintable-part tree))
        (t tree)))

(defun unprintable-in (datum)
  "Return a part of DATUM whose printed form could not be read again, or NIL."
  (if (tree-p datum) (unprintable-part datum) datum))

(defun ascii-digit-p (char)
  (char<= #\0 char #\9))

(defun bare-name-p (name)
  "True if a keyword with the name NAME, a string, can be written without bars."
  (and (plusp (length name))
       (char<= #\A (char name 0) #\Z)
       (every (lambda (char)
                (or (char<= #\A char #\Z) (ascii-digit-p char) (find char "-*+/<>=!?")))
              name)
       (not (member name '("NIL" "T") :test #'string=))))

(defun plain-char-p (char)
  "True if CHAR, not a quote, can be written in a string as it is, without a character code."
  (let ((code (char-code char)))
    (not (or (< code 32) (<= 127 code 159) (<= #xD800 code #xDFFF) (char= char #\\)))))

(defun write-quoted (text quote stream)
  (write-char quote stream)
  (loop for char across text
        do (if (and (plain-char-p char) (char/= char quote))
               (write-char char stream)
               (format stream "\\~X;" (char-code char))))
  (write-char quote stream))

(defun write-symbol (symbol stream)
  (let ((name (symbol-name symbol)) (package (symbol-package symbol)))
    (cond ((null symbol) (write-string "nil" stream))
          ((eq t symbol) (write-string "t" stream))
          ((and (keywordp symbol) (bare-name-p name)) (write-string (string-downcase name) stream))
          (t (write-quoted (concatenate 'string (if package (package-name package) "") "::" name)
                           #\| stream)))))

(defun write-datum (datum stream)
  (typecase datum
    (symbol (write-symbol datum stream))
    (string (write-quoted datum #\" stream))
    (cons (write-char #\( stream)
     (loop for (element . more) on datum
           do (write-datum element stream)
              (when more (write-char #\Space stream)))
     (write-char #\) stream))
    (t (prin1 datum stream))))

(defmacro with-plain-syntax (&body body)
  "Run BODY, which prints and reads numbers, in standard syntax, whatever the user's settings are."
  `(with-standard-io-syntax
     (let ((*read-default-float-format* 'double-float) (*read-eval* nil) (*print-readably* nil))
       ,@body)))

(defun datum-text (datum)
  "Return DATUM, which has no unprintable part, as a text that READ-DATUM can read."
  (with-plain-syntax
    (with-output-to-string (out) (write-datum datum out))))

;;; Numbers.

(defun skip-digits (word start)
  (or (position-if-not #'ascii-digit-p word :start start) (length word)))

(defun skip-sign (word start)
  (if (and (< start (length word)) (find (char word start) "+-")) (1+ start) start))

(defun digits-p (word start)
  "True if WORD has only digits from START to its end, and at least one digit."
  (and (< start (length word)) (= (length word) (skip-digits word start))))

(defun exponent-p (word start)
  "True if the part of WORD that begins at START is a float's exponent of at most six characters."
  (and (find (char word start) "desfDESF")
       (< (- (length word) start) 7)
       (digits-p word (skip-sign word (1+ start)))))

(defun fraction-p (word start)
  (let ((end (skip-digits word start)))
    (and (< start end)
         (or (= end (length word)) (exponent-p word end)))))

(defun number-text-p (word)
  (let* ((start (skip-sign word 0)) (end (skip-digits word start)))
    (and (< start end)
         (or (= end (length word))
             (case (char word end)
               (#\/ (digits-p word (1+ end)))
               (#\. (fraction-p word (1+ end))))))))

(defun short-integer-p (word)
  "True if WORD, a number, is an integer that fits into a machine word."
  (and (< (length word) 18)
       (= (length word) (skip-digits word (skip-sign word 0)))))

(defun read-number (word)
  (when (< +longest-number+ (length word))
    (error "a number has ~D characters, which is too long" (length word)))
  (if (short-integer-p word)
      (parse-integer word)
      (handler-case (with-plain-syntax (values (read-from-string word)))
        (error () (error "Lisp cannot represent the number ~A" word)))))

;;; Reading. Each function returns what it has read in TEXT from START on, and its end position.

(defun char-at (text position)
  (if (< position (length text))
      (char text position)
      (error "the text ends too early")))

(defun read-coded-char (text start)
  (let* ((end (position #\; text :start start))
         (code (and end
                    (< 1 (- end start) 8)
                    (parse-integer text :start (1+ start) :end end :radix 16 :junk-allowed t))))
    (unless (and code (<= 0 code (1- char-code-limit)))
      (error "a backslash is in a wrong place"))
    (values (code-char code) (1+ end))))

(defun read-quoted (text start)
  (let ((position (1+ start)))
    (values (with-output-to-string (out)
              (loop for char = (char-at text position)
                    until (char= char (char text start))
                    do (multiple-value-bind (char end)
                           (if (char= char #\\)
                               (read-coded-char text position)
                               (values char (1+ position)))
                         (write-char char out)
                         (setf position end))))
            (1+ position))))

(defvar *uninterned-symbols* (make-hash-table :test 'equal)
  "A hash table from texts to the uninterned symbols that were made for them.")

(defun uninterned-symbol (text name)
  "Return the uninterned symbol NAME for TEXT from *UNINTERNED-SYMBOLS*, the same each time."
  (or (gethash text *uninterned-symbols*)
      (setf (gethash text *uninterned-symbols*) (make-symbol name))))

(defun find-or-make-symbol (text)
  "Return the symbol that TEXT, PACKAGE::NAME, names, or an uninterned symbol if none exists."
  (let* ((colons (or (search "::" text) (error "a name has no package")))
         (package (find-package (subseq text 0 colons)))
         (name (subseq text (+ 2 colons))))
    (or (and package (find-symbol name package))
        (uninterned-symbol text name))))

(defvar *numbered-objects* nil
  "A vector of the objects that @1, @2 and so on refer to, from index 1 on; or NIL.")

(defun numbered-object (word)
  "Return the object that WORD, such as @7, refers to."
  (let ((number (and (< 1 (length word) 12)
                     (digits-p word 1)
                     (parse-integer word :start 1))))
    (if (and number (< 0 number (length *numbered-objects*)))
        (aref *numbered-objects* number)
        (error "no object has the number ~A" (subseq word 1 (min 40 (length word)))))))

(defun find-or-make-keyword (name word)
  "Return the keyword NAME, written as WORD, or an uninterned symbol if none exists."
  (cond ((find-symbol name :keyword))
        (*numbered-objects* (make-keyword name))
        (t (uninterned-symbol word name))))

(defun word-value (word)
  "Return the number, NIL, T, keyword or numbered object that WORD stands for."
  (cond ((number-text-p word) (read-number word))
        ((string= word "nil") nil)
        ((string= word "t") t)
        ((and *numbered-objects* (char= #\@ (char word 0))) (numbered-object word))
        ((bare-name-p (string-upcase word)) (find-or-make-keyword (string-upcase word) word))
        (t (error "~S is neither a number nor a name"
                  (subseq word 0 (min 40 (length word)))))))

(defun read-word (text start)
  (let ((end (or (position-if (lambda (char) (find char " ()\"|")) text :start start)
                 (length text))))
    (when (= start end) (error "the character ~A is in a wrong place" (char-at text start)))
    (values (word-value (subseq text start end)) end)))

(defun tail-follows-p (text position)
  "True if TEXT has a dot and the tail of a dotted list at POSITION."
  (and *numbered-objects*
       (char= #\. (char text position))
       (char= #\Space (char-at text (1+ position)))))

(defun read-tail (text start depth)
  "Return the tail of a dotted list, which begins at START in TEXT, and the position after it."
  (multiple-value-bind (tail end) (read-datum text start depth)
    (unless (char= #\) (char-at text end)) (error "a dotted list has something after its tail"))
    (values tail end)))

(defun read-list (text start depth)
  (when (> depth +deepest-nesting+)
    (error "its lists are nested more than ~D deep" +deepest-nesting+))
  (let ((position (1+ start)) (elements '()) (tail nil))
    (loop for char = (char-at text position)
          until (char= char #\))
          do (cond ((char= char #\Space) (incf position))
                   ((tail-follows-p text position)
                    (setf (values tail position) (read-tail text (+ 2 position) depth)))
                   (t (multiple-value-bind (datum end) (read-datum text position depth)
                        (push datum elements)
                        (setf position end)))))
    (values (nreconc elements tail) (1+ position))))

(defun read-datum (text &optional (start 0) (depth 0))
  "Return the datum that begins at START in TEXT, and the position after it. Errors say why."
  (case (char-at text start)
    (#\( (read-list text start (1+ depth)))
    (#\" (read-quoted text start))
    (#\| (multiple-value-bind (name end) (read-quoted text start)
           (values (find-or-make-symbol name) end)))
    (t (read-word text start))))
