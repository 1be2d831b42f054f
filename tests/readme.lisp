;;;; readme.lisp -- what the first page shows works, typed as it stands there.

(in-package :ars-magna.tests)

(def-suite* readme :in ars-magna)

(defun first-page () (project-file "README.md"))

(defparameter *lengthy* '("three-ways-of-searching" "ars-magna/fiveam")
  "Words of the blocks that take long, and are run elsewhere.")

(defun block-to-run-p (text)
  (notany (lambda (words) (search words text)) *lengthy*))

(defun call-in-new-directory (function)
  "Call FUNCTION with a new directory, which is where files go meanwhile; delete it."
  (let ((directory (uiop:ensure-directory-pathname
                    (format nil "~Aars-magna-~36R/" (namestring (uiop:temporary-directory))
                            (random (expt 36 8) (make-random-state t))))))
    (ensure-directories-exist directory)
    (unwind-protect (let ((*default-pathname-defaults* directory)) (funcall function directory))
      (uiop:delete-directory-tree directory :validate t :if-does-not-exist :ignore))))

(defun call-as-newcomer (function)
  "Call FUNCTION in ARS-USER; forget what it defines, and the packages of the first page."
  (let ((*package* (find-package :ars-user)) (*readtable* (copy-readtable nil)))
    (unwind-protect (base:with-own-definitions () (funcall function))
      (ignore-errors (run:stop-simulator))
      (dolist (name '(:my-house :my-rooms-tests :my-rooms))
        (when (find-package name) (delete-package name))))))

(defun said-by-block (text)
  "Evaluate the forms in TEXT. Return what they write."
  (with-output-to-string (out)
    (let ((*standard-output* out))
      (with-input-from-string (in text)
        (loop for form = (read in nil in)
              until (eq form in)
              do (handler-bind ((warning #'muffle-warning)) (eval form)))))))

(test readme.runs-from-top-to-bottom
  (call-in-new-directory
   (lambda (directory)
     (declare (ignore directory))
     (call-as-newcomer
      (lambda ()
        (let ((blocks (remove-if-not #'block-to-run-p (lisp-blocks (first-page)))))
          (is (< 6 (length blocks)))
          (let ((said (joined (loop for text in blocks
                                    collect (finishes-saying text)))))
            (is-true (has-words-p said "stopped by a wall at tick" ":ROBOT-BLOCKED")))
          (is-true (probe-file "run.csv"))))))))

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
     (write-files (blocks-of "common-lisp" (first-page)) directory)
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
