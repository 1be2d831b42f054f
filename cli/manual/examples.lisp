;;;; examples.lisp -- which blocks of code in the guide are examples of which names.

(in-package :ars-magna.manual)

(export '(read-examples))

;;; A block is an example of the names before it: in a heading or paragraph that consists of names
;;; in code only, as in "### `robot-turn`, `turn`", or in bold code, as in "**`(par form...)`**
;;; succeeds when". The names hold for all blocks up to the next names or heading. A name without
;;; such a block gets the shortest block that uses it.

(defstruct (example (:copier nil))
  "A block of code in the guide: Lisp, or a session at the prompt. NAMES are strings, the names that
the block is an example of. WORDS are the names in the block. CALLS are those of WORDS that cannot
be variables of the block. ID is the id of the heading above the block."
  (page nil :type page :read-only t)
  (id "" :type string :read-only t)
  (heading "" :type string :read-only t)
  (text "" :type string :read-only t)
  (lisp-p nil :type boolean :read-only t)
  (names '() :type list :read-only t)
  (words '() :type list :read-only t)
  (calls '() :type list :read-only t))

;;; Names in text.

(defun name-end-p (char)
  (find char '(#\Space #\Newline #\( #\) #\' #\` #\, #\" #\;)))

(defun first-name (code)
  "Return the name at the beginning of CODE, or after its first parenthesis, in lower case."
  (let* ((start (if (starts-with-subseq "(" code) 1 0))
         (end (or (position-if #'name-end-p code :start start) (length code))))
    (string-downcase (subseq code start end))))

(defun names-if-all-code (tokens)
  "Return the names in TOKENS, a heading or paragraph; NIL if TOKENS contain other text."
  (flet ((code-p (token) (tag-named-p "code" token)))
    (loop for part in (split-into-elements (rest (butlast tokens)) #'code-p)
          if (code-p (first part)) collect (first-name (html-text part))
          else unless (string= "" (string-trim '(#\Space #\, #\Newline) (first part)))
            do (return nil))))

(defun name-in-bold (tokens)
  "Return the name in TOKENS, a bold element; NIL for an element with several pieces of code."
  (when (tag-named-p "code" (second tokens))
    (multiple-value-bind (element left) (split-element (rest tokens))
      (when (null (rest left)) (first-name (html-text element))))))

;;; Names in blocks.

(defun name-at (text start)
  "Return two values: the name in TEXT at START, in lower case without package prefix, and its end."
  (let* ((end (or (position-if #'name-end-p text :start start) (length text)))
         (colon (position #\: text :start start :end end :from-end t))
         (package-p (and colon (< start colon))))
    (values (string-downcase (subseq text (if package-p (1+ colon) start) end)) end)))

(defun string-or-comment-end (text start)
  "Return the end of the string or comment in TEXT that begins at START; NIL if none begins there."
  (case (char text start)
    (#\" (let ((end (position #\" text :start (1+ start)))) (if end (1+ end) (length text))))
    (#\; (or (position #\Newline text :start start) (length text)))))

(defun call-with-each-name (function text)
  "Call FUNCTION with name, start and end of each name in TEXT that is not in a string or comment."
  (loop with i = 0
        while (< i (length text))
        do (let ((skipped (string-or-comment-end text i)))
             (cond (skipped (setf i skipped))
                   ((or (name-end-p (char text i)) (char= #\# (char text i))) (incf i))
                   (t (multiple-value-bind (name end) (name-at text i)
                        (funcall function name i end)
                        (setf i end)))))))

(defun global-reference-p (name text start)
  "True if NAME, in TEXT at START, cannot be a variable of TEXT: NAME is called or quoted, or looks
like a name of the simulator."
  (or (find #\- name :start (min 1 (length name)))
      (find (char name (1- (length name))) "*:")
      (char= #\: (char text start))
      (and (plusp start) (find (char text (1- start)) "('"))))

(defun names-in-lisp (text &optional (test (constantly t)))
  "Return the names in TEXT, Lisp code, each once. TEST is a predicate of name, TEXT and start."
  (let ((names '()))
    (call-with-each-name (lambda (name start end)
                           (declare (ignore end))
                           (when (funcall test name text start)
                             (pushnew name names :test #'string=)))
                         text)
    (nreverse names)))

(defparameter *prompt* "Robot> " "The prompt before what is typed in a session.")

(defun typed-names (text)
  (loop for line in (uiop:split-string text :separator '(#\Newline))
        for start = (search *prompt* line)
        when start
          collect (first-name (subseq line (+ start (length *prompt*))))))

;;; Blocks.

(defun block-language (element)
  (let ((class (attribute-value "class" (second element))))
    (and class (starts-with-subseq "language-" class) (subseq class (length "language-")))))

(defun make-block-example (element page heading names)
  "Return an example of NAMES made from ELEMENT, a block of code on PAGE under HEADING, a list
(level id text). NIL if ELEMENT is neither Lisp nor a session."
  (let* ((text (html-text element))
         (lisp-p (equal "lisp" (block-language element))))
    (when (or lisp-p (search *prompt* text))
      (make-example :page page :id (second heading) :heading (third heading) :text text
                    :lisp-p lisp-p :names names
                    :words (if lisp-p (names-in-lisp text) (typed-names text))
                    :calls (if lisp-p (names-in-lisp text #'global-reference-p) '())))))

(defstruct (example-search (:conc-name search-) (:constructor make-example-search) (:copier nil))
  "The state of a search for examples on PAGE. HEADING, a list (level id text), is the last heading.
NAMES are the last names that the page has introduced; USED-P is true if a block has followed these
names. EXAMPLES are the examples found, the last first."
  (page nil :type page :read-only t)
  (heading '() :type list)
  (names '() :type list)
  (used-p nil :type boolean)
  (examples '() :type list))

(defun set-search-names (state names &key keep)
  "Let the next blocks be examples of NAMES. If KEEP, keep names that no block has followed yet."
  (when names
    (setf (search-names state) (if (and keep (not (search-used-p state)))
                                   (append (search-names state) names)
                                   names)
          (search-used-p state) nil)))

(defun visit-heading (state element)
  (setf (search-heading state) (list (heading-level (first element))
                                     (attribute-value "id" (first element))
                                     (html-text element))
        (search-names state) '()
        (search-used-p state) nil)
  (set-search-names state (names-if-all-code element)))

(defun visit-block (state element)
  (let ((example (make-block-example element (search-page state) (search-heading state)
                                     (search-names state))))
    (setf (search-used-p state) t)
    (when example (push example (search-examples state)))))

(defun names-in-bold (tokens)
  (loop for rest on tokens
        for name = (and (tag-named-p "strong" (first rest))
                        (name-in-bold (split-element rest)))
        when name collect name))

(defun examples-of-page (page)
  "Return the examples on PAGE, in order. Names with no block between them share the next blocks."
  (let ((state (make-example-search :page page :heading (list 1 "" (page-title page)))))
    (flet ((wanted-p (token)
             (or (heading-level token) (member (tag-name token) '("p" "pre") :test #'equal))))
      (dolist (part (split-into-elements (page-tokens page) #'wanted-p))
        (cond ((heading-level (first part)) (visit-heading state part))
              ((tag-named-p "pre" (first part)) (visit-block state part))
              ((tag-named-p "p" (first part))
               (set-search-names state (or (names-if-all-code part) (names-in-bold part)) :keep
                                 t)))))
    (reverse (search-examples state))))

(defun read-examples (pages)
  "Return all examples on PAGES."
  (mapcan #'examples-of-page (copy-list pages)))

;;; Choosing.

(defparameter *longest-example* 30
  "A block with more lines is not shown in full for a name that it uses but does not explain.")

(defun names-of-kind (example kind)
  "Return the names in EXAMPLE of KIND: :TYPED at the prompt, :CALLED in Lisp, or :WRITTEN in Lisp."
  (ecase kind
    (:typed (if (example-lisp-p example) '() (example-words example)))
    (:called (example-calls example))
    (:written (if (example-lisp-p example) (example-words example) '()))))

(defun examples-for (name kind examples)
  "Return two values: the EXAMPLES that are about the string NAME, and true. If there are none,
return a list of the shortest example with NAME among its names of KIND, and NIL."
  (flet ((having (reader)
           (remove-if-not (lambda (example)
                            (member name (funcall reader example) :test #'string=))
                          examples)))
    (let ((named (having #'example-names)))
      (if named
          (values named t)
          (let ((using (having (lambda (example) (names-of-kind example kind)))))
            (values (and using
                         (list (first (sort (copy-list using) #'<
                                            :key (lambda (example)
                                                   (length (example-text example)))))))
                    nil))))))
