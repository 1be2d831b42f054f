;;;; package.lisp -- the host layer: everything of SBCL that its manual does not document.

(defpackage :ars-magna.host
  (:documentation "What the simulator needs of SBCL beyond its documented packages, one idea per
file. No other folder names such parts of SBCL.")
  (:use :cl))

(in-package :ars-magna.host)

(export 'define-package)

(defmacro define-package (name &body options)
  "Define the package NAME as DEFPACKAGE does. What it exports stands in its files: so a package
that is defined again, as in an editor, exports what it did."
  (let ((exported '()))
    (when (find-package name)
      (do-external-symbols (symbol name) (push (make-symbol (symbol-name symbol)) exported)))
    `(defpackage ,name ,@options (:export ,@exported))))
