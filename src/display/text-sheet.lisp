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
  ;; By layer, a table from the numbers of blocks to lists of glyphs.
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
  "Mark the blocks of SHEET that LAYER has for ROBOT."
  (let ((table (make-hash-table)))
    (loop for (number . glyph) in (layer-of (sheet-view sheet) robot layer)
          do (push glyph (gethash number table)))
    (setf (getf (sheet-marks sheet) layer) table)))

(defun marked (sheet layer number)
  "Return a list of the glyph that LAYER has in the block NUMBER of SHEET, or NIL."
  (let* ((table (getf (sheet-marks sheet) layer))
         (glyphs (and table (gethash number table))))
    (and glyphs (list (first glyphs)))))

(defun robots-in (view indices)
  (remove-if-not (lambda (robot) (member (robot-cell-index robot) indices))
                 (world-robots (view-world view))))

(defun glyphs-of-block (sheet number indices)
  "Return the glyphs of what matters most in the block NUMBER of SHEET, which has the cells INDICES:
first the one that shows."
  (let* ((view (sheet-view sheet))
         (map (view-map view))
         (things (loop for index in indices append (cell-things index (view-world view)))))
    (or (mapcar (lambda (robot) (robot-glyph robot things)) (robots-in view indices))
        (marked sheet :belief number)
        (things-glyphs things (sheet-letters sheet))
        (marked sheet :plan number)
        (marked sheet :way number)
        (wall-glyphs map indices (sheet-colored-p sheet))
        (place-glyphs map indices)
        (marked sheet :cones number))))

(defun sheet-of (robot view layers colored-p)
  "Return a sheet of VIEW with LAYERS, some of +TEXT-LAYERS+, for ROBOT."
  (let ((sheet (make-sheet :view view :colored-p colored-p
                           :letters (letters-of (view-world view)))))
    (dolist (layer layers) (mark-layer sheet robot layer))
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
