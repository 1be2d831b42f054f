;;;; clx.lisp -- getting McCLIM, and whether the CLX that ASDF finds works on this SBCL.

;;; CLX is the library by which McCLIM talks to the X server. Up to version 0.7.5 it reads with an
;;; internal function of SBCL's, READ-N-BYTES, whose last argument became an end instead of a count
;;; in SBCL 2.4.7. Since then such a CLX opens a display, but misreads every answer of the X server
;;; that is longer than 32 bytes. Newer ones read with READ-SEQUENCE, in the file common.lisp.
;;; Debian 13 has SBCL 2.5.2 and CLX 0.7.5.

;;; cli/build.lisp, too, loads this file, into a bare SBCL, for its answer before compiling McCLIM.

(defpackage :ars-magna.clx
  (:documentation "Checks which version of CLX ASDF finds, and whether it works on this SBCL.")
  (:use :cl)
  (:export #:library-text #:clx-trouble #:*clx-remedy*
           #:find-library #:quicklisp-file #:load-by-quicklisp))

(in-package :ars-magna.clx)

(defvar *clx-remedy*
  (format nil "Install CLX 0.7.6 or newer where ASDF finds it first, for example with: ~
               git clone https://github.com/sharplispers/clx ~~/common-lisp/clx")
  "Text that tells users how to install a version of CLX that works.")

(defun find-library (name)
  "Return the ASDF system of the library named NAME, such as CLX, or NIL."
  (let ((*standard-output* (make-broadcast-stream)) (*error-output* (make-broadcast-stream)))
    (ignore-errors (asdf:find-system (string-downcase name) nil))))

(defun quicklisp-file ()
  "Return the file that loads Quicklisp, where the user has installed it, or NIL."
  (probe-file (merge-pathnames "quicklisp/setup.lisp" (user-homedir-pathname))))

(defun load-by-quicklisp ()
  "Fetch McCLIM with Quicklisp, if necessary, and load it."
  (unless (find-package :quicklisp) (load (quicklisp-file)))
  (uiop:symbol-call :quicklisp :quickload "mcclim/looks"))

(defun library-text (name &optional (system (find-library name)))
  "Return text: NAME of a library, and version and directory of its ASDF SYSTEM, which may be NIL."
  (format nil "~A~@[ ~A~]~@[ in ~A~]" name
          (and system (asdf:component-version system))
          (and system (asdf:system-source-directory system))))

(defun leading-numbers (version)
  "Return the numbers at the beginning of VERSION, a string: for 2.5.2.debian, return 2.5.2."
  (let ((end (position-if-not (lambda (char) (find char "0123456789.")) version)))
    (string-right-trim "." (subseq version 0 end))))

(defun clx-trouble (&optional (clx (find-library "CLX"))
                      (lisp-version (lisp-implementation-version)))
  "Return text on why CLX fails on SBCL LISP-VERSION and what to do; NIL if no problem is known."
  (when (and clx
             (uiop:version<= "2.4.7" (leading-numbers lisp-version))
             (null (asdf:find-component clx "common")))
    (format nil "~A does not work on SBCL ~A. ~A"
            (library-text "CLX" clx) lisp-version *clx-remedy*)))
