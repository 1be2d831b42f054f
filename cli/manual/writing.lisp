;;;; writing.lisp -- the pages of the manual: their frame, the reference, the names.

(in-package :ars-magna.manual)

(export '(examples-of-entry write-manual manual-main))

(defparameter *project-version* (asdf:component-version (asdf:find-system "ars-magna")))

(defparameter *top-links*
  '(("index.html" "Contents") ("introduction.html" "Introduction") ("tutorial.html" "Tutorial")
    ("reference.html" "Reference") ("names.html" "All names") ("about.html" "About"))
  "Lists (file title): the links at the top of each page.")

(defun write-page-frame (out title body)
  "Write to OUT an HTML page with TITLE and BODY. The page uses only files in its own directory."
  (format out "<!DOCTYPE html>
<html lang=\"en\">
<head>
<meta charset=\"utf-8\">
<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">
<title>~A - ARS MAGNA</title>
<link rel=\"stylesheet\" href=\"style.css\">
</head>
<body>
<header>
<p class=\"ways\"><strong>ARS MAGNA</strong>~:{ | <a href=\"~A\">~A</a>~}</p>
<div id=\"search\"></div>
</header>
<main>
~A
</main>
<footer><p>ARS MAGNA ~A. Made from sources by <code>./cli/ars-magna --manual</code>.</p></footer>
<script src=\"search-index.js\"></script>
<script src=\"search.js\"></script>
</body>
</html>
"
          (escape-html title) *top-links* body *project-version*))

(defun list-html (items)
  (format nil "<ul>~%~{<li>~A</li>~%~}</ul>~%" items))

;;; The contents of a page of the guide, before it.

