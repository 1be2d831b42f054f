;;;; sources.lisp -- where in a file a definition is, for its errors and for reading it again.

(in-package :ars-magna.definitions)

(export '(source-of-current-form source-file word-count-in-file part-in-file-p skip-comment
          line-of-clause form-digest file-digest same-printed-form-p))

;;; A source is a list (file digest): the file of a definition, and a number for its contents then.
;;; NIL stands for a typed definition. Compiled files keep sources, so they are plain lists.

(defun source-of-current-form ()
  "Return the source of the form that is being compiled or loaded, or NIL."
  (let ((file (if (edited-file)
                  (native-path (edited-file))
                  (or *compile-file-truename* *load-truename*))))
    (when (and file (not (equalp "fasl" (pathname-type file))) (probe-file file))
      (ignore-errors (list (native-name (probe-file file)) (file-digest file))))))

(defun source-file (source)
  "Return the native name of the file of SOURCE, a string, or NIL."
  (first source))

;;; A map has thousands of clauses, each of which may be looked up, so the last result is cached.

(defun call-caching (function cell &rest keys)
  "Return the value of FUNCTION, cached as by CACHING. The element of CELL, a list (value key...),
belongs to the last call; it is replaced, never modified."
  (destructuring-bind (&optional value &rest last-keys) (first cell)
    (if (and last-keys
             (every (lambda (key last)
                      (or (eql key last)
                          (and (stringp key) (stringp last) (string= key last))))
                    keys last-keys))
        value
        (first (setf (first cell) (cons (funcall function) keys))))))

