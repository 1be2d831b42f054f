;;;; text.lisp -- texts on one line or broken into lines, without what a terminal obeys.

(in-package :ars-magna.basics)

(export '(blank-p one-line cut visible obeyed-p sentence wrapped-text))

(defun blank-p (char)
  "True if CHAR is a space, newline or the like."
  (member char '(#\Space #\Tab #\Return #\Page #\Newline)))

(defun one-line (text)
  "Return TEXT with each run of blanks as one space."
  (string-trim " " (with-output-to-string (stream)
                     (loop for previous = #\Space then char
                           for char across text
                           for blank = (blank-p char)
                           unless (and blank (blank-p previous))
                             do (write-char (if blank #\Space char) stream)))))

(defun cut (text length)
  "Return TEXT, or its beginning if it is longer than LENGTH."
  (if (> (length text) length)
      (concatenate 'string (subseq text 0 (- length 3)) "...")
      text))

(defun sentence (text)
  "Return TEXT with a full stop, unless it ends in a question."
  (if (ends-with #\? text) text (format nil "~A." text)))

;;; Reports quote files and what was typed, where there may be anything.

(defun obeyed-p (char)
  "True if a terminal does something else with CHAR than to show it."
  (let ((code (char-code char)))
    (or (< code 32) (<= 127 code 159) (<= #x202A code #x202E) (<= #x2066 code #x2069))))

(defun visible (text)
  "Return TEXT with ^ and a letter, or a question mark, for each character that a terminal would
obey, but for newlines and tabs."
  (if (some #'obeyed-p text)
      (with-output-to-string (stream)
        (loop for char across text
              do (cond ((or (not (obeyed-p char)) (find char '(#\Newline #\Tab)))
                        (write-char char stream))
                       ((< (char-code char) 32)
                        (format stream "^~C" (code-char (+ 64 (char-code char)))))
                       (t (write-char #\? stream)))))
      text))

;;; A text in lines of a given length, broken between words.

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
