;;;; text-sheet.lisp -- a text map before it is written: a glyph for each block of cells.

(in-package :ars-magna.display)

;;; The layers (see layers.lisp) call these functions. Each returns a list of pairs of the number of
;;; a block and the glyph to show there.

(defun glyph-mark-at (view x y glyph)
  "Return a list of one pair (number . GLYPH) for VIEW's block at X, Y, or NIL if X, Y is outside."
  (let ((number (block-number-at view x y)))
    (and number (list (cons number glyph)))))

;;; Cones.

(defconstant +ray-angle-step+ 0.01d0
  "The angle between the rays that find the cells in a field of view, in radians.")

(defun cells-along-ray (map opaque-p x y angle)
  "Return the indices of the cells of MAP that a camera at X, Y sees in direction ANGLE."
  (let ((indices '()))
    (walk-cells-on-line (lambda (index at column)
                          (declare (ignore at column))
                          (push index indices)
                          (funcall opaque-p index))
                        (map-width map) (map-height map) x y (cosine angle) (sine angle) +no-limit+)
    indices))

(defun cone-blocks (view robot camera)
  "Return the numbers of the blocks of VIEW that CAMERA of ROBOT sees, at least in part."
  (let* ((width (camera-image-field-of-view camera))
         (count (max 1 (ceiling width +ray-angle-step+)))
         (first (- (+ (robot-image-angle robot) (camera-image-angle camera)) (/ width 2)))
         (opaque-p (opaque-cell-test (view-snapshot view) robot)))
    (remove-duplicates
     (loop for ray to count
           append (loop for index in (cells-along-ray (view-map view) opaque-p
                                                      (robot-image-x robot) (robot-image-y robot)
                                                      (+ first (* ray (/ width count))))
                        when (block-number-of-cell view index) collect it)))))

(defun cone-marks (view robot)
  (let ((glyph (make-glyph :layer #\` (format nil "in view of ~A" (robot-image-label robot))
                           :yellow)))
    (loop for camera in (remove-if-not #'camera-outside-container (robot-image-cameras robot))
          append (loop for number in (cone-blocks view robot camera) collect (cons number glyph)))))

;;; Ranges.

(defconstant +into-obstacle+ 1d-5
  "How far beyond the end of a beam its mark is, in metres, so that it is in the obstacle's cell.")

(defun range-marks (view robot)
  (let ((glyph (make-glyph :layer #\~ (format nil "measured by ~A" (robot-image-label robot))
                           :green)))
    (loop for (from-x from-y . ends) in (getf (robot-image-notes robot) :ranges)
          append (loop for (x y) on ends by #'cddr
                       for angle = (atan2 (- y from-y) (- x from-x))
                       append (destructuring-bind (x y)
                                  (point-at-distance x y angle +into-obstacle+)
                                (glyph-mark-at view x y glyph))))))

;;; Ways.

(defun trail-marks (view robot)
  (let ((glyph (make-glyph :layer #\+ (format nil "way of ~A" (robot-image-label robot)) :green)))
    (do-trail ((robot-image-trail robot) x y)
          append (glyph-mark-at view x y glyph))))

(defconstant +way-spacing+ 0.2d0
  "The distance between the points of a planned way that are marked on text maps, in metres.")

(defun points-between (from to)
  "Return points on the line from FROM to TO, including both ends. All points are lists (x y)."
  (destructuring-bind ((x y) (dx dy)) (list from (mapcar #'- to from))
    (let ((count (max 1 (ceiling (sqrt (+ (* dx dx) (* dy dy))) +way-spacing+))))
      (loop for i to count
            collect (list (+ x (* dx (/ i count))) (+ y (* dy (/ i count))))))))

(defun planned-way-marks (view robot)
  (let ((glyph (make-glyph :layer #\: (format nil "planned way of ~A" (robot-image-label robot))
                           :cyan)))
    (loop for (from to) on (robot-image-planned-way robot)
          while to
          append (loop for (x y) in (points-between from to)
                       append (glyph-mark-at view x y glyph)))))

;;; Beliefs.

(defun own-position-marks (view odometer)
  (let ((x (odometer-image-x odometer)) (y (odometer-image-y odometer)))
    (glyph-mark-at view x y (make-glyph :robot #\@
                                        (format nil "believed (~,2F,~,2F)" (zero-if-tiny x)
                                               (zero-if-tiny y))
                                        :bold))))

(defun designator-marks (view robot designator)
  (destructuring-bind (x y) (believed-place robot designator)
    (glyph-mark-at view x y
                   (make-glyph :layer (digit-char (mod (designator-image-number designator) 10))
                               (subject-title designator) :bold))))

(defun belief-marks (view robot)
  (append (and (robot-image-odometer robot)
               (own-position-marks view (robot-image-odometer robot)))
          (loop for designator in (robot-image-designators robot)
                append (designator-marks view robot designator))))

;;;; Sheets

;;; A block shows what matters most: a robot, beliefs, things, ways, walls, a place, camera views.

(defstruct (sheet (:copier nil))
  "A text map before it is written. GLYPHS is a vector with the visible glyph, or NIL, of each block
of VIEW, row by row. LEGEND is a list of all glyphs used."
  (view nil :type text-view :read-only t)
  (letters nil :type hash-table :read-only t)
  ;; True if walls are told apart by colour.
  (colored-p nil :read-only t)
  (things nil :type hash-table :read-only t)
  ;; For each layer, the last first, its depth with a table from blocks to lists of glyphs.
  (marks '() :type list)
  (glyphs #() :type simple-vector)
  (legend '() :type list))

(defun add-to-legend (sheet glyphs)
  (dolist (glyph glyphs (first glyphs))
    (pushnew glyph (sheet-legend sheet)
             :test (lambda (a b)
                     (and (char= (glyph-char a) (glyph-char b))
                          (string= (glyph-text a) (glyph-text b)))))))

(defun add-layer-marks (sheet robot layer)
  (let ((table (make-hash-table)))
    (loop for (number . glyph) in (funcall (%layer-text layer) (sheet-view sheet) robot)
          do (push glyph (gethash number table)))
    (push (cons (%layer-text-depth layer) table) (sheet-marks sheet))))

(defun layer-glyphs-at (sheet depth number)
  "Return a list with the glyph that the last layer at DEPTH has in the block NUMBER of SHEET, or
NIL if no layer at DEPTH has a glyph in this block."
  (loop for (its-depth . table) in (sheet-marks sheet)
        for glyphs = (and (eq depth its-depth) (gethash number table))
        when glyphs return (list (first glyphs))))

(defun robots-in-cells (view indices)
  (remove-if-not (lambda (robot)
                   (member (map-index (view-map view) (robot-image-x robot) (robot-image-y robot))
                           indices))
                 (snapshot-robots (view-snapshot view))))

(defun things-by-cell (view)
  "Return a hash table from indices of cells to lists of the images of things in these cells. The
lists keep the order of the snapshot of VIEW."
  (let ((table (make-hash-table)))
    (loop for image across (reverse (snapshot-things (view-snapshot view)))
          do (push image (gethash (map-index (view-map view) (thing-image-x image)
                                             (thing-image-y image))
                                  table)))
    table))

(defun glyphs-of-block (sheet number indices)
  "Return the glyphs for the most important objects in the block NUMBER of SHEET, the visible glyph
first. INDICES are the cells of the block."
  (let* ((view (sheet-view sheet))
         (map (view-map view))
         (things (loop for index in indices append (gethash index (sheet-things sheet)))))
    (or (mapcar (lambda (robot) (robot-glyph robot things)) (robots-in-cells view indices))
        (layer-glyphs-at sheet :above number)
        (things-glyphs things (sheet-letters sheet))
        (layer-glyphs-at sheet :below number)
        (wall-glyphs map indices (sheet-colored-p sheet))
        (place-glyphs map indices)
        (layer-glyphs-at sheet :floor number))))

(defun sheet-of (robot view layers letters colored-p)
  "Return a sheet of VIEW for ROBOT, the image of a robot. LAYERS are names of layers in text maps.
LETTERS is a value of LETTERS-OF-THING-NAMES. If COLORED-P, walls are told apart by colours."
  (let ((sheet (make-sheet :view view :colored-p colored-p :things (things-by-cell view)
                           :letters letters)))
    (dolist (layer *layers*)
      (when (and (%layer-text layer) (member (%layer-text-name layer) layers))
        (add-layer-marks sheet robot layer)))
    (setf (sheet-glyphs sheet)
          (coerce (loop for row below (view-rows view)
                        append (loop for column below (view-columns view)
                                     for number from (* row (view-columns view))
                                     collect (add-to-legend sheet
                                                            (glyphs-of-block
                                                             sheet number
                                                             (block-indices view column row)))))
                  'simple-vector))
    sheet))

(defun row-glyphs (sheet row)
  "Return a list of the glyphs in row ROW of SHEET, up to the last, with NIL for empty blocks."
  (let* ((columns (view-columns (sheet-view sheet)))
         (start (* row columns))
         (last (position nil (sheet-glyphs sheet) :from-end t :test-not #'eq
                                                  :start start :end (+ start columns))))
    (coerce (subseq (sheet-glyphs sheet) start (if last (1+ last) start)) 'list)))
