;;;; columns.lisp -- how many columns of a terminal text takes, and where it is broken.

(in-package :ars-magna.cli)

(export '(broken-text))

;;; Accents take no column of their own, the characters of East Asia two. Codes that terminals obey,
;;; such as those for colours, take none.

(defun char-columns (char)
  (if (< (char-code char) 256) 1 (char-width char)))

(defun columns-of-chars (text)
  "Return a vector of how many columns each character of TEXT takes."
  (loop with columns = (map 'vector #'char-columns text)
        with position = 0
        while (< position (length text))
        do (let ((end (and (char= +escape+ (char text position))
                           (let ((letter (position-if #'alpha-char-p text :start position)))
                             (and letter (1+ letter))))))
             (when end (fill columns 0 :start position :end end))
             (setf position (or end (1+ position))))
        finally (return columns)))

(defun text-columns (text)
  (reduce #'+ (columns-of-chars text)))

;;; Lines that are too long are broken between words.

(defun breaking-point (line columns)
  "Return where LINE is to be broken so that what comes before takes no more than COLUMNS: at the
last blank in time, or else the first; NIL if it need not be broken or has no blank."
  (loop with start = (position #\Space line :test #'char/=)
        with best = nil and taken = 0
        for char across line
        for columns-of-char across (columns-of-chars line)
        for position from 0
        do (when (and start (< start position) (char= char #\Space)
                      (or (null best) (<= taken columns)))
             (setf best position))
           (incf taken columns-of-char)
           (when (and best (> taken columns)) (return best))))

(defun table-line-p (line indent)
  "True if LINE, indented by INDENT, is not to be read as a sentence: it has gaps, as a table or a
map has, but for one behind a label, such as STATUS has: \"Time:    Tick 0\"."
  (let ((colon (position #\: line :start indent)))
    (search "  " line :start2 (or (and colon
                                       (null (search "  " line :start2 indent :end2 colon))
                                       (position #\Space line :start (1+ colon) :test #'char/=))
                                  indent))))

(defun pieces-of-line (line first columns)
  "Return LINE as a list of lines of at most COLUMNS, the first of FIRST, as far as blanks allow.
What goes on is indented as far as LINE is."
  (let ((place (breaking-point line first))
        (indent (or (position #\Space line :test #'char/=) 0)))
    (if (and place (not (table-line-p line indent)))
        (cons (string-right-trim " " (subseq line 0 place))
              (pieces-of-line (format nil "~VA~A" indent ""
                                      (string-left-trim " " (subseq line place)))
                              columns columns))
        (list line))))

(defun broken-text (text columns &optional (used 0))
  "Return TEXT with its lines broken so that each takes at most COLUMNS, if blanks allow it. Its
first line begins after USED columns."
  (loop with lines = (uiop:split-string text :separator '(#\Newline))
        for line in lines
        for first = (- columns used) then columns
        append (pieces-of-line line first columns) into all
        finally (return (format nil "~{~A~^~%~}" all))))
