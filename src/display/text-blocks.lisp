;;;; text-blocks.lisp -- the blocks of cells of a text map, and the characters for them.

(in-package :ars-magna.display)

;;; Each character stands for a block of cells. Characters are about twice as high as wide. So if a
;;; map is scaled down to a number of lines, blocks may be twice as high, too.

(defstruct (text-view (:conc-name view-) (:copier nil))
  "The part of SNAPSHOT that a text map shows. It begins at the cell LEFT, TOP and has COLUMNS x
ROWS blocks of WIDE x HIGH cells each."
  (snapshot nil :type snapshot :read-only t)
  (left 0 :type fixnum :read-only t)
  (top 0 :type fixnum :read-only t)
  (columns 1 :type (integer 1) :read-only t)
  (rows 1 :type (integer 1) :read-only t)
  (wide 1 :type (integer 1) :read-only t)
  (high 1 :type (integer 1) :read-only t))

(defun view-map (view) (snapshot-map (view-snapshot view)))

;;; Regions.

(defun clip-range (least low high most)
  "Return LOW, rounded down, and HIGH, rounded up, as different integers from LEAST to MOST."
  (let ((low (max least (min (floor low) (1- most)))))
    (values low (max (1+ low) (min (ceiling high) most)))))

(defun region-near (robot radius)
  "Return the region up to RADIUS cells around ROBOT, as a list (left top right bottom) in metres."
  (let ((x (floor (robot-x robot))) (y (floor (robot-y robot))))
    (list (- x radius) (- y radius) (+ x radius 1) (+ y radius 1))))

(defun least-block-size (width height columns rows)
  "Return the least width and height of blocks, in cells, for which at most COLUMNS x ROWS blocks
cover WIDTH x HEIGHT cells. If ROWS is NIL, the number of rows is unlimited."
  (flet ((fits-p (wide high)
           (and (<= (ceiling width wide) columns)
                (or (null rows) (<= (ceiling height high) rows)))))
    (loop for wide from 1
          do (cond ((fits-p wide wide) (return (values wide wide)))
                   ((fits-p wide (* 2 wide)) (return (values wide (* 2 wide))))))))

(defun text-view-of-region (snapshot region columns rows)
  "Return a text view of REGION, a list (left top right bottom) in metres, or NIL for the whole
SNAPSHOT. The view has at most COLUMNS characters a line and at most ROWS lines unless ROWS is NIL."
  (let ((map (snapshot-map snapshot)))
    (destructuring-bind (x1 y1 x2 y2) (or region (list 0 0 (map-width map) (map-height map)))
      (multiple-value-bind (left right) (clip-range 0 x1 x2 (map-width map))
        (multiple-value-bind (top bottom) (clip-range 0 y1 y2 (map-height map))
          (multiple-value-bind (wide high)
              (least-block-size (- right left) (- bottom top) columns rows)
            (make-text-view :snapshot snapshot :left left :top top :wide wide :high high
                            :columns (ceiling (- right left) wide)
                            :rows (ceiling (- bottom top) high))))))))

;;; Blocks.

(defun block-indices (view column row)
  (let ((map (view-map view)))
    (loop for y from (+ (view-top view) (* row (view-high view))) repeat (view-high view)
          append (loop for x from (+ (view-left view) (* column (view-wide view)))
                         repeat (view-wide view)
                       when (map-index map x y) collect it))))

(defun block-number-at (view x y)
  "Return the number, counted row by row, of VIEW's block at the point X, Y. Return NIL for none."
  (let ((column (floor (- x (view-left view)) (view-wide view)))
        (row (floor (- y (view-top view)) (view-high view))))
    (when (and (< -1 column (view-columns view)) (< -1 row (view-rows view)))
      (+ column (* row (view-columns view))))))

(defun block-number-of-cell (view index)
  "Return the number of the block of VIEW that contains the cell INDEX, or NIL."
  (multiple-value-bind (y x) (floor index (map-width (view-map view)))
    (block-number-at view x y)))

;;;; Glyphs

;;; Things with the same name are of one kind. Each kind has its own letter, the same in all text
;;; maps of its world, until a kind is added or removed.

