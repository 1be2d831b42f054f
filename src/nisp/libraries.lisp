;;;; libraries.lisp -- what ASDF compiles while Nisp's syntax is current is read as anywhere else.

(in-package :ars-magna.nisp)

;;; ASDF keeps what it compiles, for all Lisps of the user. Files are read in the syntax and package
;;; that are current until they say otherwise; so whoever asks for a library after
;;; (in-readtable :nisp) would have it compiled in Nisp's syntax, and have it so ever after.

(defvar *library-readtable* (copy-readtable nil)
  "The syntax of files of systems that say nothing of theirs, if Nisp's is current. It is one, since
there are libraries of which one file adds to the syntax of the next.")

(defun nisp-syntax-p (readtable)
  "True if READTABLE is :NISP, or a copy of it."
  (eq (get-macro-character #\! (find-readtable :nisp)) (get-macro-character #\! readtable)))

(defmethod asdf:perform :around ((operation asdf:operation) (component asdf:cl-source-file))
  (if (nisp-syntax-p *readtable*)
      (let ((*readtable* *library-readtable*)
            (*package* (find-package :cl-user)))
        (call-next-method))
      (call-next-method)))
