;;;; readtable.lisp -- the named readtable :NISP; (in-readtable :nisp) puts it to use.

(in-package :ars-magna.nisp)

(defun ensure-nisp-readtable ()
  "Return the readtable :NISP: standard syntax plus #t, #f, ! and ? (reading 31); and a byte order
mark, which some editors begin a file with, is as good as a space."
  (let ((readtable (or (find-readtable :nisp)
                       (make-readtable :nisp :merge '(:standard)))))
    (set-macro-character #\! 'read-bang t readtable)
    (set-macro-character #\? 'read-query t readtable)
    (set-dispatch-macro-character #\# #\t 'read-true readtable)
    (set-dispatch-macro-character #\# #\f 'read-false readtable)
    (set-syntax-from-char (code-char #xFEFF) #\Space readtable)
    readtable))

(dolist (character '(#\t #\f))
  (note-dispatch-character character
                           "Say (named-readtables:in-readtable :nisp) first: Nisp has #t and #f."))

(addition (in-readtable :nisp))
(ensure-nisp-readtable)
