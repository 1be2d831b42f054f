;;;; html.lisp -- HTML: characters and anchors; from Markdown to HTML; splitting HTML.

(in-package :ars-magna.manual)

(export '(escape-html entry-anchor html-tokens tag-p tag-name attribute-value))

(defun escape-html (text)
  "Return TEXT escaped for HTML, between tags or in an attribute's double quotes."
  (with-output-to-string (out) (write-xml-text text out)))

(defun entity-at (html position)
  "Return the element of *ENTITIES* for the entity at POSITION of HTML, or NIL."
  (find-if (lambda (entity)
             (let ((end (+ position (length (cdr entity)))))
               (and (<= end (length html))
                    (string= (cdr entity) html :start2 position :end2 end))))
           *entities*))

(defun unescape-html (html)
  "Return HTML, which has no tags, as text: entities become characters."
  (with-output-to-string (out)
    (loop with i = 0
          while (< i (length html))
          do (let ((entity (entity-at html i)))
               (write-char (if entity (car entity) (char html i)) out)
               (incf i (if entity (length (cdr entity)) 1))))))

(defun javascript-string (text)
  (with-output-to-string (out) (write-json-string text out :in-page t)))

;;; Anchors.

(defun plain-char-p (char)
  (or (char<= #\a char #\z) (char<= #\0 char #\9) (char= char #\-)))

(defun entry-anchor (name)
  "Return the id of the entry NAME on its page. Different names have different ids, and no character
of an id needs escaping in addresses."
  (with-output-to-string (out)
    (loop for char across (string-downcase name)
          do (if (plain-char-p char)
                 (write-char char out)
                 (format out "_~(~2,'0X~)" (char-code char))))))

(defun heading-id (heading)
  "Return the id of HEADING, a text, on its page. Sites that show Markdown make the same id."
  (substitute #\- #\Space
              (remove-if-not (lambda (char)
                               (or (alphanumericp char) (find char " -_")))
                             (string-downcase heading))))

;;; From Markdown to HTML, by the program cmark-gfm, and splitting HTML.

(defun markdown-html (text)
  "Convert TEXT from GitHub's Markdown to HTML, and return the HTML. HTML in TEXT is left out."
  (multiple-value-bind (status html)
      (with-input-from-string (in text)
        (run-command "cmark-gfm" '("--extension" "table" "--extension" "autolink")
                     :input in :output :string))
    (unless (eql 0 status)
      (reject-use "The manual needs the program cmark-gfm. Debian has it as a package: ~
                   apt-get install cmark-gfm."))
    html))

;;; That HTML is simple: a < begins a tag, the next > ends it, and elements are nested properly.

(defun html-tokens (html)
  "Return the tags in HTML and the texts between them, in a list of strings."
  (loop with start = 0
        while (< start (length html))
        collect (let* ((tag-p (char= #\< (char html start)))
                       (end (if tag-p
                                (1+ (position #\> html :start start))
                                (or (position #\< html :start start) (length html)))))
                  (prog1 (subseq html start end)
                    (setf start end)))))

(defun tag-p (token)
  "True if TOKEN, an element of HTML-TOKENS, is a tag."
  (char= #\< (char token 0)))

(defun tag-name (token)
  "Return the name of the tag TOKEN, with a slash first for an end tag; NIL if TOKEN is text."
  (and (tag-p token)
       (subseq token 1 (position-if (lambda (char) (find char " >")) token))))

(defun tag-named-p (name token)
  (equal name (tag-name token)))

(defun attribute-value (attribute tag)
  "Return the value of ATTRIBUTE, a string, in TAG, or NIL."
  (let* ((mark (format nil " ~A=\"" attribute))
         (start (search mark tag)))
    (when start
      (let ((start (+ start (length mark))))
        (unescape-html (subseq tag start (position #\" tag :start start)))))))

(defun tag-with-attribute (attribute value tag)
  (let* ((mark (format nil " ~A=\"" attribute))
         (start (search mark tag))
         (end (if start
                  (1+ (position #\" tag :start (+ start (length mark))))
                  (position-if (lambda (char) (find char " />")) tag :start 1))))
    (format nil "~A~A~A\"~A" (subseq tag 0 (or start end)) mark (escape-html value)
            (subseq tag end))))

(defun split-element (tokens)
  "Return the tokens of the first element in TOKENS, including its tags, and the remaining tokens."
  (let ((name (tag-name (first tokens))))
    (loop with depth = 0
          for rest on tokens
          for token = (first rest)
          do (cond ((tag-named-p name token) (incf depth))
                   ((tag-named-p (format nil "/~A" name) token) (decf depth)))
          collect token into element
          until (zerop depth)
          finally (return (values element (rest rest))))))

(defun split-into-elements (tokens whole-p)
  "Divide TOKENS into lists: elements whose first tag satisfies WHOLE-P, and single other tokens."
  (loop with rest = tokens
        while rest
        collect (if (funcall whole-p (first rest))
                    (multiple-value-bind (element left) (split-element rest)
                      (setf rest left)
                      element)
                    (list (pop rest)))))

(defun html-text (tokens)
  (unescape-html (format nil "~{~A~}" (remove-if #'tag-p tokens))))