(defmacro caching ((&rest keys) &body body)
  "Return the value of BODY or, if KEYS are the same as in the last call, the value of that call."
  (apply #'form-calling 'call-caching body '(load-time-value (list '())) keys))

;;; Finding a form in a text.

(defmacro with-form-reader ((text) &body body)
  "Run BODY, in which (READ-WORDS position) returns the form in TEXT at the position, and its end."
  (with-gensyms (words)
    ;; Other packages are found by the local nicknames of the current one.
    `(let ((,words (make-package (gensym "WORDS") :use '())))
       (unwind-protect
            (flet ((read-words (position)
                     (let ((*package* ,words) (*read-eval* nil))
                       (ignore-errors (read-from-string ,text nil nil :start position)))))
              (copy-nicknames *package* ,words)
              ,@body)
         (delete-package ,words)))))

(defun same-printed-form-p (a b)
  "True if the forms A and B look the same, regardless of the packages of their symbols."
  (cond ((and (symbolp a) (symbolp b)) (string= a b))
        ((and (consp a) (consp b))
         (and (same-printed-form-p (car a) (car b)) (same-printed-form-p (cdr a) (cdr b))))
        ((and (realp a) (realp b)) (= a b))
        ((and (arrayp a) (arrayp b)) (equalp a b))
        (t (or (eql a b)
               (and (typep a 'structure-object) (eq (type-of a) (type-of b)))))))

(defun skip-quoted (text start)
  "Return the end position of the string or |symbol| that begins in TEXT at START."
  (loop with quote = (char text start)
        for i from (1+ start) below (length text)
        for char = (char text i)
        when (char= char #\\) do (incf i)
        when (char= char quote) return (1+ i)
        finally (return (length text))))

(defun skip-block-comment (text start)
  "Return the end of the block comment, perhaps nested, that begins in TEXT at START."
  (loop with depth = 0
        for i from start below (1- (length text))
        do (cond ((string= "#|" text :start2 i :end2 (+ i 2)) (incf depth) (incf i))
                 ((string= "|#" text :start2 i :end2 (+ i 2))
                  (incf i)
                  (when (zerop (decf depth)) (return (1+ i)))))
        finally (return (length text))))

(defun starts-at-p (prefix text i)
  (let ((end (+ i (length prefix))))
    (and (<= end (length text))
         (string= prefix text :start2 i :end2 end))))

(defun skip-comment (text i)
  "Return the end position of the comment that begins in TEXT at I; NIL if no comment begins there."
  (cond ((char= #\; (char text i)) (or (position #\Newline text :start i) (length text)))
        ((starts-at-p "#|" text i) (skip-block-comment text i))))

(defun skip-non-code (text i)
  "Return the end of the comment, string or escaped character that begins in TEXT at I; else NIL."
  (cond ((skip-comment text i))
        ((find (char text i) "\"|") (skip-quoted text i))
        ((starts-at-p "#\\" text i) (+ i 3))
        ((char= #\\ (char text i)) (+ i 2))))

(defun open-paren-positions (text start end)
  (let ((positions '()) (i start))
    (loop while (< i end)
          do (when (char= #\( (char text i)) (push i positions))
             (setf i (or (skip-non-code text i) (1+ i))))
    (nreverse positions)))

(defun word-at-p (text position word)
  "True if TEXT has WORD at POSITION, perhaps after a package prefix."
  (let ((end (position-if (lambda (char) (find char '(#\Space #\Tab #\Newline #\Return)))
                          text :start position))
        (length (length (string word))))
    (and end
         (<= (+ position length) end)
         (string-equal word text :start2 (- end length) :end2 end))))

(defun find-definitions-in-text (text form)
  (destructuring-bind (operator &optional name &rest clauses) form
    (declare (ignore clauses))
    (with-form-reader (text)
      (loop for position in (open-paren-positions text 0 (length text))
            when (word-at-p text (1+ position) operator)
              append (multiple-value-bind (found end) (read-words position)
                       (when (and (consp found) (symbolp (first found)) (consp (rest found))
                                  (same-name-p (first found) operator)
                                  (same-printed-form-p (second found) name))
                         (list (list position end (same-printed-form-p found form)))))))))

(defun definition-positions (text form)
  "Return a list (start end equal-p) for each form in TEXT that has the operator and name of FORM.
EQUAL-P is true if the form equals FORM."
  (caching (text form) (find-definitions-in-text text form)))

(defun choose-definition-position (positions ordinal)
  "Return an element of POSITIONS, a value of DEFINITION-POSITIONS, and its number: the element
whose form is unchanged; else number ORDINAL; else the first."
  (let ((number (or (position-if #'third positions)
                    (and ordinal (< ordinal (length positions)) ordinal)
                    0)))
    (values (nth number positions) number)))

(defun forms-in (text start end)
  "Return conses (position . form) for the parenthesized forms in TEXT between START and END."
  (with-form-reader (text)
    (loop for position in (open-paren-positions text start end)
          collect (cons position (read-words position)))))

(defvar *form-position-cache* '(())
  "A cache, a cons: the list that FORM-POSITION has searched last, and the tail of this list that
begins with the form found. The cons is replaced, never modified.")

;; Forms are mostly looked up in order.
(defun form-position (text form start end)
  "Return a position of FORM, a list, in TEXT between START and END, or NIL. If FORM occurs more
than once, prefer the first position after that of the last search."
  (let ((forms (caching (text start end) (forms-in text start end))))
    (flet ((look (from)
             (let ((tail (member form from :key #'cdr :test #'same-printed-form-p)))
               (when tail (setf *form-position-cache* (cons forms tail)))
               (car (first tail)))))
      (or (and (eq forms (car *form-position-cache*)) (look (cdr *form-position-cache*)))
          (look forms)))))

(defun word-position (text form start end)
  "Return the position of FORM, or of its first element, in TEXT from START to END; or NIL."
  (let ((word (if (consp form) (first form) form)))
    (and word
         (or (symbolp word) (realp word))
         (search (if (and (symbolp word) (not (keywordp word)))
                     (symbol-name word)
                     (prin1-to-string word))
                 text :start2 start :end2 end :test #'char-equal))))

(defun line-number (text position)
  (1+ (count #\Newline text :end position)))

(defun cached-file-text (file)
  "Return the FILE-TEXT of FILE, a native name, cached until the file or the write date changes."
  (let ((path (native-path file)))
    (caching (file (file-write-date path)) (file-text path))))

(defun line-of-clause (text form clause)
  "Return two values for CLAUSE, a part of the definition FORM: its line number in TEXT, and the
ordinal of FORM among the definitions with the same operator and name. If CLAUSE is not found,
return the line of the definition, or NIL."
  (let ((positions (and form (definition-positions text form))))
    (multiple-value-bind (place number) (choose-definition-position positions nil)
      (destructuring-bind (&optional (start 0) (end (length text)) same) place
        (declare (ignore same))
        (let ((position (or (and (consp clause) (form-position text clause start end))
                            (and place (or (word-position text clause (1+ start) end) start)))))
          (values (and position (line-number text position))
                  (and place number)))))))

(defun clause-line-in-file (file form clause)
  (ignore-errors (line-of-clause (cached-file-text file) form clause)))

(defun word-count-in-file (word file)
  "Return how often WORD occurs in FILE and its comments, ignoring case; NIL if FILE is unreadable."
  (ignore-errors
    (loop with text = (cached-file-text file)
          for start = (search word text :test #'char-equal)
            then (search word text :test #'char-equal :start2 (1+ start))
          while start count t)))

(defun part-in-file-p (file form part)
  "True if a form now in FILE has the operator and name of FORM, and contains PART, a list."
  (ignore-errors
    (let ((text (read-file-into-string (native-path file))))
      (loop for (start end) in (definition-positions text form)
              thereis (form-position text part start end)))))

(defun read-definition-again (file form ordinal)
  "Return the definition FORM as it now is in FILE. FORM is number ORDINAL among the definitions
with its operator and name. Signals MISUSE if it is not found."
  (let* ((text (read-file-into-string (native-path file)))
         (place (choose-definition-position (definition-positions text form) ordinal)))
    (unless place
      (reject-use "~A has no readable (~(~A ~A~) ...). Add one." file (first form) (second form)))
    (values (read-from-string text t nil :start (first place)))))

;;; Digests of texts and forms.

(defun paren-p (char)
  (find char "()"))

(defun code-without-comments (text)
  "Return TEXT without comments and blanks, but with one space between words."
  (with-output-to-string (stream)
    (let ((i 0) (last #\() (blank nil))
      (loop while (< i (length text))
            do (let* ((char (char text i))
                      (code (not (or (blank-character-p char) (skip-comment text i))))
                      (end (or (skip-non-code text i) (1+ i))))
                 (when code
                   (unless (or (not blank) (paren-p last) (paren-p char))
                     (write-char #\Space stream))
                   (write-string text stream :start i :end (min end (length text)))
                   (setf last char))
                 (setf blank (not code) i end))))))

(defun form-end (text start)
  (loop with depth = 0 and i = start
        while (< i (length text))
        do (let ((skipped (skip-non-code text i)))
             (cond (skipped (setf i skipped))
                   (t (case (char text i)
                        (#\( (incf depth))
                        (#\) (when (<= (decf depth) 0) (return (1+ i)))))
                      (incf i))))
        finally (return (length text))))

(defun code-without-forms (operator text)
  "Return TEXT, a value of CODE-WITHOUT-COMMENTS, without the top-level forms of OPERATOR."
  (with-output-to-string (stream)
    (loop with i = 0
          while (< i (length text))
          do (let ((end (if (paren-p (char text i)) (form-end text i) (1+ i))))
               (unless (word-at-p text (1+ i) operator)
                 (write-string text stream :start i :end end))
               (setf i end)))))

(defun file-digest (file &optional without)
  "Return a digest of the code in FILE, without comments and layout. If WITHOUT, a string, is given,
leave out the top-level forms with that operator."
  ;; Any file can be read this way. The meaning of its bytes does not matter here.
  (let ((text (read-file-into-string file :external-format :latin-1)))
    (caching (text without)
      (let ((code (code-without-comments text)) (digest (make-digest)))
        (add-characters-to-digest (if without (code-without-forms without code) code) digest)
        (digest-value digest)))))

(defun add-characters-to-digest (text digest)
  (loop for char across text do (digest-add digest char)))

(defun form-digest (form)
  "Return a digest of FORM: of its shape, the names of its symbols, and its data."
  (let ((digest (make-digest)))
    (add-form-to-digest form digest (make-hash-table :test 'eq))
    (digest-value digest)))

(defun add-integer-to-digest (integer digest)
  (loop for rest = integer then (ash rest -64)
        do (digest-add digest rest)
        until (<= -1 rest 0)))

(defun atom-type-name (atom)
  "Return the name of the type of ATOM, the same for all atoms that Lisp reads from the same text."
  (typecase atom
    (symbol 'symbol)
    (string 'string)
    (integer 'integer)
    (t (first (ensure-list (type-of atom))))))

(defun add-atom-to-digest (atom digest known)
  "Add ATOM, a part of a form, to DIGEST. For an uninterned symbol, add the ordinal of its first
occurrence, kept in the table KNOWN."
  (digest-add digest (atom-type-name atom))
  (typecase atom
    (symbol (digest-add digest (if (symbol-package atom)
                                   (symbol-name atom)
                                   (ensure-gethash atom known (hash-table-count known)))))
    (string (add-characters-to-digest atom digest))
    (integer (add-integer-to-digest atom digest))
    (ratio (add-integer-to-digest (numerator atom) digest)
           (add-integer-to-digest (denominator atom) digest))
    (t (digest-add digest atom))))

(defun add-form-to-digest (form digest known)
  (cond ((form-behind-comma form)
         (digest-add digest "comma")
         (add-form-to-digest (form-behind-comma form) digest known))
        ((consp form)
         (digest-add digest "list")
         (loop while (consp form) do (add-form-to-digest (pop form) digest known))
         (digest-add digest "end")
         (when form (add-form-to-digest form digest known)))
        (t (add-atom-to-digest form digest known))))
