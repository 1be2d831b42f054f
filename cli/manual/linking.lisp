;;;; linking.lisp -- pages of the guide with their links, and prose with its names linked.

(in-package :ars-magna.manual)

;;; Pages of the guide.

(defun linked-code (element book)
  (let ((name (first-name (text-of element))))
    (list (linked-name name (format nil "~{~A~}" element) book))))

(defun linked-block (element book)
  (if (equal "lisp" (block-language element))
      (list "<pre><code>" (linked-lisp (text-of element) book) "</code></pre>")
      element))

(defun linked-tokens (tokens page book)
  "Return TOKENS, of PAGE, with addresses as they are in the manual, and names that lead to their
entries."
  (flet ((linked-p (token) (member (tag-name token) '("pre" "code" "a") :test #'equal)))
    (loop for part in (parts-of tokens #'linked-p)
          for token = (first part)
          append (cond ((tag-called-p "pre" token) (linked-block part book))
                       ((tag-called-p "code" token) (linked-code part book))
                       ((tag-called-p "a" token) (linked-anchor part page book))
                       (t (list (linked-picture token page book)))))))

(defun linked-anchor (element page book)
  "Return the tokens of ELEMENT, a link on PAGE, leading to where that is in the manual."
  (cons (with-attribute "href" (new-address (attribute-value "href" (first element)) page book)
          (first element))
        (rest element)))

(defun linked-picture (token page book)
  "Return TOKEN; if it is a picture on PAGE, with the address of its copy."
  (if (tag-called-p "img" token)
      (with-attribute "src" (new-address (attribute-value "src" token) page book) token)
      token))

(defun page-html (page book)
  (format nil "~{~A~}" (linked-tokens (page-tokens page) page book)))

;;; Prose of docstrings: names are in capitals, or in backquotes where we write it ourselves. What
;;; is indented is a list, whose lines stay apart.

(defparameter *about-the-manual* "about.html#the-manual-of-1992"
  "Where the manual tells what the manual of 1992 is.")

(defun word-char-p (char)
  (or (alphanumericp char) (find char "-*+!?%:./_=<>")))

(defun loud-name-p (word)
  (and (< 1 (length word))
       (some #'alpha-char-p word)
       (notany #'lower-case-p word)))

(defun citation-address (word next book)
  "Return where WORD, if it cites NEXT, a section of the manual of 1992 or a reading, leads."
  (let ((number (parse-integer next :junk-allowed t)))
    (cond ((string-equal "reading" word)
           (and number (page-of-source "src/readings.md" book)
                (format nil "readings.html#reading-~D" number)))
          ((string-equal "manual" word)
           (and (or number (and (string/= "" next) (find (char next 0) "ABCDEF")))
                *about-the-manual*)))))

(defun words-and-gaps (text)
  "Return the words in TEXT and what is between them, in a list of strings that begins with a gap."
  (loop with start = 0
        for word = (position-if #'word-char-p text :start start)
        for end = (and word (or (position-if-not #'word-char-p text :start word) (length text)))
        collect (subseq text start (or word (length text)))
        while word
        collect (subseq text word end)
        do (setf start end)))

(defun word-html (word book own)
  "Return the HTML of WORD, in prose of something with arguments called OWN."
  (let ((name (string-right-trim ".:" word)))
    (cond ((and (or (loud-name-p name)
                    (and (< 1 (length name)) (char= #\: (char name 0))))
                (not (member name own :test #'string-equal)))
           (format nil "~A~A" (linked-name name (escaped name) book)
                   (escaped (subseq word (length name)))))
          (t (escaped word)))))

(defun line-html (line book &optional own)
  "Return the HTML of LINE, of prose without backquotes; OWN as for WORD-HTML."
  (with-output-to-string (out)
    (loop for (gap word next-gap next) on (words-and-gaps line) by #'cddr
          do (write-string (escaped gap) out)
             (when word
               (let ((address (and (equal " " next-gap) next (citation-address word next book))))
                 (write-string (if address
                                   (link address (escaped word))
                                   (word-html word book own))
                               out))))))

(defun prose-html (text book &optional own)
  "Return the HTML of TEXT, prose in which names are in backquotes or in capitals; OWN as for
WORD-HTML."
  (with-output-to-string (out)
    (loop for part in (uiop:split-string text :separator "`")
          for code-p = nil then (not code-p)
          do (write-string (if code-p
                               (linked-name part (format nil "<code>~A</code>" (escaped part))
                                            book)
                               (line-html part book own))
                           out))))

(defun indented-p (line)
  (starts-with-subseq "  " line))

(defun paragraphs (text)
  "Return the lines of TEXT in lists: those of a paragraph, or those of a list, which are indented."
  (let ((groups '()))
    (dolist (line (uiop:split-string text :separator '(#\Newline))
                  (reverse (mapcar #'reverse groups)))
      (cond ((string= "" (string-trim " " line)) (push '() groups))
            ((and groups (first groups)
                  (eq (indented-p line) (indented-p (first (first groups)))))
             (push line (first groups)))
            (t (push (list line) groups))))))

(defun docstring-html (text book own)
  "Return the HTML of TEXT, documentation of several paragraphs; OWN as for WORD-HTML."
  (with-output-to-string (out)
    (dolist (lines (remove nil (paragraphs text)))
      (if (indented-p (first lines))
          (format out "<pre>~{~A~^~%~}</pre>~%"
                  (mapcar (lambda (line) (line-html line book own)) lines))
          (format out "<p>~A</p>~%" (prose-html (format nil "~{~A~^~%~}" lines) book own))))))