(defstruct (glyph (:constructor make-glyph (kind char text &optional ink)) (:copier nil))
  "A character of a text map: CHAR stands for an object of KIND that is called TEXT in the legend.
Believed positions have the kind :ROBOT, too. INK names CHAR's colour, or is NIL for normal text."
  (kind :thing :type (member :wall :robot :layer :several :place :thing) :read-only t)
  (char #\Space :type character :read-only t)
  (text "" :type string :read-only t)
  (ink nil :type (or symbol string) :read-only t))

(define-constant +several+ #\* :documentation "The character for several kinds of things.")
(define-constant +closed+ #\% :documentation "The character for closed doors.")
(define-constant +other+ #\& :documentation "The character for things whose name has no letter.")

;;; Letters.

(define-constant +letters+ "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ" :test #'equal
  :documentation "The letters that can stand for kinds of things.")

(defun candidate-letters (name)
  "Return a list of strings of possible letters for things called NAME, the best letters first."
  (list (string-downcase (char name 0))
        (string-upcase (char name 0))
        (concatenate 'string (string-downcase name) (string-upcase name))
        +letters+))

(defun thing-names-by-size (world)
  "Return the names of the things in WORLD, a list of strings. The names of the largest things are
first. Names of things with the same size are in alphabetical order."
  (let ((sizes (make-hash-table :test #'equal)))
    (do-things (thing world)
      (let ((name (symbol-name (thing-name thing))))
        (setf (gethash name sizes) (max (thing-size thing) (gethash name sizes 0)))))
    (remhash "" sizes)
    (sort (loop for name being the hash-keys of sizes collect name)
          (lambda (a b)
            (let ((size-a (gethash a sizes)) (size-b (gethash b sizes)))
              (if (= size-a size-b) (name-before-p a b) (> size-a size-b)))))))

(defun letters-of-thing-names (world)
  "Return a hash table from the names of the things in WORLD, strings, to their letters. Letters are
given to the largest things first. If WORLD has more names than letters, some names are missing."
  (let ((letters (make-hash-table :test #'equal)) (names (thing-names-by-size world))
        (free (remove #\v (coerce +letters+ 'list))))   ; v is a robot
    (dotimes (rank 4 letters)
      (dolist (name names)
        (let ((letter (and (null (gethash name letters))
                           (find-if (lambda (char) (member char free))
                                    (nth rank (candidate-letters name))))))
          (when letter
            (setf (gethash name letters) letter
                  free (remove letter free))))))))

(defun thing-glyph (image letters)
  (flet ((value-of (key) (second (assoc key (thing-image-attributes image)))))
    (let ((name (symbol-name (thing-name (thing-image-thing image))))
          (color (value-of :color)) (closed-p (and (value-of :door) (value-of :closed))))
      (make-glyph :thing (if closed-p +closed+ (gethash name letters +other+))
                  (format nil "~A~:[~;, closed~]" name closed-p)
                  (and (typep color '(or symbol string)) color)))))

(defun things-glyphs (images letters)
  "Return the glyphs for the kinds of the things in IMAGES. If the things are of several kinds, the
first glyph is the glyph for several things."
  (let ((glyphs (remove-duplicates (mapcar (lambda (image) (thing-glyph image letters)) images)
                                   :key #'glyph-text :test #'string= :from-end t)))
    (if (rest glyphs)
        (cons (make-glyph :several +several+ "several things" :bold) glyphs)
        glyphs)))

;;; Walls, by their substance.

(defun wall-glyphs (map indices colored-p)
  "Return a list with the glyph of the first wall of MAP in the cells INDICES, or NIL. If COLORED-P,
the glyph shows the substance by its colour."
  (let ((index (find-if (lambda (index) (logtest +wall+ (aref (map-flags map) index))) indices)))
    (when index
      (let ((name (and colored-p
                       (svref (map-substance-types map) (aref (map-substances map) index)))))
        (list (make-glyph :wall #\# (if name (string-downcase name) "wall")
                          (and name (substance-ink name))))))))

;;; Places.

(define-constant +place-glyphs+ "=:.;,'~\"|-/\\_" :test #'equal
  :documentation "The characters of place types, by rank. Higher ranks have the last one.")

(defun place-glyphs (map indices)
  "Return a list with the glyph of the first place of MAP in the cells INDICES, or NIL."
  (let ((index (find-if (lambda (index) (plusp (aref (map-places map) index))) indices)))
    (when index
      (let* ((type (svref (map-place-types map) (aref (map-places map) index)))
             (last (1- (length +place-glyphs+))))
        (list (make-glyph :place (char +place-glyphs+ (min (place-type-rank type) last))
                          (string-downcase (place-type-name type)) :grey))))))

;;; Robots.

(defun arrow-character (angle)
  "Return the arrow character whose direction is nearest to ANGLE, in radians."
  (char ">v<^" (mod (round (/ angle (/ pi 2))) 4)))

(defun robot-glyph (robot things)
  "Return the glyph of ROBOT, an image. THINGS are images of the things in the same block."
  (make-glyph :robot (arrow-character (robot-image-angle robot))
              (format nil "~A (~,2F,~,2F)~@[ with ~{~A~^, ~}~]" (robot-image-label robot)
                      (zero-if-tiny (robot-image-x robot)) (zero-if-tiny (robot-image-y robot))
                      (remove-duplicates (loop for image in things
                                               collect (thing-name (thing-image-thing image)))
                                         :from-end t))
              :reverse))
