;;;; examples.lisp -- the examples of the folders' pages are correct and show every name.

(in-package :ars-magna.tests)

(def-suite* examples :in ars-magna)

;;; Pages that no other suite runs.

(defparameter *pages-run-elsewhere*
  (append *plan-pages*
          '("README.md" "worlds/how-to/extend/README.md" "src/experiment/README.md"
            "src/experiment/table/README.md" "src/ways/README.md" "src/floors/README.md"
            "worlds/tutorial/README.md" "cli/README.md"))
  "The pages whose Lisp other suites run.")

(defun all-readmes ()
  "Return the names of the project's README.md files."
  (cons "README.md"
        (loop for folder in '("src/" "rpl/" "worlds/" "cli/" "tests/")
              append (mapcar (lambda (path) (enough-namestring path (project-file "")))
                             (directory (merge-pathnames "**/README.md"
                                                         (project-file folder)))))))

(defun pages-of-examples ()
  (set-difference (all-readmes) *pages-run-elsewhere* :test #'string=))

(defun call-forgetting-packages (function)
  "Call FUNCTION in ARS-USER; undo its definitions afterwards, and delete the packages it makes."
  (let ((packages (list-all-packages))
        (*package* (find-package :ars-user))
        (*readtable* *readtable*)
        (base:*message-queue* (base:make-message-queue)))
    (unwind-protect (base:with-own-definitions () (funcall function))
      (mapc #'delete-package (set-difference (list-all-packages) packages)))))

(defun call-where-files-go (function)
  "Call FUNCTION where files may be written, and are then forgotten."
  (uiop:with-temporary-file (:pathname place)
    (let ((directory (uiop:ensure-directory-pathname (format nil "~A-files" place))))
      (ensure-directories-exist directory)
      (unwind-protect (uiop:with-current-directory (directory) (funcall function))
        (uiop:delete-directory-tree directory :validate t)))))

(test examples.of-lisp-are-so
  (dolist (page (pages-of-examples))
    (let ((blocks (lisp-blocks (project-file page))))
      (call-where-files-go
       (lambda ()
         (call-forgetting-packages
          (lambda ()
            (call-with-suites-of-its-own
             (lambda ()
               (is (<= 0 (reduce #'+ (mapcar #'run-block blocks))) page))
             :my-house))))))))

;;; Sessions, each of which begins anew.

(defparameter *pages-of-sessions* '("cli/lines/README.md")
  "The pages whose blocks of text are sessions with DOT, in a world without noise.")

(defun check-session (lines page)
  "Check that the answers to the typed lines among LINES, of PAGE, are as shown there."
  (let* ((typed (remove nil (mapcar #'typed-line lines)))
         (answers (remove nil (mapcar #'answered-line lines)))
         (written (apply #'type-to 'ars-worlds:dot typed)))
    (is (not (null typed)))
    (is (found-in-order-p answers written) "~A:~%~{~A~%~}is not what came:~%~{~A~%~}" page
        answers written)))

(test examples.of-sessions-are-so
  (call-where-files-go
   (lambda ()
     (dolist (page *pages-of-sessions*)
       (dolist (lines (blocks-of "text" (project-file page)))
         (let ((ars-magna.rpl-robot:*trace-plans* nil))
           (check-session lines page)))))))

(test examples.pages-have-lines-to-be-read
  (dolist (page (pages-of-examples))
    (dolist (line (file-lines (project-file page)))
      (unless (or (begins-with-p "|" line) (begins-with-p "![" line))
        (is (<= (length line) 112) "~A: ~A" page line)))))

;;; Files that pages name.

(defun files-named (text)
  "Return the names of Lisp files in TEXT, a page, without those that its reader writes and loads."
  (loop for name in (uiop:split-string text :separator "`")
        when (and (uiop:string-suffix-p name ".lisp")
                  (not (find-if (lambda (char) (find char " *")) name))
                  (not (search (format nil "--load ~A" name) text))
                  (not (search (format nil "--world ~A" name) text)))
          collect name))

(defun project-file-p (name)
  "True if a file of the project has this NAME, or one that ends with it."
  (some (lambda (path)
          (uiop:string-suffix-p (namestring path) (format nil "/~A" name)))
        (lisp-files "src/" "rpl/" "worlds/" "cli/" "tests/")))

(test examples.pages-name-files-that-exist
  (is (equal '("a/b.lisp") (files-named "See `a/b.lisp`, `(load)`; `x.lisp` for --load x.lisp.")))
  (is-true (project-file-p "world/walls.lisp"))
  (is-false (project-file-p "world/wall.lisp"))
  (dolist (page (all-readmes))
    (dolist (name (files-named (base:read-file-into-string (project-file page))))
      (is-true (project-file-p name) "~A names ~A, which does not exist" page name))))

;;; Names without an example.

(defun names-without-examples ()
  "Return texts \"chapter: name\" for the entries of the manual that no page shows."
  (let ((examples (manual:read-examples (manual:read-guide))))
    (loop for entry in (manual:all-entries)
          unless (manual:examples-of-entry entry examples)
            collect (format nil "~A: ~(~A~)" (manual:chapter-title (manual:entry-chapter entry))
                            (manual:entry-name entry)))))

(test examples.are-there-for-all-names
  (if (markdown-program-p)
      (is (null (names-without-examples)) "~{~A~%~}have none." (names-without-examples))
      (skip "There is no cmark-gfm: no page can be read.")))
