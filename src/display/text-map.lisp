;;;; text-map.lisp -- the world as characters, for terminals.

(in-package :ars-magna.display)

;;; Nothing is changed by looking, and no dice are rolled. Where lines count, as on a terminal, the
;;; map is made to fit; elsewhere only how wide it is counts, and blocks of cells are square.

(define-constant +margin-columns+ 5 :documentation "How many characters stand left of a text map.")

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
      (write-entries (with-remark (head-entries sheet paint) (entries-of rest paint) columns left)
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
          for head = (filled (head-entries sheet #'unpainted) columns)
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
          (write-entries (whole-legend sheet columns paint) stream)
          (write-sheet sheet columns rows paint stream)))))
