;;;; frame.lisp -- what all pages of the manual have around them.

(in-package :ars-magna.manual)

(defparameter *version* (asdf:component-version (asdf:find-system "ars-magna")))

(defparameter *ways*
  '(("index.html" "Contents") ("introduction.html" "Introduction") ("tutorial.html" "Tutorial")
    ("reference.html" "Reference") ("names.html" "All names") ("about.html" "About"))
  "Lists (file title): where each page leads.")

(defun write-frame (out title body)
  "Write to OUT a page called TITLE around BODY, HTML. All that it needs lies beside it."
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
<footer><p>ARS MAGNA ~A. Made of its sources by <code>./cli/ars-magna --manual</code>.</p></footer>
<script src=\"search-index.js\"></script>
<script src=\"search.js\"></script>
</body>
</html>
"
          (escaped title) *ways* body *version*))

(defun list-html (items)
  (format nil "<ul>~%~{<li>~A</li>~%~}</ul>~%" items))

;;; The contents of a page of the guide, before it.

(defun contents-html (page)
  (let ((headings (remove 2 (headings (page-tokens page)) :key #'first :test-not #'eql)))
    (if (< (length headings) 3)
        ""
        (format nil "<nav class=\"contents\">~%~A</nav>~%"
                (list-html (loop for (nil id text) in headings
                                 collect (link (format nil "#~A" id) (escaped text))))))))

(defun write-guide-page (out page book)
  (write-frame out (page-title page)
               (format nil "~A~A~%<p class=\"source\">From <code>~A</code>.</p>"
                       (contents-html page) (page-html page book) (escaped (page-source page)))))

;;; The first page.

(defun page-links (part book)
  (list-html (loop for page in (remove part (book-pages book) :key #'page-part :test-not #'eq)
                   collect (link (page-file page) (escaped (page-title page))))))

(defun chapters-in (book)
  (remove-if-not (lambda (chapter) (find chapter (book-entries book) :key #'entry-chapter))
                 (mapcar #'first *chapters*)))

(defun entries-in (chapter book)
  (remove chapter (book-entries book) :key #'entry-chapter :test-not #'eq))

(defun chapter-links (book)
  (list-html (loop for chapter in (chapters-in book)
                   collect (format nil "~A (~D): ~A"
                                   (link (chapter-file chapter) (escaped (chapter-title chapter)))
                                   (length (entries-in chapter book))
                                   (escaped (chapter-introduction chapter))))))

(defun write-first-page (out book)
  (write-frame out "Contents"
               (format nil "<h1>ARS MAGNA</h1>
<p>An abstract robot simulator for people who build reactive planners.</p>
<h2 id=\"learn\">Learn</h2>~%~A
<h2 id=\"guide\">Guide</h2>~%~A
<h2 id=\"examples\">Examples</h2>~%~A
<h2 id=\"reference\">Reference</h2>~%~A
<p>~A lists everything that has a name.</p>
<h2 id=\"inside\">Inside</h2>~%~A"
                       (page-links :learning book) (page-links :guide book)
                       (page-links :examples book) (chapter-links book)
                       (link "names.html" "All names")
                       (format nil "~A~A" (page-links :inside book) (page-links :about book)))))
