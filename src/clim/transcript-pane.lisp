;;;; transcript-pane.lisp -- the transcript on the screen: broken into rows, scrolled, selected.

(in-package :ars-magna.clim)

;;; It shows the end of the text unless the user has scrolled up. Then the view stays, as long as
;;; its lines are kept and until a line is entered. Dragging selects. The middle button pastes the
;;; selection, here and in other programs; it can also be copied.

(defclass transcript-pane (display-pane)
  (;; The number of the line that the user has scrolled to, or NIL for the newest, and how many
   ;; lines had been entered then.
   (scrolled :initform nil :accessor pane-scrolled)
   (entered :initform 0 :accessor pane-entered)
   ;; The rows in view, and where the first of them is.
   (rows :initform '() :accessor pane-rows)
   ;; Where the selection was begun and where it ends, each a list (number column), or NIL.
   (mark :initform nil :accessor pane-mark)
   (point :initform nil :accessor pane-point)))

(defun pane-transcript (pane) (window-transcript (window-of pane)))

(defmethod pane-appearance ((pane transcript-pane))
  (list (multiple-value-list (pane-size pane)) (pane-scrolled pane)
        (pane-mark pane) (pane-point pane) (transcript-total (pane-transcript pane))))

;;; Rows.

(defstruct (text-row (:constructor make-text-row (number start stop spans text)) (:copier nil))
  "A row on the screen: the part of line NUMBER of the transcript from character START to STOP.
SPANS are the coloured parts of the whole line, TEXT is the line without colours."
  (number 0 :type fixnum :read-only t)
  (start 0 :type fixnum :read-only t)
  (stop 0 :type fixnum :read-only t)
  (spans '() :type list :read-only t)
  (text "" :type string :read-only t))

(defun text-columns (text start end)
  "Return the width of TEXT from START to END on the screen, in columns."
  (reduce #'+ text :key #'ars-magna.cli:char-columns :start start :end end))

(defun column-end (text start columns)
  "Return the end of the part of TEXT from START on that fits in COLUMNS."
  (or (loop for position from start below (length text)
            sum (ars-magna.cli:char-columns (char text position)) into width
            when (< columns width) return position)
      (length text)))

(defun row-end (text start columns)
  "Return the index in TEXT where a row that begins at START ends. The row has at most COLUMNS
and ends after a blank, if possible."
  (let* ((end (column-end text start columns))
         (blank (and (< end (length text))
                     (position #\Space text :start start :end end :from-end t))))
    (if (and blank (< (+ start (floor (- end start) 2)) blank)) (1+ blank) end)))

(defun rows-of-line (number line columns)
  (loop with text = (ars-magna.cli:unpainted-text line)
        with spans = (ars-magna.cli:painted-spans line)
        for start = 0 then end
        for end = (row-end text start columns)
        collect (make-text-row number start end spans text)
        until (= end (length text))))

(defun columns-and-rows (pane)
  (let ((height (nth-value 1 (pane-size pane))))
    (values (max 10 (floor (- (content-width pane) 8) +character-width+))
            (max 1 (floor (- height 4) +line-height+)))))

(defun last-line-of-first-page (pane)
  "Return the number of the last line on the first page of the transcript of PANE, or NIL if the
transcript is shorter than a page."
  (let ((transcript (pane-transcript pane)))
    (multiple-value-bind (columns rows) (columns-and-rows pane)
      (loop for (number line) in (reverse (numbered-lines transcript
                                                          (transcript-count transcript)))
            sum (length (rows-of-line number line columns)) into above
            when (<= rows above) return number))))

(defun full-page-last-line (pane last)
  "Return the number of the line to show at the bottom of PANE: LAST or, if the page would not be
full, the least number that fills it. Return NIL for the newest line."
  (let ((oldest (last-line-of-first-page pane)))
    (and oldest
         (< last (transcript-newest (pane-transcript pane)))
         (max last oldest))))

(defun last-line-in-view (pane)
  "Return the number of the last line that PANE shows, or NIL if it is the newest line."
  (let ((scrolled (pane-scrolled pane)))
    (and scrolled
         (= (pane-entered pane) (transcript-entered (pane-transcript pane)))
         (full-page-last-line pane scrolled))))

(defun rows-in-view (pane count columns)
  "Return the rows that PANE shows, at most COUNT, each of at most COLUMNS characters."
  (let ((rows '()))
    (loop for (number line) in (numbered-lines (pane-transcript pane) count
                                               (last-line-in-view pane))
          while (< (length rows) count)
          ;; The newest line is empty most of the time: something may be written there.
          do (unless (and (null rows) (string= line ""))
               (setf rows (append (rows-of-line number line columns) rows))))
    (last rows count)))

;;; Painting.

(defparameter *ink-colors*
  '((:red #xB00020) (:lightred #xB00020) (:green #x006400) (:lightgreen #x006400)
    (:yellow #x7A4F00) (:lightyellow #x7A4F00) (:blue #x0000C0) (:lightblue #x0000C0)
    (:violet #x7A00A0) (:lightviolet #x7A00A0) (:cyan #x005A70) (:lightcyan #x005A70)
    (:grey #x606060))
  "Lists (ink color): the colour that the transcript uses for each ink of a terminal. The colours
are dark, because the transcript is white.")

(defconstant +selection-color+ #xB4D5FE "The background colour of selected text.")

(defun column-x (column) (+ 4 (* column +character-width+)))

(defun paint-glyphs-at-column (canvas text column y ink)
  (with-gcontext (draw-gcontext* :foreground (or (second (assoc ink *ink-colors*)) black*))
    (draw-glyphs canvas draw-gcontext* (column-x column) y text)))

(defun paint-text-row (canvas row y)
  (loop with column = 0
        for (text ink) in (text-row-spans row)
        for start = (max column (text-row-start row))
        for end = (min (+ column (length text)) (text-row-stop row))
        when (< start end)
          do (paint-glyphs-at-column canvas (subseq text (- start column) (- end column))
                                     (text-columns (text-row-text row) (text-row-start row) start)
                                     y ink)
        do (incf column (length text))))

(defun position-before-p (place other)
  (or (< (first place) (first other))
      (and (= (first place) (first other)) (< (second place) (second other)))))

(defun selection-bounds (pane)
  "Return start and end of the selection in PANE, lists (number column), or NIL if there is none."
  (let ((mark (pane-mark pane)) (point (pane-point pane)))
    (cond ((or (null mark) (null point) (equal mark point)) nil)
          ((position-before-p mark point) (values mark point))
          (t (values point mark)))))

(defun selected-columns (row from to)
  "Return the columns where the selected part of ROW starts and ends. The selection is between FROM
and TO, lists (number column)."
  (let ((number (text-row-number row)) (start (text-row-start row)) (stop (text-row-stop row)))
    (values (cond ((< number (first from)) stop)
                  ((= number (first from)) (max start (second from)))
                  (t start))
            (cond ((> number (first to)) start)
                  ((= number (first to)) (min stop (second to)))
                  (t stop)))))

(defun paint-selection-in-row (canvas row y from to)
  "Paint the background of the part of ROW selected between FROM and TO, lists (number column)."
  (multiple-value-bind (start stop) (selected-columns row from to)
    (when (< start stop)
      (with-gcontext (draw-gcontext* :foreground +selection-color+)
        (draw-rectangle canvas draw-gcontext*
                        (column-x (text-columns (text-row-text row) (text-row-start row) start))
                        (- y 12)
                        (* (text-columns (text-row-text row) start stop) +character-width+)
                        +line-height+ t)))))

(defmethod paint ((pane transcript-pane))
  (multiple-value-bind (columns rows) (columns-and-rows pane)
    (setf (window-text-size (window-of pane)) (list columns rows)
          (pane-rows pane) (rows-in-view pane rows columns)))
  (with-pane-canvas (canvas pane)
    (multiple-value-bind (from to) (selection-bounds pane)
      (loop for row in (pane-rows pane)
            for y from 14 by +line-height+
            do (when from (paint-selection-in-row canvas row y from to))
               (paint-text-row canvas row y)))))

;;; Scrolling.

(defun scroll-lines (pane count)
  "Scroll PANE down by COUNT lines, but not beyond the end of the transcript."
  (let ((transcript (pane-transcript pane)))
    (setf (pane-scrolled pane)
          (full-page-last-line pane (+ (or (last-line-in-view pane)
                                           (transcript-newest transcript))
                                       count))
          (pane-entered pane) (transcript-entered transcript))
    (repaint-if-changed pane)))

(defmethod scroll-state ((pane transcript-pane))
  (let* ((transcript (pane-transcript pane))
         (count (transcript-count transcript))
         (rows (nth-value 1 (columns-and-rows pane)))
         (last (last-line-in-view pane))
         (below (if last (- (transcript-newest transcript) last) 0)))
    (values (max 0 (- count rows below)) rows count)))

(defmethod limit-scroll-offset ((pane transcript-pane)) nil)

(defmethod scroll-to ((pane transcript-pane) position)
  (scroll-lines pane (round (- position (scroll-state pane)))))

(defmethod handle-wheel ((pane transcript-pane) steps x y)
  (declare (ignore x y))
  (scroll-lines pane (* 3 steps)))

(defun scroll-page (pane direction)
  "Scroll PANE by a page: down if DIRECTION is 1, up if it is -1."
  (scroll-lines pane (* direction (max 1 (1- (nth-value 1 (columns-and-rows pane)))))))

;;; Selecting.

(defun transcript-position-at (pane x y)
  "Return the position at X, Y of PANE, a list (number column), or NIL if PANE shows no text."
  (let* ((rows (pane-rows pane))
         (row (and rows (nth (clamp (floor (- y 2) +line-height+) 0 (1- (length rows))) rows))))
    (and row
         (list (text-row-number row)
               (min (column-end (text-row-text row) (text-row-start row)
                                (max 0 (round (- x 4) +character-width+)))
                    (text-row-stop row))))))

(defun selected-text (pane)
  "Return the selected text of PANE, or its whole transcript if nothing is selected."
  (let ((transcript (pane-transcript pane)))
    (multiple-value-bind (from to) (selection-bounds pane)
      (if from
          (text-between transcript from to)
          (format nil "~{~A~^~%~}"
                  (mapcar #'ars-magna.cli:unpainted-text
                          (latest-lines transcript (transcript-count transcript))))))))

(defmethod handle-click ((pane transcript-pane) button x y)
  (when (eq button :left)
    (setf (pane-drag pane) :text
          (pane-mark pane) (transcript-position-at pane x y)
          (pane-point pane) (pane-mark pane))
    (repaint-if-changed pane)))

(defmethod handle-drag ((pane transcript-pane) x y)
  (setf (pane-point pane) (transcript-position-at pane x y))
  (repaint-if-changed pane))

(defmethod handle-drop ((pane transcript-pane) x y)
  (declare (ignore x y))
  (when (selection-bounds pane) (offer-text (clim:port pane) (selected-text pane) '(:primary))))

(defmethod handle-hover ((pane transcript-pane) x y)
  (declare (ignore x y)))
