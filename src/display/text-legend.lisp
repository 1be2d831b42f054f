;;;; text-legend.lisp -- what the characters of a text map mean, in the room that there is.

(in-package :ars-magna.display)

;;; Robots come first; then, by their characters, what was asked for, walls, places and things. If
;;; there is not room enough below the map, these go beside it; and if that does not do, the rest is
;;; counted.

(defun kind-rank (glyph)
  (position (glyph-kind glyph) '(:robot :layer :wall :several :place :thing)))

(defun glyph< (a b)
  (let ((rank-a (kind-rank a)) (rank-b (kind-rank b))
        (char-a (glyph-char a)) (char-b (glyph-char b)))
    (cond ((/= rank-a rank-b) (< rank-a rank-b))
          ((char-not-equal char-a char-b)
           (or (char= +other+ char-b)
               (and (char/= +other+ char-a) (char-lessp char-a char-b))))
          ((char/= char-a char-b) (char> char-a char-b))
          (t (name-before-p (glyph-text a) (glyph-text b))))))

(defun sorted-legend (sheet)
  (sort (copy-list (sheet-legend sheet)) #'glyph<))

(defun in-head-p (glyph)
  (eq :robot (glyph-kind glyph)))

;;; An entry is a pair of how many characters it takes and of what is written.

(defun entry-of-text (text) (cons (length text) text))

(defun entry-of-glyph (glyph paint &optional (width 1000))
  "Return the entry of GLYPH, as PAINT has it in its colour, of no more than WIDTH characters."
  (let ((text (glyph-text glyph)))
    (setf text (subseq text 0 (min (length text) (- width 2))))
    (cons (+ 2 (length text))
          (format nil "~A ~A" (funcall paint (string (glyph-char glyph)) (glyph-ink glyph)) text))))

(defun entries-of (glyphs paint)
  (mapcar (lambda (glyph) (entry-of-glyph glyph paint)) glyphs))

(defun filled (entries columns)
  "Return ENTRIES as lines of at most COLUMNS characters, if they are not longer themselves: a list
of lists."
  (loop with lines = '() and used = 0
        for entry in entries
        do (cond ((and lines (<= (+ used 3 (car entry)) columns))
                  (push entry (first lines))
                  (incf used (+ 3 (car entry))))
                 (t (push (list entry) lines)
                    (setf used (car entry))))
        finally (return (nreverse (mapcar #'reverse lines)))))

(defun write-entries (lines stream)
  (dolist (line lines)
    (format stream "~{~A~^   ~}~%" (mapcar #'cdr line))))

(defun head-entries (sheet paint)
  "Return the entries of the legend of SHEET that always stand below it."
  (let ((view (sheet-view sheet)))
    (append (when (< 1 (max (view-wide view) (view-high view)))
              (list (entry-of-text (format nil "Each character is ~D x ~D cells."
                                           (view-wide view) (view-high view)))))
            (entries-of (remove-if-not #'in-head-p (sorted-legend sheet)) paint))))

(defun tail-glyphs (sheet)
  "Return the glyphs of SHEET whose entries stand wherever there is room."
  (remove-if #'in-head-p (sorted-legend sheet)))

(defun whole-legend (sheet columns paint)
  "Return all that the legend of SHEET says, as lines of COLUMNS characters."
  (filled (append (head-entries sheet paint) (entries-of (tail-glyphs sheet) paint)) columns))

;;; Beside the map.

(define-constant +least-side+ 12
  :documentation "How many characters wide a legend beside a map has to be able to be.")

(defun side-columns (glyphs room)
  "Return how many columns of entries for GLYPHS there are in ROOM characters, and how wide each is;
NIL if they would be too narrow."
  (let ((longest (+ 2 (loop for glyph in glyphs maximize (length (glyph-text glyph))))))
    (when (<= +least-side+ room)
      (let ((width (min room longest)))
        (values (max 1 (floor (+ room 2) (+ width 2))) width)))))

(defun side-legend (glyphs room rows paint)
  "Return what stands beside each of ROWS lines of a map, a vector of lists of entries, each padded,
and those of GLYPHS for which there is none of ROOM characters."
  (multiple-value-bind (columns width) (side-columns glyphs room)
    (let ((lines (make-array rows :initial-element '()))
          (count (* rows (or columns 0))))
      (loop for glyph in glyphs
            for position from 0 below count
            do (destructuring-bind (length . text) (entry-of-glyph glyph paint width)
                 (push (format nil "  ~A~VA" text (- width length) "")
                       (svref lines (mod position rows)))))
      (values (cl:map 'vector #'reverse lines)
              (nthcdr count glyphs)))))

;;; Below it.

(defun with-remark (head entries columns rows)
  "Return lines of HEAD and ENTRIES, no more than ROWS of COLUMNS characters; for which of ENTRIES
there is no room is counted in the last, if there is room for that. ROWS may be NIL."
  (flet ((kept (count &rest more)
           (filled (append head (subseq entries 0 count) more) columns))
         (fits-p (lines) (or (null rows) (<= (length lines) rows))))
    (if (fits-p (kept (length entries)))
        (kept (length entries))
        (loop for count from (1- (length entries)) downto 0
              for remark = (entry-of-text (format nil "and ~D more: MAP LEGEND"
                                                  (- (length entries) count)))
              when (fits-p (kept count remark)) return (kept count remark)
              finally (return (kept 0))))))
