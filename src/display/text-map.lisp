;;;; text-map.lisp -- the world as characters, for terminals, with a legend beside or below.

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

(defun text-item (text) (cons (length text) text))

(defun glyph-item (glyph paint &optional (width 1000))
  "Return the entry of GLYPH, as PAINT has it in its colour, of no more than WIDTH characters."
  (let ((text (glyph-text glyph)))
    (setf text (subseq text 0 (min (length text) (- width 2))))
    (cons (+ 2 (length text))
          (format nil "~A ~A" (funcall paint (string (glyph-char glyph)) (glyph-ink glyph)) text))))

(defun glyph-items (glyphs paint)
  (mapcar (lambda (glyph) (glyph-item glyph paint)) glyphs))

(defun fill-lines (entries columns)
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

(defun write-items (lines stream)
  (dolist (line lines)
    (format stream "~{~A~^   ~}~%" (mapcar #'cdr line))))

(defun head-items (sheet paint)
  "Return the entries of the legend of SHEET that always stand below it."
  (let ((view (sheet-view sheet)))
    (append (when (< 1 (max (view-wide view) (view-high view)))
              (list (text-item (format nil "Each character is ~D x ~D cells."
                                           (view-wide view) (view-high view)))))
            (glyph-items (remove-if-not #'in-head-p (sorted-legend sheet)) paint))))

(defun tail-glyphs (sheet)
  "Return the glyphs of SHEET whose entries stand wherever there is room."
  (remove-if #'in-head-p (sorted-legend sheet)))

(defun whole-legend (sheet columns paint)
  "Return all that the legend of SHEET says, as lines of COLUMNS characters."
  (fill-lines (append (head-items sheet paint) (glyph-items (tail-glyphs sheet) paint)) columns))

;;; Beside the map.

(defconstant +least-side+ 12 "The least characters for a legend beside a map.")

(defun side-legend (glyphs room rows paint)
  "Return what stands beside each of ROWS lines of a map, a vector of lists of entries, each padded,
and those of GLYPHS for which there is none of ROOM characters."
  (let* ((longest (loop for glyph in glyphs maximize (length (glyph-text glyph))))
         (width (min room (+ 2 longest)))
         (columns (if (<= +least-side+ room) (max 1 (floor (+ room 2) (+ width 2))) 0))
         (lines (make-array rows :initial-element '())))
    (loop for glyph in glyphs
          for position from 0 below (* rows columns)
          do (destructuring-bind (length . text) (glyph-item glyph paint width)
               (push (format nil "  ~A~VA" text (- width length) "")
                     (svref lines (mod position rows)))))
    (values (cl:map 'vector #'reverse lines)
            (nthcdr (* rows columns) glyphs))))

;;; Below it.

(defun lines-with-count (head entries columns rows)
  "Return lines of HEAD and ENTRIES, no more than ROWS of COLUMNS characters; for which of ENTRIES
there is no room is counted in the last, if there is room for that. ROWS may be NIL."
  (flet ((kept (count &rest more)
           (fill-lines (append head (subseq entries 0 count) more) columns))
         (fits-p (lines) (or (null rows) (<= (length lines) rows))))
    (if (fits-p (kept (length entries)))
        (kept (length entries))
        (loop for count from (1- (length entries)) downto 0
              for remark = (text-item (format nil "and ~D more: MAP LEGEND"
                                                  (- (length entries) count)))
              when (fits-p (kept count remark)) return (kept count remark)
              finally (return (kept 0))))))

;;;; The map

;;; Nothing is changed by looking, and no dice are rolled. Where lines count, as on a terminal, the
;;; map is made to fit; elsewhere only how wide it is counts, and blocks of cells are square.

(defconstant +margin-columns+ 5 "How many characters stand left of a text map.")

(defun unpainted (text ink)
  (declare (ignore ink))
  text)

(defun write-row (sheet row paint stream)
  "Write ROW of SHEET, as PAINT has it in colours; return how many characters that is."
  (let ((glyphs (row-glyphs sheet row)) (view (sheet-view sheet)))
    (format stream "~4D " (+ (view-top view) (* row (view-high view))))
    (loop with rest = glyphs
          while rest
          do (let* ((ink (and (first rest) (glyph-ink (first rest))))
                    (end (member ink rest :test-not #'eq
                                          :key (lambda (glyph) (and glyph (glyph-ink glyph)))))
                    (run (ldiff rest end)))
               (write-string (funcall paint (cl:map 'string
                                                    (lambda (glyph)
                                                      (if glyph (glyph-char glyph) #\Space))
                                                    run)
                                      ink)
                             stream)
               (setf rest end)))
    (length glyphs)))

(defun write-ruler (view stream)
  "Write the x coordinate of every tenth column."
  (let ((marks (loop for column from 0 below (view-columns view) by 10
                     collect (+ (view-left view) (* column (view-wide view))))))
    (format stream "~VA~A~%" +margin-columns+ ""
            (string-right-trim " " (format nil "~{~10A~}" marks)))))

(defun write-rows (sheet side paint stream)
  "Write the rows of SHEET, and beside them the lists of entries in the vector SIDE."
  (let ((view (sheet-view sheet)))
    (write-ruler view stream)
    (dotimes (row (view-rows view))
      (let ((written (write-row sheet row paint stream))
            (entries (svref side row)))
        (when entries
          (format stream "~VA~{~A~}" (- (view-columns view) written) "" entries)))
      (terpri stream))))

(defun write-sheet (sheet columns rows paint stream)
  "Write SHEET with its legend in lines of at most COLUMNS characters, ROWS of them, if that is not
NIL, as far as there is room."
  (let* ((view (sheet-view sheet))
         (all (whole-legend sheet columns paint))
         (left (and rows (- rows 1 (view-rows view))))
         (side (if (or (null rows) (<= (length all) left))
                   0
                   (- columns +margin-columns+ (view-columns view) 2))))
    (multiple-value-bind (beside rest)
        (side-legend (tail-glyphs sheet) side (view-rows view) paint)
      (write-rows sheet beside paint stream)
      (write-items (lines-with-count (head-items sheet paint) (glyph-items rest paint) columns left)
                   stream))))

(defun fitting-sheet (robot region columns rows layers colored-p)
  "Return a sheet of REGION for ROBOT that, with the head of its legend, fits into ROWS lines of
COLUMNS characters, if that can be. Kinds of things have letters also while none lies about."
  (let* ((world (robot-world robot)) (snapshot (take-snapshot world)) (letters (letters-of world))
         (image (snapshot-robot snapshot (robot-name robot))))
    (loop for lines from 1
          for view = (view-of snapshot region (- columns +margin-columns+)
                              (and rows (max 1 (- rows 1 lines))))
          for sheet = (sheet-of image view layers letters colored-p)
          for head = (fill-lines (head-items sheet #'unpainted) columns)
          when (or (null rows) (<= (length head) lines) (<= rows (+ 2 lines)))
            return sheet)))

(defun check-region (region map)
  "Signal WRONG-ARGUMENT unless REGION is NIL or a region that has some of MAP in it."
  (check-argument text-map region (or (null region) (region-p region))
                  (format nil "a list (left top right bottom) in metres, left less than right and ~
                               top less than bottom, or NIL"))
  (when region
    (destructuring-bind (left top right bottom) region
      (check-argument text-map region (and (< left (map-width map)) (< top (map-height map))
                                           (< 0 right) (< 0 bottom))
                      (format nil "a list (left top right bottom) of which some is on the map, ~
                                   that is from 0 to ~D and from 0 to ~D"
                              (map-width map) (map-height map))))))

(defun region-p (object)
  (and (proper-list-p object) (= 4 (length object)) (every #'finite-p object)
       (destructuring-bind (left top right bottom) object
         (and (< left right) (< top bottom)))))

(addition text-map)
(define-with-keywords text-map
    (robot &key (columns 80) rows radius region layers paint only-legend)
  "Return a string that shows the world of ROBOT in lines of at most COLUMNS characters: walls,
places, things by letters, robots as arrows, and what it all means. With ROWS, it is made to fit
into so many lines, as far as possible. With REGION, a list (left top right bottom) in metres, it
shows only that; with RADIUS, a number of cells, only the surroundings of ROBOT. LAYERS are some of
:CONES (what its cameras have in view), :WAY (where it went since KEEP-HISTORY), :PLAN (which way it
is about to go, see PUBLISH-WAY) and :BELIEF (where it believes itself and what its designators
denote to be). PAINT is a function of a string and of
the name of a colour, or NIL, that returns the string in that colour. ONLY-LEGEND leaves the map
out. Call it where the world stands still. Signals WRONG-ARGUMENT."
  (check-argument text-map robot (robot-p robot) "a robot")
  (check-argument text-map columns (whole-p columns 10 100000) "an integer from 10 to 100000")
  (check-argument text-map rows (or (null rows) (whole-p rows 5 100000))
                  "an integer from 5 to 100000, or NIL")
  (check-argument text-map radius (or (null radius) (whole-p radius))
                  "a whole number of cells, from 0 to 1e9, or NIL")
  (check-region region (world-map (robot-world robot)))
  (check-argument text-map layers (and (proper-list-p layers) (subsetp layers (text-layers)))
                  (format nil "a list of some of ~{~(~S~)~^, ~}" (text-layers)))
  (let ((sheet (fitting-sheet robot (if radius (region-near robot radius) region)
                              columns rows layers (and paint t)))
        (paint (or paint #'unpainted)))
    (with-output-to-string (stream)
      (if only-legend
          (write-items (whole-legend sheet columns paint) stream)
          (write-sheet sheet columns rows paint stream)))))
