;;;; printing.lisp -- what files and other programs get does not follow the printer's variables.

(in-package :ars-magna.basics)

(export '(call-printing-plainly printing-plainly printing-words print-named))

;;; *PRINT-BASE* and its kin are the user's, and for what he reads at his REPL. Whoever writes data,
;;; a table, a picture, JSON, is not to follow them.

(defun call-printing-plainly (function)
  "Call FUNCTION with the printer's variables as a fresh Lisp has them, but without pretty printing.
Return its values."
  (let ((*print-base* 10) (*print-radix* nil) (*print-case* :upcase) (*print-pretty* nil)
        (*print-readably* nil) (*print-escape* t) (*print-circle* nil) (*print-length* nil)
        (*print-level* nil) (*print-lines* nil) (*print-right-margin* nil) (*print-array* t)
        (*print-gensym* t) (*read-default-float-format* 'single-float))
    (funcall function)))

(defmacro printing-plainly (() &body body)
  "Run BODY, which writes data, as CALL-PRINTING-PLAINLY would a function."
  (form-calling 'call-printing-plainly body))

(defun print-named (object stream name &optional (whole name))
  "Print OBJECT to STREAM: for PRINC as NAME, a symbol or string, else unreadably as WHOLE."
  (if (or *print-escape* *print-readably*)
      (print-unreadable-object (object stream) (princ whole stream))
      (princ name stream)))

;;; So does what the simulator says to people: its numbers are decimal, its lists whole.

(defmacro printing-words (() &body body)
  "Run BODY, which makes text for people, with the printer's variables that change numbers, names
and lists as a fresh Lisp has them."
  `(let ((*print-base* 10) (*print-radix* nil) (*print-case* :upcase) (*print-length* nil)
         (*print-level* nil) (*print-lines* nil) (*print-readably* nil) (*print-array* t))
     ,@body))
