;;;; readme.lisp -- the examples of the first page work as printed.

(in-package :ars-magna.tests)

(def-suite* readme :in ars-magna)

(defun first-page () (project-file "README.md"))

(defun call-in-new-directory (function)
  "Call FUNCTION with a new directory, which is where files go meanwhile; delete it."
  (let ((directory (uiop:ensure-directory-pathname
                    (format nil "~Aars-magna-~36R/" (namestring (uiop:temporary-directory))
                            (random (expt 36 8) (make-random-state t))))))
    (ensure-directories-exist directory)
    (unwind-protect (let ((*default-pathname-defaults* directory)) (funcall function directory))
      (uiop:delete-directory-tree directory :validate t :if-does-not-exist :ignore))))

(defun pages-packages ()
  "Return the packages that a page has made: their names begin with MY-. Users come first."
  (sort (remove-if-not (lambda (package) (begins-with-p "MY-" (package-name package)))
                       (list-all-packages))
        #'> :key (lambda (package) (length (package-name package)))))

(defun call-as-newcomer (function)
  "Call FUNCTION in ARS-USER; forget what it defines, and the packages that it makes."
  (let ((*package* (find-package :ars-user)) (*readtable* (copy-readtable nil)))
    (unwind-protect (base:with-own-definitions () (funcall function))
      (ignore-errors (run:stop-simulator))
      (mapc #'delete-package (pages-packages)))))

(defun said-by-block (text)
  "Evaluate the forms in TEXT. Return what they write."
  (with-output-to-string (out)
    (let ((*standard-output* out))
      (with-input-from-string (in text)
        (loop for form = (read in nil in)
              until (eq form in)
              do (handler-bind ((warning #'muffle-warning)) (eval form)))))))

(defun said-by-page (path)
  "Evaluate all blocks of Lisp of the page PATH. Return what they write."
  (call-in-new-directory
   (lambda (directory)
     (declare (ignore directory))
     (call-as-newcomer
      (lambda () (joined (mapcar #'finishes-saying (lisp-blocks path))))))))

(test readme.runs-from-top-to-bottom
  (is (< 3 (length (lisp-blocks (first-page)))))
  (is-true (has-words-p (said-by-page (first-page)) "stopped by a wall at tick" "success")))

(test readme.is-short
  (is (>= 180 (length (file-lines (first-page)))))
  (is (>= 1500 (loop for line in (file-lines (first-page))
                     sum (count "" (uiop:split-string line) :test #'string/=)))))

(defun finishes-saying (text)
  "Return what the block TEXT writes; check that it signals no error."
  (let ((said ""))
    (finishes (setf said (said-by-block text)))
    said))

(defun write-files (blocks directory)
  "Write each of BLOCKS, lists of lines of which the first names a file, to that in DIRECTORY."
  (dolist (lines blocks)
    (with-open-file (out (merge-pathnames (string-left-trim "; " (first lines)) directory)
                         :direction :output :external-format :utf-8)
      (format out "~{~A~%~}" lines))))

(test readme.shows-a-system-that-depends-on-ours
  (call-in-new-directory
   (lambda (directory)
     (write-files (blocks-of "common-lisp" (project-file "worlds/how-to/own-system/README.md"))
                  directory)
     (call-as-newcomer
      (lambda ()
        (call-with-suites-of-its-own
         (lambda ()
           (let ((*standard-output* (make-broadcast-stream)))
             (unwind-protect
                  (progn (asdf:load-asd (merge-pathnames "my-rooms.asd" directory))
                         (finishes (asdf:load-system "my-rooms"))
                         (is-true (world:find-map 'attic nil))
                         (is (equal "A bare attic." (documentation 'attic 'world:map)))
                         (finishes (asdf:test-system "my-rooms")))
               (asdf:clear-system "my-rooms/tests")
               (asdf:clear-system "my-rooms"))))
         :my-rooms-tests))))))
