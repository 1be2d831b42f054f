;;;; versions.lisp -- the versions of SBCL that were tried, its internal names, and wrappers.

(in-package :ars-magna.host)

(export '(untested-version-text wrap-function unwrap-function wrapped-p))

;;; Internal names of SBCL change. INTERNAL looks a name up when a file of this folder is compiled,
;;; among all names that it has had, and fails with a clear error. No file names such a symbol
;;; directly, so every file can be read. All files here were tested with the same versions.

(eval-when (:compile-toplevel :load-toplevel :execute)

  (defparameter *tried-versions* '("2.2.9" "2.5.2" "2.6.4")
    "The versions of SBCL with which the tests pass, oldest first.")

  (defun find-internal (package names)
    "Return the first symbol of NAMES, strings or symbols, that SBCL's PACKAGE has, or NIL."
    (let ((package (find-package package)))
      (and package
           (some (lambda (name) (find-symbol (string name) package)) names))))

  (defun internal-name (package &rest names)
    "Return the first symbol among NAMES that SBCL's PACKAGE has. Signals an ERROR if it has none."
    (or (find-internal package names)
        (error "SBCL ~A has no ~A:~{~A~^ or ~}. ARS MAGNA runs on SBCL ~A to ~A. Use one of ~
                these, or add the new name to the files in src/host."
               (lisp-implementation-version) package names
               (first *tried-versions*) (first (last *tried-versions*))))))

(defmacro internal ((package &rest names) &rest arguments)
  "Call the first function or macro among NAMES that SBCL's PACKAGE has. Also a place for SETF."
  `(,(apply #'internal-name package names) ,@arguments))

(defmacro if-internal ((package &rest names) then else)
  "Compile and evaluate only THEN if SBCL's PACKAGE has one of NAMES, else only ELSE."
  (if (find-internal package names) then else))

(defmacro internal-value (package &rest names)
  "Return the value of the first variable or constant among NAMES that SBCL's PACKAGE has."
  (apply #'internal-name package names))

(defmacro internal-type-p (object package &rest names)
  "True if OBJECT is of the first type among NAMES that SBCL's PACKAGE has."
  `(typep ,object ',(apply #'internal-name package names)))

(defun later-version-p (version other)
  "True if VERSION, a string such as \"2.5.2.debian\", is a later version than OTHER."
  (flet ((numbers (version)
           (let ((end (position-if-not (lambda (char) (find char ".0123456789")) version)))
             (string-right-trim "." (subseq version 0 end)))))
    (uiop:version< (numbers other) (numbers version))))

(defun untested-version-text (&optional (version (lisp-implementation-version)))
  "Return a warning if the VERSION of SBCL is later or earlier than all tested versions; else NIL."
  (flet ((sentence (than)
           (format nil "SBCL ~A is ~A than the versions ARS MAGNA was tested with, ~A to ~A."
                   version than (first *tried-versions*) (first (last *tried-versions*)))))
    (cond ((later-version-p version (first (last *tried-versions*))) (sentence "newer"))
          ((later-version-p (first *tried-versions*) version) (sentence "older")))))

(format *error-output* "~@[~&ars-magna: ~A~%~]" (untested-version-text))

;;;; Functions of SBCL or a library, wrapped by ours

(defun wrap-function (name wrapper &optional (type 'ars-magna))
  "Wrap NAME, a function of SBCL or a library: WRAPPER is called instead, with the original function
and its arguments. A second wrapper of the same TYPE, a symbol, replaces the first."
  (internal (:sb-int #:encapsulate) name type wrapper))

(defun unwrap-function (name &optional (type 'ars-magna))
  "Undo WRAP-FUNCTION."
  (internal (:sb-int #:unencapsulate) name type))

(defun wrapped-p (name &optional (type 'ars-magna))
  "True if the function NAME has a wrapper of TYPE, a symbol."
  (internal (:sb-int #:encapsulated-p) name type))
