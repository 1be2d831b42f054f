;;;; breaking-lines.lisp -- a text in lines of a given length, broken between words.

(in-package :ars-magna.basics)

(export '(wrapped-text))

(defun break-place (text width)
  "Return where the first line of TEXT, WIDTH characters at most, ends."
  (flet ((last-place (character)
           (position character text :end (1+ width) :from-end t :start 1)))
    (cond ((<= (length text) width) (length text))
          ((last-place #\Space))
          ((last-place #\No-break_space))
          (t width))))

(defun wrapped-text (text width)
  "Return TEXT, of one line, as a list of lines of at most WIDTH characters, one at least. A line
ends at a no-break space, which becomes a space, only if it cannot end at another."
  (loop with blanks = '(#\Space #\No-break_space)
        with rest = (string-trim blanks text)
        for end = (break-place rest width)
        collect (substitute #\Space #\No-break_space (string-right-trim blanks (subseq rest 0 end)))
        do (setf rest (string-left-trim blanks (subseq rest end)))
        until (string= "" rest)))
