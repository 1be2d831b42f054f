;;;; book.lisp -- all that the manual is made of, and where in it a name leads.

(in-package :ars-magna.manual)

(defstruct (book (:constructor make-book (pages entries examples table)) (:copier nil))
  "The PAGES of the guide, the ENTRIES of the reference, the EXAMPLES, and a table of the entries by
their names in lower case. FILES are the project's files that are copied beside the pages."
  (pages '() :type list :read-only t)
  (entries '() :type list :read-only t)
  (examples '() :type list :read-only t)
  (table nil :type hash-table :read-only t)
  (files '() :type list))

(defun table-of-entries (entries)
  "Return a table of ENTRIES by name; the first of a name counts."
  (let ((table (make-hash-table :test #'equal)))
    (dolist (entry entries table)
      (unless (gethash (entry-key entry) table)
        (setf (gethash (entry-key entry) table) entry)))))

(defun entry-called (name book)
  (values (gethash (string-downcase name) (book-table book))))

(defun page-of-source (source book)
  (find source (book-pages book) :key #'page-source :test #'string=))

;;; Addresses. What a page of the project refers to is another page, or a file that is copied.

(defun without-dots (name)
  "Return NAME, of a file, without steps to directories above."
  (let ((parts '()))
    (dolist (part (uiop:split-string name :separator "/"))
      (cond ((string= ".." part) (pop parts))
            ((member part '("." "") :test #'string=))
            (t (push part parts))))
    (format nil "~{~A~^/~}" (reverse parts))))

(defun name-from (source address)
  "Return the name in the project of what ADDRESS on the page SOURCE is."
  (without-dots (format nil "~A/~A" (subseq source 0 (or (position #\/ source :from-end t) 0))
                        address)))

(defun copied-name (name)
  "Return the name beside the pages of the copy of the project's file NAME: what browsers do not
show by themselves is called a text."
  (format nil "files/~A~:[.txt~;~]" name
          (member (pathname-type name) '("svg" "png" "txt" "html") :test #'equal)))

(defun copy-of-file (name book)
  (pushnew name (book-files book) :test #'string=)
  (copied-name name))

(defun file-address (name book)
  "Return where the project's file NAME is in the manual: a copy; of a directory its page, or the
first page."
  (if (uiop:directory-exists-p (project-path (format nil "~A/" name)))
      (let ((page (page-of-source (format nil "~A/README.md" name) book)))
        (if page (page-file page) "index.html"))
      (copy-of-file name book)))

(defun new-address (address page book)
  "Return where ADDRESS, as PAGE of the project has it, leads in the manual."
  (multiple-value-bind (file place) (let ((mark (or (position #\# address) (length address))))
                                      (values (subseq address 0 mark) (subseq address mark)))
    (cond ((or (search "://" address) (starts-with-subseq "mailto:" address)) address)
          ((string= "" file) place)
          (t (let* ((name (name-from (page-source page) file))
                    (other (page-of-source name book)))
               (format nil "~A~A" (if other (page-file other) (file-address name book))
                       place))))))

;;; Links from names.

(defun link (address html)
  (format nil "<a href=\"~A\">~A</a>" (escaped address) html))

(defun linked-name (name html book)
  (let ((entry (entry-called name book)))
    (if entry (link (entry-address entry) html) html)))

(defparameter *chapters-of-lisp*
  '(:commands :parameters :definers :constructs :plan-functions :fluents :conditions :names :plans)
  "The chapters whose names are linked where they stand in Lisp.")

(defun linked-lisp (text book)
  "Return the HTML of TEXT, of Lisp, its names leading to their entries."
  (with-output-to-string (out)
    (let ((done 0))
      (flet ((copy-to (end)
               (write-string (escaped (subseq text done end)) out)
               (setf done end)))
        (map-names (lambda (name start end)
                     (let ((entry (and (call-p name text start) (entry-called name book))))
                       (when (and entry (member (entry-chapter entry) *chapters-of-lisp*))
                         (copy-to start)
                         (write-string (link (entry-address entry)
                                             (escaped (subseq text start end)))
                                       out)
                         (setf done end))))
                   text)
        (copy-to (length text))))))
