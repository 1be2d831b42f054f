;;;; drawn-line.lisp -- drawing a line that is being typed on a terminal.

(in-package :ars-magna.cli)

(export '(visible-rows-of-line))

;;; The line is below all output: it is erased before output is written, and drawn again after that.
;;; It breaks into rows at the width of the window; if it has more rows than the window, those
;;; around the cursor are drawn. A window that becomes narrower breaks rows again, in the same way,
;;; so a row that continues in the next is not ended by a newline. It may push the first rows out at
;;; its top, so the line is drawn again when the window has changed.

(define-record drawn-line
  "A line that is being typed. SHOWN is true if the line is on the screen."
  (label "" string "the prompt that stands before the line. Can be set" :writable :export)
  (text "" string "what has been typed of the line. Can be set" :writable :export)
  (point 0 (integer 0) "where in the text of the line the cursor is. Can be set" :writable :export)
  (shown nil list "the label, text and point with which the line was drawn, in a list; NIL if the
line is not on the screen" :writable :export)
  (column 0 (integer 0) "the column of the cursor when the line was drawn last" :writable)
  (columns nil (or null (integer 0)) "the number of columns of the window when the line was drawn
last" :writable))

;;; Rows.

(defun displayed-chars (label text)
  "Return a list of the texts to show for the characters of LABEL (unchanged) and then of TEXT."
  (append (map 'list #'string label)
          (map 'list
               (lambda (char) (escape-controls (substitute #\Space #\Tab (string char))))
               text)))

(defun break-into-rows (label text point columns)
  "Break LABEL and TEXT into rows of at most COLUMNS. Return a list of lists (string end): END is
:NEWLINE, or NIL for a full row or the last row. Also return the row and column of POINT, in TEXT."
  (let ((rows '()) (out (make-string-output-stream)) (column 0) (place-row 0) (place-column 0))
    (labels ((end-row (how)
               (push (list (get-output-stream-string out) how) rows)
               (setf column 0))
             (note-place (position)
               (when (= position point)
                 (setf place-row (length rows)
                       place-column column)))
             (put (shown width)
               ;; A wide character may not fit although there is room for a narrow one.
               (when (> (+ column width) columns) (end-row :newline))
               (write-string shown out)
               (incf column width)
               (when (= column columns) (end-row nil))))
      (loop with widths = (columns-of-chars label)
            for shown in (displayed-chars label text)
            for position from (- (length label))
            do (note-place position)
               (cond ((string= shown (string #\Newline)) (end-row :newline))
                     ((minusp position)
                      (put shown (aref widths (+ position (length label)))))
                     (t (put shown (reduce #'+ shown :key #'char-columns)))))
      (note-place (length text))
      (end-row nil))
    (values (nreverse rows) place-row place-column)))

(defun visible-rows (rows place-row height)
  "Return the ROWS around PLACE-ROW that fit into HEIGHT, and the number of rows before them."
  (let ((start (max 0 (min (- place-row (floor height 2)) (- (length rows) height)))))
    (values (subseq rows start (min (length rows) (+ start height))) start)))

(defun visible-rows-of-line (label text point columns height)
  "Return a line's rows to show in a window of COLUMNS and HEIGHT, and the cursor's row and column."
  (multiple-value-bind (rows row column) (break-into-rows label text point columns)
    (multiple-value-bind (rows start) (visible-rows rows row height)
      (values rows (- row start) column))))

;;; Drawing.

(defun write-rows (rows stream)
  "Write ROWS to STREAM. Afterwards the cursor is in the last row."
  (loop for ((text how) . more) on rows
        do (write-string text stream)
           ;; The cursor leaves a full row only at the next character, not always for the next row.
           (when (and more (or how (string= "" (first (first more))))) (terpri stream))))

(defun draw-line (line stream columns height)
  "Draw LINE at the cursor, which is in the first column, in a window of COLUMNS and HEIGHT."
  (with-accessors ((label drawn-line-label) (text drawn-line-text) (point drawn-line-point)) line
    (multiple-value-bind (rows row column) (visible-rows-of-line label text point columns height)
      (write-rows rows stream)
      (format stream "~A~C~A" (cursor-up-code (- (length rows) row 1)) #\Return
              (cursor-right-code column))
      (setf (drawn-line-column line) column
            (drawn-line-columns line) columns))
    (setf (drawn-line-shown line) (list label text point))))

(defun erase-drawn-line (line stream columns height)
  "Erase LINE from the screen. Afterwards the cursor is where LINE began."
  (destructuring-bind (label text point) (shiftf (drawn-line-shown line) '())
    (format stream "~A~C~A"
            (cursor-up-code (nth-value 1 (visible-rows-of-line label text point columns height)))
            #\Return (clear-below-code))))
