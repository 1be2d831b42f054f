;;;; reference.lisp -- the pages of the reference: a chapter each, and the list of all names.

(in-package :ars-magna.manual)

(export '(examples-of-entry))

(defun fact-html (fact book)
  (destructuring-bind (label text) fact
    (format nil "~@[<strong>~A:</strong> ~]~A" (and (string/= "" label) (escaped label))
            (prose-html text book))))

;;; Examples.

(defun from-html (example)
  (link (format nil "~A#~A" (page-file (example-page example)) (example-id example))
        (escaped (format nil "~A: ~A" (page-title (example-page example))
                         (example-heading example)))))

(defun example-html (example book)
  (format nil "<pre class=\"example\"><code>~A</code></pre>~%<p class=\"from\">~A</p>~%"
          (if (example-lisp-p example)
              (linked-lisp (example-text example) book)
              (escaped (example-text example)))
          (from-html example)))

(defun shown-p (example named-p)
  "True if EXAMPLE is to be shown with the entry, which it names if NAMED-P is true."
  (or named-p (<= (count #\Newline (example-text example)) *longest-example*)))

(defun examples-of-entry (entry examples)
  "Return those of EXAMPLES that are for ENTRY, and true if they name it."
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
                  collect (if (shown-p example named-p)
                              (example-html example book)
                              (format nil "<p class=\"from\">Used in ~A.</p>~%"
                                      (from-html example)))))))

(defparameter *about-examples*
  "An example is a part of the page that its link leads to. What it uses and Lisp does not know is
defined there, further up."
  "What a chapter says of its examples.")

;;; Entries and chapters.

(defun entry-html (entry book)
  (format nil "<section id=\"~A\">~%<h3>~A</h3>~%~@[<p class=\"use\"><code>~A</code></p>~%~]~A~A~A~
               ~@[<p class=\"from\">~A</p>~]~%</section>~%"
          (anchor (entry-name entry)) (escaped (entry-name entry))
          (and (string/= (entry-use entry) (entry-name entry)) (escaped (entry-use entry)))
          (docstring-html (entry-text entry) book (lisp-names (entry-use entry)))
          (if (entry-facts entry)
              (list-html (mapcar (lambda (fact) (fact-html fact book)) (entry-facts entry)))
              "")
          (examples-html entry book)
          (entry-file entry)))

(defun sections-of (entries)
  (remove-duplicates (mapcar #'entry-section entries) :test #'string= :from-end t))

(defun section-html (section entries book)
  (format nil "~@[~A~]~A~{~A~}"
          (and (string/= "" section)
               (format nil "<h2 id=\"section-~A\">~A</h2>~%" (anchor section) (escaped section)))
          (format nil "<p class=\"names\">~{~A~^, ~}</p>~%"
                  (mapcar (lambda (entry)
                            (link (format nil "#~A" (anchor (entry-name entry)))
                                  (escaped (entry-name entry))))
                          entries))
          (mapcar (lambda (entry) (entry-html entry book)) entries)))

(defun write-chapter (out chapter book)
  (let ((entries (entries-in chapter book)))
    (write-frame out (chapter-title chapter)
                 (format nil "<h1>~A</h1>~%<p>~A</p>~%<p>~A</p>~%~{~A~}"
                         (escaped (chapter-title chapter))
                         (escaped (chapter-introduction chapter))
                         (escaped *about-examples*)
                         (loop for section in (sections-of entries)
                               collect (section-html
                                        section
                                        (remove section entries :key #'entry-section
                                                                :test-not #'string=)
                                        book))))))

(defun write-reference (out book)
  (write-frame out "Reference"
               (format nil "<h1>Reference</h1>~%~A" (chapter-links book))))

;;; All names.

(defun write-names (out book)
  (write-frame out "All names"
               (format nil "<h1>All names</h1>~%~A"
                       (list-html
                        (loop for entry in (sort (copy-list (book-entries book)) #'string<
                                                 :key #'entry-key)
                              collect (format nil "~A (~(~A~)): ~A"
                                              (link (entry-address entry)
                                                    (escaped (entry-name entry)))
                                              (escaped (chapter-title (entry-chapter entry)))
                                              (escaped (entry-sentence entry))))))))
