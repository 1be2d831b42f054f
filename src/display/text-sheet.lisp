;;;; text-sheet.lisp -- a text map before it is written: a glyph for each block of cells.

(in-package :ars-magna.display)

;;; What matters most in a block shows: a robot, what one believes, things, its way, walls, a place,
;;; what cameras see.

(defstruct (sheet (:copier nil))
  "A VIEW, in which GLYPHS has what is to be seen in each block, row by row, or NIL; and the LEGEND,
a list of all glyphs that mean something there."
  (view nil :type view :read-only t)
  (letters nil :type hash-table :read-only t)
  ;; Walls are told apart by colour.
  (colored-p nil :read-only t)
  (things nil :type hash-table :read-only t)
  ;; For each layer, the last first, its depth with a table from blocks to lists of glyphs.
  (marks '() :type list)
  (glyphs #() :type simple-vector)
  (legend '() :type list))

(defun explain (sheet glyphs)
  "Let the legend of SHEET have GLYPHS. Return the first of them."
  (dolist (glyph glyphs (first glyphs))
    (pushnew glyph (sheet-legend sheet)
             :test (lambda (a b)
                     (and (char= (glyph-char a) (glyph-char b))
                          (string= (glyph-text a) (glyph-text b)))))))

(defun mark-layer (sheet robot layer)
  (let ((table (make-hash-table)))
    (loop for (number . glyph) in (funcall (%layer-text layer) (sheet-view sheet) robot)
          do (push glyph (gethash number table)))
    (push (cons (%layer-text-depth layer) table) (sheet-marks sheet))))

(defun marked (sheet depth number)
  "Return a list of the glyph of the last layer at DEPTH that has one in the block NUMBER of SHEET."
  (loop for (its-depth . table) in (sheet-marks sheet)
        for glyphs = (and (eq depth its-depth) (gethash number table))
        when glyphs return (list (first glyphs))))

(defun cell-of (view x y)
  (map-index (view-map view) x y))

(defun robots-in (view indices)
  (remove-if-not (lambda (robot)
                   (member (cell-of view (robot-image-x robot) (robot-image-y robot)) indices))
                 (snapshot-robots (view-snapshot view))))

(defun things-by-cell (view)
  "Return a hash table from indices of cells to lists of images of things in VIEW, by number."
  (let ((table (make-hash-table)))
    (loop for image across (reverse (snapshot-things (view-snapshot view)))
          do (push image (gethash (cell-of view (thing-image-x image) (thing-image-y image))
                                  table)))
    table))

(defun glyphs-of-block (sheet number indices)
  "Return the glyphs of what matters most in the block NUMBER of SHEET, which has the cells INDICES:
first the one that shows."
  (let* ((view (sheet-view sheet))
         (map (view-map view))
         (things (loop for index in indices append (gethash index (sheet-things sheet)))))
    (or (mapcar (lambda (robot) (robot-glyph robot things)) (robots-in view indices))
        (marked sheet :above number)
        (things-glyphs things (sheet-letters sheet))
        (marked sheet :below number)
        (wall-glyphs map indices (sheet-colored-p sheet))
        (place-glyphs map indices)
        (marked sheet :floor number))))

(defun sheet-of (robot view layers letters colored-p)
  "Return a sheet of VIEW with LAYERS, some of (TEXT-LAYERS), for ROBOT, an image. LETTERS are those
of things."
  (let ((sheet (make-sheet :view view :colored-p colored-p :things (things-by-cell view)
                           :letters letters)))
    (dolist (layer *layers*)
      (when (and (%layer-text layer) (member (%layer-text-name layer) layers))
        (mark-layer sheet robot layer)))
    (setf (sheet-glyphs sheet)
          (coerce (loop for row below (view-rows view)
                        append (loop for column below (view-columns view)
                                     for number from (* row (view-columns view))
                                     collect (explain sheet
                                                      (glyphs-of-block
                                                       sheet number
                                                       (block-indices view column row)))))
                  'simple-vector))
    sheet))

(defun row-glyphs (sheet row)
  "Return the glyphs of ROW of SHEET, NIL where there is nothing, up to the last one."
  (let* ((columns (view-columns (sheet-view sheet)))
         (start (* row columns))
         (last (position nil (sheet-glyphs sheet) :from-end t :test-not #'eq
                                                  :start start :end (+ start columns))))
    (coerce (subseq (sheet-glyphs sheet) start (if last (1+ last) start)) 'list)))
