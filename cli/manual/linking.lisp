;;;; linking.lisp -- which page has what, and Markdown pages as HTML with links.

(in-package :ars-magna.manual)

(defstruct (book (:constructor make-book (pages entries examples table)) (:copier nil))
  "The manual: the PAGES of the guide, the ENTRIES of the reference, and the EXAMPLES. TABLE maps
names in lower case to entries. FILES are the project's files to copy beside the pages."
  (pages '() :type list :read-only t)
  (entries '() :type list :read-only t)
  (examples '() :type list :read-only t)
  (table nil :type hash-table :read-only t)
  (files '() :type list))

(defun table-of-entries (entries)
  "Return a hash table from names to ENTRIES. A name of several entries leads to the first."
  (let ((table (make-hash-table :test #'equal)))
    (dolist (entry entries table)
      (unless (gethash (entry-key entry) table)
        (setf (gethash (entry-key entry) table) entry)))))

(defun find-entry-named (name book)
  (values (gethash (string-downcase name) (book-table book))))

(defun find-page (source book)
  (find source (book-pages book) :key #'page-source :test #'string=))

;;; Addresses. Pages of the project refer to other pages, or to files that are copied.

(defun resolve-dots (name)
  (let ((parts '()))
    (dolist (part (uiop:split-string name :separator "/"))
      (cond ((string= ".." part) (pop parts))
            ((member part '("." "") :test #'string=))
            (t (push part parts))))
    (format nil "~{~A~^/~}" (reverse parts))))

(defun copied-file-name (name)
  "Return the name of the manual's copy of the file NAME: a txt file if browsers cannot show NAME."
  (format nil "files/~A~:[.txt~;~]" name
          (member (pathname-type name) '("svg" "png" "txt" "html") :test #'equal)))

(defun file-address (name book)
  "Return the address of the manual's copy of the project's file NAME. If NAME is a directory,
return the address of its page, or of the first page."
  (if (uiop:directory-exists-p (project-path (format nil "~A/" name)))
      (let ((page (find-page (format nil "~A/README.md" name) book)))
        (if page (page-file page) "index.html"))
      (progn (pushnew name (book-files book) :test #'string=)
             (copied-file-name name))))

(defun manual-address (address page book)
  "Return the address in the manual for ADDRESS, a link on PAGE in the project."
  (multiple-value-bind (file place) (let ((mark (or (position #\# address) (length address))))
                                      (values (subseq address 0 mark) (subseq address mark)))
    (cond ((or (search "://" address) (starts-with-subseq "mailto:" address)) address)
          ((string= "" file) place)
          (t (let* ((source (page-source page))
                    (folder (subseq source 0 (or (position #\/ source :from-end t) 0)))
                    (name (resolve-dots (format nil "~A/~A" folder file)))
                    (other (find-page name book)))
               (format nil "~A~A" (if other (page-file other) (file-address name book))
                       place))))))

;;; Links from names.

(defun link-html (address html)
  (format nil "<a href=\"~A\">~A</a>" (escape-html address) html))

(defun linked-name-html (name html book)
  (let ((entry (find-entry-named name book)))
    (if entry (link-html (entry-address entry) html) html)))

(defparameter *chapters-of-lisp*
  '(:commands :parameters :definers :constructs :plan-functions :fluents :conditions :names :plans)
  "The chapters whose names are linked in Lisp code.")

(defun lisp-html (text book)
  "Return TEXT, Lisp code, as HTML with names linked to their entries."
  (with-output-to-string (out)
    (let ((done 0))
      (flet ((copy-to (end)
               (write-string (escape-html (subseq text done end)) out)
               (setf done end)))
        (call-with-each-name (lambda (name start end)
                               (let ((entry (and (global-reference-p name text start)
                                                 (find-entry-named name book))))
                                 (when (and entry (member (entry-chapter entry) *chapters-of-lisp*))
                                   (copy-to start)
                                   (write-string (link-html (entry-address entry)
                                                            (escape-html (subseq text start end)))
                                                 out)
                                   (setf done end))))
                             text)
        (copy-to (length text))))))

;;;; Links

;;; Pages of the guide.

(defun link-tokens (tokens page book)
  "Return TOKENS of PAGE, with links that lead into the manual and names linked to entries."
  (flet ((linked-p (token) (member (tag-name token) '("pre" "code" "a") :test #'equal)))
    (loop for part in (split-into-elements tokens #'linked-p)
          for token = (first part)
          append (cond ((and (tag-named-p "pre" token) (equal "lisp" (block-language part)))
                        (list "<pre><code>" (lisp-html (html-text part) book) "</code></pre>"))
                       ((tag-named-p "pre" token) part)
                       ((tag-named-p "code" token)
                        (list (linked-name-html (first-name (html-text part))
                                                (format nil "~{~A~}" part)
                                                book)))
                       ((tag-named-p "a" token) (link-with-manual-address part page book))
                       (t (list (rewrite-picture-address token page book)))))))

(defun link-with-manual-address (element page book)
  "Return the tokens of ELEMENT, a link on PAGE, with its address changed to the one in the manual."
  (cons (tag-with-attribute "href"
                            (manual-address (attribute-value "href" (first element)) page book)
                            (first element))
        (rest element)))

(defun rewrite-picture-address (token page book)
  "Return TOKEN of PAGE. In a picture, the address is replaced by that of the manual's copy."
  (if (tag-named-p "img" token)
      (tag-with-attribute "src" (manual-address (attribute-value "src" token) page book) token)
      token))

;;; Prose of docstrings: names are in capitals, or in backquotes where the manual adds text.
;;; Indented lines are a list and stay apart.

(defun word-char-p (char)
  (or (alphanumericp char) (find char "-*+!?%:./_=<>")))

(defun citation-address (word next book)
  "If WORD and NEXT cite a section of the 1992 manual or a reading, return the address to link to."
  (let ((number (parse-integer next :junk-allowed t)))
    (cond ((string-equal "reading" word)
           (and number (find-page "src/readings.md" book)
                (format nil "readings.html#reading-~D" number)))
          ((string-equal "manual" word)
           (and (or number (and (string/= "" next) (find (char next 0) "ABCDEF")))
                "about.html#the-manual-of-1992")))))

(defun words-and-gaps (text)
  "Return TEXT as a list of strings: a gap, a word, a gap, and so on. A gap is text between words."
  (loop with start = 0
        for word = (position-if #'word-char-p text :start start)
        for end = (and word (or (position-if-not #'word-char-p text :start word) (length text)))
        collect (subseq text start (or word (length text)))
        while word
        collect (subseq text word end)
        do (setf start end)))

(defun word-html (word book own)
  "Return the HTML of WORD, linked if WORD names an entry. Names in OWN, a list, are not linked."
  (let ((name (string-right-trim ".:" word)))
    (cond ((and (< 1 (length name))
                ;; In capitals, or a keyword.
                (or (and (some #'alpha-char-p name) (notany #'lower-case-p name))
                    (char= #\: (char name 0)))
                (not (member name own :test #'string-equal)))
           (format nil "~A~A" (linked-name-html name (escape-html name) book)
                   (escape-html (subseq word (length name)))))
          (t (escape-html word)))))

(defun line-html (line book &optional own)
  "Return the HTML of LINE, prose without backquotes. OWN is as for WORD-HTML."
  (with-output-to-string (out)
    (loop for (gap word next-gap next) on (words-and-gaps line) by #'cddr
          do (write-string (escape-html gap) out)
             (when word
               (let ((address (and (equal " " next-gap) next (citation-address word next book))))
                 (write-string (if address
                                   (link-html address (escape-html word))
                                   (word-html word book own))
                               out))))))

(defun prose-html (text book &optional own)
  "Return the HTML of TEXT, prose with names in backquotes or capitals. OWN is as for WORD-HTML."
  (with-output-to-string (out)
    (loop for part in (uiop:split-string text :separator "`")
          for code-p = nil then (not code-p)
          do (write-string (if code-p
                               (linked-name-html part
                                                 (format nil "<code>~A</code>" (escape-html part))
                                                 book)
                               (line-html part book own))
                           out))))

(defun indented-p (line)
  (starts-with-subseq "  " line))

(defun paragraphs (text)
  "Return a list of the paragraphs and indented lists in TEXT, each as a list of lines."
  (let ((groups '()))
    (dolist (line (uiop:split-string text :separator '(#\Newline))
                  (reverse (mapcar #'reverse groups)))
      (cond ((string= "" (string-trim " " line)) (push '() groups))
            ((and groups (first groups)
                  (eq (indented-p line) (indented-p (first (first groups)))))
             (push line (first groups)))
            (t (push (list line) groups))))))

(defun docstring-html (text book own)
  "Return the HTML of TEXT, a docstring of several paragraphs. OWN is as for WORD-HTML."
  (with-output-to-string (out)
    (dolist (lines (remove nil (paragraphs text)))
      (if (indented-p (first lines))
          (format out "<pre>~{~A~^~%~}</pre>~%"
                  (mapcar (lambda (line) (line-html line book own)) lines))
          (format out "<p>~A</p>~%" (prose-html (format nil "~{~A~^~%~}" lines) book own))))))
