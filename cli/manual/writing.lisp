;;;; writing.lisp -- the manual, written to a directory.

(in-package :ars-magna.manual)

(export '(write-manual main))

(defparameter *own-files* '("style.css" "search.js")
  "The files beside this one that go with the pages as they are.")

;;; What the search looks through: names, first sentences, headings, and the words below the
;;; headings of the guide.

(defun index-row (name kind address text &optional (words ""))
  (format nil "[~{~A~^,~}]" (mapcar #'javascript-string (list name kind address text words))))

(defun words-of (text)
  "Return the words of TEXT, each once, in lower case and without what stands around them."
  (remove-duplicates
   (loop for word in (uiop:split-string (string-downcase text)
                                        :separator '(#\Space #\Newline #\Tab))
         for bare = (string-trim ".,;:()'`\"[]{}" word)
         when (< 1 (length bare)) collect bare)
   :test #'string= :from-end t))

(defun entry-row (entry)
  (index-row (entry-name entry) (chapter-title (entry-chapter entry)) (entry-address entry)
             (entry-sentence entry)))

(defun page-rows (page)
  "Return rows for the headings of PAGE; with the words below them if that is to be read."
  (loop for (nil id text words) in (headings (page-tokens page))
        collect (index-row text (page-title page) (format nil "~A#~A" (page-file page) id) ""
                           (if (member (page-part page) '(:learning :guide))
                               (format nil "~{~A~^ ~}" (words-of words))
                               ""))))

(defun write-index (out book)
  (format out "var SEARCH_INDEX = [~%~{~A~^,~%~}~%];~%"
          (append (mapcar #'entry-row (book-entries book))
                  (mapcan #'page-rows (copy-list (book-pages book))))))

;;; Files.

(defun call-writing (function name directory)
  (call-replacing-file function (merge-pathnames (native-path name) directory)))

(defun copy-into (name source directory)
  (let ((copy (merge-pathnames (native-path name) directory)))
    (make-directories (uiop:pathname-directory-pathname copy))
    (check-unprotected copy)
    (uiop:copy-file source copy)))

(defun write-pages (book directory)
  (flet ((page (name writer &rest arguments)
           (call-writing (lambda (out) (apply writer out (append arguments (list book))))
                         name directory)))
    (page "index.html" #'write-first-page)
    (page "reference.html" #'write-reference)
    (page "names.html" #'write-names)
    (page "search-index.js" #'write-index)
    (dolist (page (book-pages book))
      (page (page-file page) #'write-guide-page page))
    (dolist (chapter (chapters-in book))
      (page (chapter-file chapter) #'write-chapter chapter))))

(defun write-manual (directory)
  "Write the manual into DIRECTORY, a name, which is made if there is none. Return the path of its
first page."
  (let ((directory (uiop:ensure-directory-pathname
                    (merge-pathnames (path-called directory) (base-directory))))
        (book (let ((pages (read-guide)) (entries (all-entries)))
                (make-book pages entries (read-examples pages) (table-of-entries entries)))))
    (make-directories directory)
    (write-pages book directory)
    (dolist (name *own-files*)
      (copy-into name (project-path (format nil "cli/manual/~A" name)) directory))
    (dolist (name (book-files book))
      (copy-into (copied-name name) (project-path name) directory))
    (merge-pathnames "index.html" directory)))

(defun main (directory)
  "Write the manual into DIRECTORY, a name, and say where it begins, or why not. Return the status
to exit with."
  (handler-case (progn (format t "~A~%" (native-name (write-manual directory)))
                       0)
    (error (condition)
      (format *error-output* "ars-magna: ~A~%" (text-of-condition condition))
      1)))
