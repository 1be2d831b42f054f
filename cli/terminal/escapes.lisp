;;;; escapes.lisp -- escape codes of terminals: colours, cursor, and how wide text is.

(in-package :ars-magna.cli)

(export '(paint painted-spans unpainted-text text-broken-at-blanks char-columns))

;;; Only this file has escape codes, those of all present terminals. Colours are the sixteen that
;;; users choose themselves, to suit the background; white and black are left for plain text.

(defparameter *inks*
  '(("RED" . "31") ("GREEN" . "32") ("YELLOW" . "33") ("BLUE" . "34") ("VIOLET" . "35")
    ("CYAN" . "36") ("GREY" . "90") ("LIGHTRED" . "91") ("LIGHTGREEN" . "92")
    ("LIGHTYELLOW" . "93") ("LIGHTBLUE" . "94") ("LIGHTVIOLET" . "95") ("LIGHTCYAN" . "96")
    ("GRAY" . "90") ("SILVER" . "90") ("ORANGE" . "33") ("BROWN" . "33") ("GOLD" . "93")
    ("PINK" . "95") ("PURPLE" . "35") ("MAGENTA" . "35") ("TURQUOISE" . "36")
    ("BOLD" . "1") ("REVERSE" . "1;7"))
  "Pairs (name . code): the terminal's codes for colours and styles.")

(defconstant +escape+ #\Escape "The beginning of the codes of terminals and of their keys.")

(defun format-escape-code (control &rest arguments)
  (format nil "~C[~?" +escape+ control arguments))

(defun ink-code (ink)
  (cdr (assoc (string ink) *inks* :test #'string-equal)))

(defun lines-in (text)
  (or (uiop:split-string text :separator '(#\Newline)) (list "")))

(defun paint (text ink)
  "Return TEXT with codes that show each line in the colour named INK; TEXT if INK is unknown."
  (let ((code (and ink (string/= text "") (ink-code ink))))
    (flet ((paint-line (line)
             (if (string= line "") line
                 (uiop:strcat (format-escape-code "~Am" code) line (format-escape-code "0m")))))
      (if (null code) text (format nil "~{~A~^~%~}" (mapcar #'paint-line (lines-in text)))))))

(defun ink-of-code (code)
  (let ((ink (rassoc code *inks* :test #'string=)))
    (and ink (make-keyword (car ink)))))

(defun painted-spans (text)
  "Return TEXT, a line coloured by PAINT, as lists (text ink); INK is a keyword, NIL if unpainted."
  (let ((spans '()) (ink nil) (start 0))
    (loop
      (let ((escape (position +escape+ text :start start)))
        (unless (= start (or escape (length text)))
          (push (list (subseq text start escape) ink) spans))
        (unless escape (return (nreverse spans)))
        (let ((end (or (position #\m text :start escape) (1- (length text)))))
          (setf ink (ink-of-code (subseq text (min end (+ 2 escape)) end))
                start (1+ end)))))))

(defun unpainted-text (text)
  "Return TEXT without the escape codes of PAINT."
  (format nil "~:{~A~}" (painted-spans text)))

;;; Are colours wanted?

(define-constant +color-settings+ '("auto" "always" "never") :test #'equal
  :documentation "The values of the option --color.")

(defun color-wanted-p (setting stream)
  "True if output to STREAM should have colours. SETTING is :ALWAYS, :NEVER or :AUTO. With :AUTO,
only a terminal has colours, and only if the environment variable NO_COLOR is not set."
  (ecase setting
    (:always t)
    (:never nil)
    (:auto (and (terminal-stream-p stream)
                (not (member (environment-value "TERM") '(nil "" "dumb") :test #'equal))
                (member (environment-value "NO_COLOR") '(nil "") :test #'equal)
                t))))

;;; Moving the cursor, and erasing.

(defun cursor-up-code (count)
  (if (plusp count) (format-escape-code "~DA" count) ""))

(defun cursor-right-code (count)
  (if (plusp count) (format-escape-code "~DC" count) ""))

(defun clear-row-code ()
  "Return the code that erases the rest of the row after the cursor."
  (format-escape-code "K"))

(defun clear-below-code ()
  "Return the code that erases the rest of the screen after the cursor."
  (format-escape-code "J"))

(defun clear-window-code ()
  "Return the code that erases everything and moves the cursor to the upper left."
  (format nil "~A~A" (format-escape-code "H") (format-escape-code "2J")))

;;; What is pasted.

(defun paste-marking-code (on)
  "Return the code that switches bracketed paste mode (pasted text is marked) on, or off."
  (format-escape-code "?2004~:[l~;h~]" on))

(defun paste-end-code ()
  "Return the code that a terminal sends after pasted text."
  (format-escape-code "201~~"))

;;; A separate screen, for output that is updated in place.

(defun begin-screen-code ()
  "Return the code that saves the terminal's screen and shows an empty one without cursor."
  (format nil "~A~A~A" (format-escape-code "?1049h") (format-escape-code "?25l")
          (format-escape-code "2J")))

(defun end-screen-code ()
  "Return the code that restores the cursor and the screen that BEGIN-SCREEN-CODE saved."
  (format nil "~A~A" (format-escape-code "?25h") (format-escape-code "?1049l")))

(defun overwrite-screen-code (text)
  "Return the code that overwrites the whole screen with the lines of TEXT."
  (with-output-to-string (out)
    (write-string (format-escape-code "H") out)
    (loop for start = 0 then (1+ end)
          for end = (position #\Newline text :start start)
          do (format out "~A~A" (subseq text start end) (clear-row-code))
          when end do (format out "~C~%" #\Return)
          while end)
    (write-string (clear-below-code) out)))

;;;; Columns

;;; Accents have no column of their own, East Asian characters have two. Codes that terminals
;;; interpret, such as those for colours, have none.

(defun char-columns (char)
  "Return the width of CHAR at a terminal, in columns: 0, 1 or 2."
  (if (< (char-code char) 256) 1 (char-width char)))

(defun columns-of-chars (text)
  "Return a vector with the width of each character of TEXT, in columns."
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

;;; Long lines are broken between words.

(defun line-break-position (line columns)
  "Return the position of the blank at which to break LINE. The part before that blank has at most
COLUMNS, if possible. Return NIL if LINE fits into COLUMNS or has no blank."
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
  "True if LINE, indented by INDENT, is a row of a table or map: it contains a gap of two blanks. A
gap after a label, as in \"Time:    Tick 0\", does not count."
  (let ((colon (position #\: line :start indent)))
    (search "  " line :start2 (or (and colon
                                       (null (search "  " line :start2 indent :end2 colon))
                                       (position #\Space line :start (1+ colon) :test #'char/=))
                                  indent))))

(defun break-line-at-blanks (line first columns)
  "Break LINE at blanks into lines of at most COLUMNS, the first of at most FIRST. Return the list
of these lines. All lines are indented like LINE."
  (let ((place (line-break-position line first))
        (indent (or (position #\Space line :test #'char/=) 0)))
    (if (and place (not (table-line-p line indent)))
        (cons (string-right-trim " " (subseq line 0 place))
              (break-line-at-blanks (format nil "~VA~A" indent ""
                                            (string-left-trim " " (subseq line place)))
                                    columns columns))
        (list line))))

(defun text-broken-at-blanks (text columns &optional (used 0))
  "Return TEXT with lines of at most COLUMNS, broken at blanks; the first has USED columns fewer."
  (loop with lines = (uiop:split-string text :separator '(#\Newline))
        for line in lines
        for first = (- columns used) then columns
        append (break-line-at-blanks line first columns) into all
        finally (return (format nil "~{~A~^~%~}" all))))
