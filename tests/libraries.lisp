;;;; libraries.lisp -- systems that ASDF compiles while Nisp's syntax is current.

(in-package :ars-magna.tests)

(def-suite* libraries :in ars-magna)

(defparameter *library*
  '((";;; library.asd"
     "(defsystem \"library\" :serial t"
     "  :components ((:file \"plain\") (:file \"syntax\") (:file \"later\") (:file \"own\")))")
    (";;; plain.lisp"
     "(defpackage :library (:use :cl))"
     "(in-package :library)"
     "(defun marks () '(?x !y ?one.two))")
    (";;; syntax.lisp"
     "(in-package :library)"
     "(set-macro-character #\\% (lambda (stream char) (list char (read stream t nil t))))")
    (";;; later.lisp"
     "(in-package :library)"
     "(defun later () '%z)")
    (";;; own.lisp"
     "(ars:define-user-package :library-own)"
     "(in-package :library-own)"
     "(in-readtable :nisp)"
     "(defun own () (list #t '?x))"))
  "Files, as lists of lines: a library in standard syntax, and a file in Nisp's syntax.")

(defparameter *what-the-library-has*
  "(let ((*package* (find-package :cl-user)) (*readtable* (copy-readtable nil)))
     (write (list (uiop:symbol-call :library '#:marks) (uiop:symbol-call :library '#:later)
                  (find-symbol \"?X\" :ars-user)
                  (type-of (second (uiop:symbol-call :library-own '#:own))))
            :pretty nil))")

(defun form-loading-library (directory start)
  "Return the text of forms that do START, load the library in DIRECTORY with a cache of its own,
and print *WHAT-THE-LIBRARY-HAS*."
  (format nil "(progn
                 (asdf:initialize-output-translations
                  '(:output-translations (~S ~S) :inherit-configuration))
                 ~A
                 (let ((*standard-output* (make-broadcast-stream)))
                   (asdf:load-asd ~S)
                   (asdf:load-system \"library\"))
                 ~A)"
          (namestring directory) (namestring (uiop:subpathname directory "cache/"))
          start (namestring (uiop:subpathname directory "library.asd")) *what-the-library-has*))

(test libraries.are-read-as-anywhere-else
  "Also if they are first compiled after (in-readtable :nisp); the compiled files work in the next
Lisp. A file that itself asks for Nisp's syntax has it."
  (call-in-new-directory
   (lambda (directory)
     (write-files *library* directory)
     (let ((expected "((LIBRARY::?X LIBRARY::!Y LIBRARY::?ONE.TWO) (#\\% LIBRARY::Z) NIL ~
                      ARS-MAGNA.NISP:MATCHVAR)"))
       (dolist (start '("(setf *package* (find-package :ars-user))
                         (eval '(nisp:in-readtable :nisp))"
                        ""))
         (is (equal (format nil expected)
                    (printed-in-child "ars-magna" (form-loading-library directory start)))
             "after ~A" start))))))
