;;;; completing.lisp -- Tab: completions of a line that is being typed.

(in-package :ars-magna.cli)

(defvar *completer* nil
  "NIL, or a function that completes text. It gets a text and a cursor position. It returns the
start of the part to complete, a list of completions, and what to add after a single completion.")

(defun common-start (texts)
  "Return the longest common beginning of TEXTS, ignoring case."
  (let ((first (first texts)))
    (subseq first 0 (reduce #'min (rest texts)
                            :key (lambda (text)
                                   (or (mismatch first text :test #'char-equal) (length text)))
                            :initial-value (length first)))))

;;; Listing.

(defun name-without-directory (text)
  (let ((slash (position #\/ text :from-end t :end (max 0 (1- (length text))))))
    (if slash (subseq text (1+ slash)) text)))

(defun lines-in-columns (texts width)
  "Return TEXTS as a list of lines of at most WIDTH characters, in columns to be read downwards."
  (let* ((column (+ 2 (reduce #'max texts :key #'length)))
         (count (max 1 (floor width column)))
         (height (ceiling (length texts) count)))
    (loop for row below height
          collect (string-right-trim " " (format nil "~{~VA~}"
                                                 (loop for text in (nthcdr row texts)
                                                       for i from 0
                                                       when (zerop (mod i height))
                                                         append (list column text)))))))

(defun list-choices (stream texts)
  "Show TEXTS above the typed line, as many as fit into the window."
  (multiple-value-bind (width height) (funcall (console-window (edited-console stream)))
    (let* ((lines (lines-in-columns (mapcar #'name-without-directory texts) (1- width)))
           (room (max 1 (- height 4))))
      (write-on-fresh-line (format nil
                                   "~{~A~%~}~:[~;There are more completions. Type more letters.~%~]"
                                   (subseq lines 0 (min room (length lines))) (< room
                                                                                 (length lines)))
                           (edited-console stream))
      (finish-output (edited-console stream)))))

;;; Completing.

(defun replace-typed (stream start string)
  (let ((line (drawn-line-of stream)))
    (multiple-value-call #'replace-line-text stream
      (insert-in-text string
                      (uiop:strcat (subseq (drawn-line-text line) 0 start)
                                   (subseq (drawn-line-text line) (drawn-line-point line)))
                      start))))

(defun complete-typed-part (stream start texts after)
  "Replace the part of the line from START to the cursor by the longest common beginning of TEXTS,
followed by AFTER if there is one text. If that adds nothing to the line, list TEXTS."
  (let ((typed (subseq (text-being-typed stream) start (drawn-line-point (drawn-line-of stream))))
        (common (common-start texts)))
    (cond ((null (rest texts))
           (replace-typed stream start
                          (if (uiop:string-suffix-p common "/")
                              common
                              (uiop:strcat common after))))
          ((< (length typed) (length common)) (replace-typed stream start common))
          ;; The same list is not shown twice if nothing was typed since.
          ((not (equal texts (edited-listed stream)))
           (list-choices stream texts)
           (setf (edited-listed stream) texts)))))

(define-key *action-keys* (:tab) (stream)
  "Complete the word before the cursor."
  (let ((line (drawn-line-of stream)))
    (when (and *completer* (not *before-program-reads*))
      (multiple-value-bind (start texts after)
          (funcall *completer* (drawn-line-text line) (drawn-line-point line))
        (when texts (complete-typed-part stream start texts after))))))

;;;; What there is

;;; The first word is the name of a command; each other word has the type of its argument; inside
;;; parentheses are symbols, in quotes file names. Senseless parts are not completed.

(defun text-of-choice (choice)
  (typecase choice
    (string choice)
    (keyword (format nil "~(~S~)" choice))
    (symbol (string-downcase choice))
    (t (princ-to-string choice))))

(defun matching-texts (typed choices)
  "Return the sorted texts of the CHOICES that begin with TYPED, ignoring case."
  (flet ((begins-p (text) (starts-with-subseq typed text :test #'char-equal)))
    (remove-duplicates (stable-sort (remove-if-not #'begins-p (mapcar #'text-of-choice choices))
                                    #'string<)
                       :test #'string=)))

;;; Parts of Lisp.

(defun token-char-p (char)
  (not (or (blank-character-p char) (find char "()'`,\";|#"))))

(defun token-start (text point)
  (let ((before (position-if-not #'token-char-p text :end point :from-end t)))
    (if before (1+ before) 0)))

(defun open-quote-position (text point)
  (loop with start = nil
        for position from 0 below point
        do (case (char text position)
             (#\\ (incf position))
             (#\" (setf start (if start nil position))))
        finally (return start)))

(defun operator-at (text point)
  "Return the operator, a symbol, of the innermost form around POINT, or NIL."
  (loop with depth = 0
        for position from (1- point) downto 0
        do (case (char text position)
             (#\) (incf depth))
             (#\( (when (minusp (decf depth))
                    (let* ((start (1+ position))
                           (end (position-if-not #'token-char-p text :start start)))
                      (return (and end
                                   (find-symbol (string-upcase (subseq text start end)))))))))))

;;; What descriptors are made of.

(defun attribute-keys ()
  (mapcar #'attribute-name (all-attributes)))

(defun last-attribute (text point)
  (let* ((colon (position #\: text :end point :from-end t))
         (end (and colon (position-if-not #'token-char-p text :start colon :end point))))
    (and end
         (find (subseq text (1+ colon) end) (attribute-keys) :test #'string-equal))))

(defun values-of-attribute (key)
  "Return the values that the attribute named KEY declares. Return NIL if there are none or no KEY."
  (and key (attribute-domain (declared-attribute key))))

;;; Lisp.

(defun keywords-of (operator)
  (loop for type in (and operator (fboundp operator) (function-argument-types operator))
        when (and (consp type) (keywordp (first type)))
          collect (first type)))

(defun exported-names (package)
  (let ((names '()))
    (do-external-symbols (symbol package names) (push (string-downcase symbol) names))))

(defun meaningful-symbols ()
  "Return the current package's symbols, except its own that name no variable or function."
  (let ((symbols '()))
    (do-symbols (symbol *package* symbols)
      (when (or (symbol-defined-p symbol) (not (eq *package* (symbol-package symbol))))
        (push symbol symbols)))))

(defun symbol-choices (typed operator-p operator)
  "Return a list of symbols that may complete TYPED. If OPERATOR-P is true, return only names of
functions and macros. If TYPED begins with a colon, return keywords of OPERATOR and attributes."
  (let* ((colon (position #\: typed))
         (package (and colon (plusp colon)
                       (find-package (string-upcase (subseq typed 0 colon))))))
    (cond (package
           (loop with prefix = (subseq typed 0 (1+ (position #\: typed :from-end t)))
                 for name in (exported-names package)
                 collect (uiop:strcat prefix name)))
          (colon (append (keywords-of operator) (attribute-keys)))
          (operator-p (remove-if-not #'fboundp (meaningful-symbols)))
          (t (meaningful-symbols)))))

(defun lisp-completions (session text point)
  (let ((quote (open-quote-position text point)))
    (if quote
        (let ((typed (subseq text (1+ quote) point)))
          (values (1+ quote) (matching-texts typed (argument-choices :file session typed)) "\""))
        (let* ((start (token-start text point))
               (typed (subseq text start point))
               (operator-p (and (plusp start) (char= #\( (char text (1- start))))))
          (values start
                  (and (string/= "" typed)
                       (or (matching-texts typed (values-of-attribute (last-attribute text start)))
                           (matching-texts typed (symbol-choices typed operator-p
                                                                 (operator-at text start)))))
                  "")))))

(defun specification-completions (text point)
  "Complete a symbol in a descriptor specification, such as ((:color (red blue)))."
  (let* ((start (token-start text point))
         (typed (subseq text start point))
         (key (last-attribute text start)))
    (values start
            (matching-texts typed (if (or (null key) (starts-with-subseq ":" typed))
                                      (attribute-keys)
                                      (values-of-attribute key)))
            "")))

;;; Arguments.

(defun unit-end (text position)
  "Return the end of the unit, such as deg, at POSITION in TEXT. Return POSITION if there is no
unit, or if the unit is still being typed."
  (let ((end (nth-value 1 (unit-after text position))))
    (if (and end (< end (length text))) end position)))

(defun argument-end (parameter text start)
  "Return the end of PARAMETER's argument in TEXT at START; NIL if the argument may be incomplete."
  (let ((end (typecase (line-parameter-type parameter)
               (rest-type nil)
               (keyword (token-end text start))
               (t (let ((*read-suppress* t))
                    (handler-case (nth-value 1 (read-data-from-string text start))
                      (error () nil)))))))
    (cond ((or (null end) (= end (length text))) nil)
          ((dimension-of (line-parameter-type parameter)) (unit-end text end))
          (t end))))

(defun argument-at-end (line text start)
  "Return three values: the parameter of LINE whose argument is being typed at the end of TEXT, or
NIL if LINE has no more parameters; the start of that argument; and the previous parameter. START is
where the first argument begins."
  (loop for before = nil then parameter
        for parameter in (append (line-parameters line) '(nil))
        for position = (or (position-if-not #'blank-character-p text :start start) (length text))
        for end = (and parameter (< position (length text)) (argument-end parameter text position))
        unless end
          return (values parameter position before)
        do (setf start end)))

(defun unit-choices (parameter text start)
  (let ((dimension (and parameter
                        (< start (length text))
                        (dimension-of (line-parameter-type parameter)))))
    (and dimension
         (digit-char-p (char text
                             (position-if-not #'blank-character-p text :end start :from-end t)))
         (unit-names dimension))))

(defun argument-completion-values (start texts quoted-p)
  "Return the values of COMPLETIONS-IN for an argument at START with the completions TEXTS. Quote
them if QUOTED-P is true (the argument begins with a double quote) or one of TEXTS has a blank."
  (if (or quoted-p (some (lambda (text) (some #'blank-character-p text)) texts))
      (values start (mapcar (lambda (text) (uiop:strcat "\"" text)) texts) "\" ")
      (values start texts " ")))

(defun argument-completions (session line text start)
  "Complete the argument of LINE at the end of TEXT. START is where the first argument begins."
  (multiple-value-bind (parameter start before) (argument-at-end line text start)
    (let ((type (and parameter (type-keyword (line-parameter-type parameter)))))
      (case type
        (:line (line-completions session text start))
        (:form (lisp-completions session text (length text)))
        ((:map-words :plot) (word-completions text (argument-choices type session text)))
        (:specification (specification-completions text (length text)))
        (t (let* ((typed (subseq text start))
                  (quoted-p (starts-with-subseq "\"" typed))
                  (begun (if quoted-p (subseq typed 1) typed)))
             (argument-completion-values
              start
              (matching-texts begun (append (unit-choices before text start)
                                            (and type (argument-choices type session begun))))
              quoted-p)))))))

(defun word-completions (text words)
  (let ((start (1+ (or (position-if #'blank-character-p text :from-end t) -1))))
    (argument-completion-values start (matching-texts (subseq text start) words) nil)))

(defun line-completions (session text start)
  (let* ((start (or (position-if-not #'blank-character-p text :start start) (length text)))
         (end (if (< start (length text)) (first-word-end text start) start))
         (typed (subseq text start end)))
    (cond ((starts-with-subseq "(" typed) (lisp-completions session text (length text)))
          ((= end (length text))
           (values start (matching-texts typed (argument-choices :command session typed)) " "))
          (t (let ((line (find-line-command (split-first-word (expand-alias (format nil "~A "
                                                                                    typed))))))
               (argument-completions session line text end))))))

(defun completions-in (session text point)
  "Complete TEXT, typed in SESSION, at the position POINT. Return the start of the part to complete,
a list of all completions, and the text to add after a single completion."
  (let* ((text (subseq text 0 point))
         (break-request (first (session-other-breaks session))))
    (handler-case
        (cond ((starts-with-subseq "(" (string-left-trim " " text))
               (lisp-completions session text point))
              (break-request
               (values 0
                       (matching-texts
                        text (append '("backtrace" "quit")
                                     (mapcar #'restart-name
                                             (break-request-restarts break-request))))
                       ""))
              (t (line-completions session text 0)))
      (ars-magna-error () nil))))
