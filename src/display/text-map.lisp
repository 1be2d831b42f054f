;;;; text-map.lisp -- the world as characters, for terminals, with a legend.

(in-package :ars-magna.display)

;;; The legend lists robots first; then, by their characters, layers, walls, places and things. If
;;; there is not enough room below the map, these are beside it. What does not fit there is counted.

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

(defun glyph-always-below-map-p (glyph)
  (eq :robot (glyph-kind glyph)))

;;; An item is a pair of its length in characters and its text.

(defun text-item (text) (cons (length text) text))

(defun glyph-item (glyph paint &optional (width 1000))
  "Return the legend item of GLYPH, cut to WIDTH characters. The function PAINT colours a string."
  (let ((text (glyph-text glyph)))
    (setf text (subseq text 0 (min (length text) (- width 2))))
    (cons (+ 2 (length text))
          (format nil "~A ~A" (funcall paint (string (glyph-char glyph)) (glyph-ink glyph)) text))))

(defun glyph-items (glyphs paint)
  (mapcar (lambda (glyph) (glyph-item glyph paint)) glyphs))

(defun fill-lines (items columns)
  "Return the list ITEMS divided into lines, lists of items, of at most COLUMNS characters. An item
longer than COLUMNS has its own line."
  (loop with lines = '() and used = 0
        for item in items
        do (cond ((and lines (<= (+ used 3 (car item)) columns))
                  (push item (first lines))
                  (incf used (+ 3 (car item))))
                 (t (push (list item) lines)
                    (setf used (car item))))
        finally (return (nreverse (mapcar #'reverse lines)))))

(defun write-items (lines stream)
  (dolist (line lines)
    (format stream "~{~A~^   ~}~%" (mapcar #'cdr line))))

(defun fixed-legend-items (sheet paint)
  "Return the legend items of SHEET that are always below the map."
  (let ((view (sheet-view sheet)))
    (append (when (< 1 (max (view-wide view) (view-high view)))
              (list (text-item (format nil "Each character is ~D x ~D cells."
                                       (view-wide view) (view-high view)))))
            (glyph-items (remove-if-not #'glyph-always-below-map-p (sorted-legend sheet)) paint))))

(defun movable-legend-glyphs (sheet)
  "Return the glyphs of SHEET whose legend items may be beside the map or below it."
  (remove-if #'glyph-always-below-map-p (sorted-legend sheet)))

(defun whole-legend (sheet columns paint)
  "Return the legend of SHEET, as lists of items that make lines of at most COLUMNS characters."
  (fill-lines (append (fixed-legend-items sheet paint)
                      (glyph-items (movable-legend-glyphs sheet) paint)) columns))

;;; Beside the map.

(defconstant +least-side-legend-width+ 12
  "The least width of a legend beside a map, in characters.")

(defun side-legend (glyphs room rows paint)
  "Return two values: a vector with a list of padded legend items for each of ROWS lines of a map;
and those of GLYPHS for which there is no room. The items fit beside the map in ROOM characters."
  (let* ((longest (loop for glyph in glyphs maximize (length (glyph-text glyph))))
         (width (min room (+ 2 longest)))
         (columns (if (<= +least-side-legend-width+ room) (max 1 (floor (+ room 2) (+ width 2))) 0))
         (lines (make-array rows :initial-element '())))
    (loop for glyph in glyphs
          for position from 0 below (* rows columns)
          do (destructuring-bind (length . text) (glyph-item glyph paint width)
               (push (format nil "  ~A~VA" text (- width length) "")
                     (svref lines (mod position rows)))))
    (values (cl:map 'vector #'reverse lines)
            (nthcdr (* rows columns) glyphs))))

;;; Below it.

(defun abridged-legend-lines (head items columns rows)
  "Return the legend items HEAD and ITEMS as lines of COLUMNS characters, at most ROWS lines unless
ROWS is NIL. If some items do not fit, the last line says how many, if this number fits."
  (flet ((kept (count &rest more)
           (fill-lines (append head (subseq items 0 count) more) columns))
         (fits-p (lines) (or (null rows) (<= (length lines) rows))))
    (if (fits-p (kept (length items)))
        (kept (length items))
        (loop for count from (1- (length items)) downto 0
              for remark = (text-item (format nil "and ~D more: MAP LEGEND"
                                                  (- (length items) count)))
              when (fits-p (kept count remark)) return (kept count remark)
              finally (return (kept 0))))))

;;;; The map

;;; A text map changes nothing and rolls no dice. With a number of lines, as on a terminal, the map
;;; is made to fit. Otherwise only the width matters, and blocks of cells are square.

(defconstant +margin-columns+ 5 "How many characters stand left of a text map.")

(defun ignore-ink (text ink)
  (declare (ignore ink))
  text)

(defun write-row (sheet row paint stream)
  "Write row ROW of SHEET, coloured by the function PAINT, to STREAM. Return the number of glyphs."
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
  "Write a line with the x coordinate of every tenth column of VIEW."
  (let ((marks (loop for column from 0 below (view-columns view) by 10
                     collect (+ (view-left view) (* column (view-wide view))))))
    (format stream "~VA~A~%" +margin-columns+ ""
            (string-right-trim " " (format nil "~{~10A~}" marks)))))

(defun write-rows (sheet side paint stream)
  "Write the rows of SHEET to STREAM, and beside them the legend items in SIDE, a vector of lists."
  (let ((view (sheet-view sheet)))
    (write-ruler view stream)
    (dotimes (row (view-rows view))
      (let ((written (write-row sheet row paint stream))
            (items (svref side row)))
        (when items
          (format stream "~VA~{~A~}" (- (view-columns view) written) "" items)))
      (terpri stream))))

(defun write-sheet (sheet columns rows paint stream)
  "Write SHEET with its legend to STREAM, in lines of at most COLUMNS characters, and in at most
ROWS lines if possible. If ROWS is NIL, the number of lines is unlimited."
  (let* ((view (sheet-view sheet))
         (all (whole-legend sheet columns paint))
         (left (and rows (- rows 1 (view-rows view))))
         (side (if (or (null rows) (<= (length all) left))
                   0
                   (- columns +margin-columns+ (view-columns view) 2))))
    (multiple-value-bind (beside rest)
        (side-legend (movable-legend-glyphs sheet) side (view-rows view) paint)
      (write-rows sheet beside paint stream)
      (write-items (abridged-legend-lines (fixed-legend-items sheet paint) (glyph-items rest paint)
                                          columns left)
                   stream))))

(defun fitting-sheet (robot region columns rows layers colored-p)
  "Return a sheet of REGION for ROBOT. If possible, it and the fixed part of its legend fit into
ROWS lines of COLUMNS characters. Names without a thing on the floor keep their letters."
  (let* ((world (robot-world robot)) (snapshot (take-snapshot world))
         (letters (letters-of-thing-names world))
         (image (snapshot-robot snapshot (robot-name robot))))
    (loop for lines from 1
          for view = (text-view-of-region snapshot region (- columns +margin-columns+)
                                          (and rows (max 1 (- rows 1 lines))))
          for sheet = (sheet-of image view layers letters colored-p)
          for head = (fill-lines (fixed-legend-items sheet #'ignore-ink) columns)
          when (or (null rows) (<= (length head) lines) (<= rows (+ 2 lines)))
            return sheet)))

(defun check-region (region map)
  "Signal WRONG-ARGUMENT unless REGION is NIL or a list (left top right bottom) that overlaps MAP."
  (check-argument text-map region (or (null region) (region-p region))
                  (format nil "a list (left top right bottom) in metres, left less than right and ~
                               top less than bottom, or NIL"))
  (when region
    (destructuring-bind (left top right bottom) region
      (check-argument text-map region (and (< left (map-width map)) (< top (map-height map))
                                           (< 0 right) (< 0 bottom))
                      (format nil "a list (left top right bottom) that overlaps the map, whose x ~
                                   is from 0 to ~D and whose y is from 0 to ~D"
                              (map-width map) (map-height map))))))

(defun region-p (object)
  (and (proper-list-p object) (= 4 (length object)) (every #'finite-p object)
       (destructuring-bind (left top right bottom) object
         (and (< left right) (< top bottom)))))

(addition text-map)
(define-with-keywords text-map
    (robot &key (columns 80) rows radius region layers paint only-legend)
  "Return a string that shows the world of ROBOT in lines of at most COLUMNS characters: walls,
places, things as letters, robots as arrows, and a legend. With ROWS, the string has at most ROWS
lines if possible. REGION, a list (left top right bottom) in metres, is the part of the map to show.
RADIUS, a number of cells, limits the part to the surroundings of ROBOT. LAYERS is a list of names
such as :WAY and :BELIEF, which *PICTURE-LAYERS* documents. PAINT is NIL or a function that takes a
string and the name of a colour or NIL, and returns the coloured string. If ONLY-LEGEND, return the
legend without the map. Call this function between ticks. Signals WRONG-ARGUMENT."
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
        (paint (or paint #'ignore-ink)))
    (with-output-to-string (stream)
      (if only-legend
          (write-items (whole-legend sheet columns paint) stream)
          (write-sheet sheet columns rows paint stream)))))