(defun contents-html (page)
  (let ((headings (remove 2 (headings (page-tokens page)) :key #'first :test-not #'eql)))
    (if (< (length headings) 3)
        ""
        (format nil "<nav class=\"contents\">~%~A</nav>~%"
                (list-html (loop for (nil id text) in headings
                                 collect (link-html (format nil "#~A" id) (escape-html text))))))))

(defun write-guide-page (out page book)
  (write-page-frame out (page-title page)
                    (format nil "~A~{~A~}~%<p class=\"source\">From <code>~A</code>.</p>"
                            (contents-html page) (link-tokens (page-tokens page) page book)
                            (escape-html (page-source page)))))

;;; The first page.

(defun page-list-html (part book)
  (list-html (loop for page in (remove part (book-pages book) :key #'contents-part :test-not #'eq)
                   collect (link-html (page-file page) (escape-html (page-title page))))))

(defun chapters-in (book)
  (remove-if-not (lambda (chapter) (find chapter (book-entries book) :key #'entry-chapter))
                 (mapcar #'first *chapters*)))

(defun entries-in-chapter (chapter book)
  (remove chapter (book-entries book) :key #'entry-chapter :test-not #'eq))

(defun chapter-list-html (book)
  (list-html (loop for chapter in (chapters-in book)
                   collect (format nil "~A (~D): ~A"
                                   (link-html (chapter-file chapter)
                                              (escape-html (chapter-title chapter)))
                                   (length (entries-in-chapter chapter book))
                                   (escape-html (chapter-introduction chapter))))))

(defun write-first-page (out book)
  (write-page-frame out "Contents"
                    (format nil "<h1>ARS MAGNA</h1>
<p>An abstract robot simulator for people who build reactive planners.</p>
<h2 id=\"learn\">Learn</h2>~%~A
<h2 id=\"guide\">Guide</h2>~%~A
<h2 id=\"examples\">Examples</h2>~%~A
<h2 id=\"reference\">Reference</h2>~%~A
<p>~A lists all names.</p>
<h2 id=\"inside\">Inside</h2>~%~A"
                            (page-list-html :learning book) (page-list-html :guide book)
                            (page-list-html :examples book) (chapter-list-html book)
                            (link-html "names.html" "All names")
                            (format nil "~A~A" (page-list-html :inside book)
                                    (page-list-html :about book)))))

;;;; The reference

(defun fact-html (fact book)
  (destructuring-bind (label text) fact
    (format nil "~@[<strong>~A:</strong> ~]~A" (and (string/= "" label) (escape-html label))
            (prose-html text book))))

;;; Examples.

(defun example-link-html (example)
  (link-html (format nil "~A#~A" (page-file (example-page example)) (example-id example))
             (escape-html (format nil "~A: ~A" (page-title (example-page example))
                                  (example-heading example)))))

(defun example-html (example book)
  (format nil "<pre class=\"example\"><code>~A</code></pre>~%<p class=\"from\">~A</p>~%"
          (if (example-lisp-p example)
              (lisp-html (example-text example) book)
              (escape-html (example-text example)))
          (example-link-html example)))

(defun show-in-full-p (example named-p)
  "True if EXAMPLE is to be shown in full. NAMED-P is true if the example names its entry."
  (or named-p (<= (count #\Newline (example-text example)) *longest-example*)))

(defun examples-of-entry (entry examples)
  "Return two values: the EXAMPLES for ENTRY, and true if they name the entry."
  (let ((chapter (entry-chapter entry)))
    (examples-for (entry-key entry)
                  (cond ((eq :prompt chapter) :typed)
                        ((member chapter *chapters-of-lisp*) :called)
                        (t :written))
                  examples)))

(defun examples-html (entry book)
  (multiple-value-bind (examples named-p) (examples-of-entry entry (book-examples book))
    (format nil "~{~A~}"
            (loop for example in examples
                  collect (if (show-in-full-p example named-p)
                              (example-html example book)
                              (format nil "<p class=\"from\">Used in ~A.</p>~%"
                                      (example-link-html example)))))))

(defparameter *note-on-examples*
  "Each example has a link to its page. The definitions that it uses are above it on that page."
  "A note on examples, shown in each chapter of the reference.")

;;; Entries and chapters.

(defun entry-html (entry book)
  (format nil "<section id=\"~A\">~%<h3>~A</h3>~%~@[<p class=\"use\"><code>~A</code></p>~%~]~A~A~A~
               ~@[<p class=\"from\">~A</p>~]~%</section>~%"
          (entry-anchor (entry-name entry)) (escape-html (entry-name entry))
          (and (string/= (entry-use entry) (entry-name entry)) (escape-html (entry-use entry)))
          (docstring-html (entry-text entry) book (names-in-lisp (entry-use entry)))
          (if (entry-facts entry)
              (list-html (mapcar (lambda (fact) (fact-html fact book)) (entry-facts entry)))
              "")
          (examples-html entry book)
          (entry-file entry)))

(defun section-html (section entries book)
  (format nil "~@[~A~]~A~{~A~}"
          (and (string/= "" section)
               (format nil "<h2 id=\"section-~A\">~A</h2>~%"
                       (entry-anchor section) (escape-html section)))
          (format nil "<p class=\"names\">~{~A~^, ~}</p>~%"
                  (mapcar (lambda (entry)
                            (link-html (format nil "#~A" (entry-anchor (entry-name entry)))
                                       (escape-html (entry-name entry))))
                          entries))
          (mapcar (lambda (entry) (entry-html entry book)) entries)))

(defun write-chapter (out chapter book)
  (let ((entries (entries-in-chapter chapter book)))
    (write-page-frame out (chapter-title chapter)
                      (format nil "<h1>~A</h1>~%<p>~A</p>~%<p>~A</p>~%~{~A~}"
                              (escape-html (chapter-title chapter))
                              (escape-html (chapter-introduction chapter))
                              (escape-html *note-on-examples*)
                              (loop for section in (remove-duplicates
                                                    (mapcar #'entry-section entries)
                                                    :test #'string= :from-end t)
                                    collect (section-html
                                             section
                                             (remove section entries :key #'entry-section
                                                                     :test-not #'string=)
                                             book))))))

(defun write-reference (out book)
  (write-page-frame out "Reference"
                    (format nil "<h1>Reference</h1>~%~A" (chapter-list-html book))))

;;; All names.

(defun write-list-of-names (out book)
  (flet ((item (entry)
           (format nil "~A (~(~A~)): ~A"
                   (link-html (entry-address entry) (escape-html (entry-name entry)))
                   (escape-html (chapter-title (entry-chapter entry)))
                   (escape-html (first-full-sentence (entry-text entry))))))
    (write-page-frame out "All names"
                      (format nil "<h1>All names</h1>~%~A"
                              (list-html (mapcar #'item
                                                 (sort (copy-list (book-entries book)) #'string<
                                                       :key #'entry-key)))))))

;;;; The whole

;;; Files.

(defun call-with-manual-file (function name directory)
  (call-replacing-file function (merge-pathnames (native-path name) directory)))

(defun copy-file-into (name source directory)
  (let ((copy (merge-pathnames (native-path name) directory)))
    (make-directories (uiop:pathname-directory-pathname copy))
    (check-writable copy)
    (uiop:copy-file source copy)))

(defun write-pages (book directory)
  (flet ((page (name writer &rest arguments)
           (call-with-manual-file (lambda (out) (apply writer out (append arguments (list book))))
                                  name directory)))
    (page "index.html" #'write-first-page)
    (page "reference.html" #'write-reference)
    (page "names.html" #'write-list-of-names)
    (page "search-index.js" #'write-index)
    (dolist (page (book-pages book))
      (page (page-file page) #'write-guide-page page))
    (dolist (chapter (chapters-in book))
      (page (chapter-file chapter) #'write-chapter chapter))))

(defun write-manual (directory)
  "Write the manual into DIRECTORY, a name; make it if needed. Return the path of the first page."
  (let ((directory (uiop:ensure-directory-pathname
                    (merge-pathnames (path-of-name directory) (base-directory))))
        (book (let ((pages (read-guide)) (entries (all-entries)))
                (make-book pages entries (read-examples pages) (table-of-entries entries)))))
    (make-directories directory)
    (write-pages book directory)
    (dolist (name '("style.css" "search.js"))
      (copy-file-into name (project-path (format nil "cli/manual/~A" name)) directory))
    (dolist (name (book-files book))
      (copy-file-into (copied-file-name name) (project-path name) directory))
    (merge-pathnames "index.html" directory)))

(defun manual-main (directory)
  "Write the manual into DIRECTORY, a name. Print the path of the first page, or the error. Return
the exit status."
  (handler-case (progn (format t "~A~%" (native-name (write-manual directory)))
                       0)
    (error (condition)
      (format *error-output* "ars-magna: ~A~%" (text-of-condition condition))
      1)))
