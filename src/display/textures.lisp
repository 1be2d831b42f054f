;;;; textures.lisp -- patterns that tell areas apart where colours do not: hatching, dots, bricks.

(in-package :ars-magna.canvas)

(export '(+textures+ draw-texture))

;;; A texture is a list of marks, repeated in square tiles. Where coordinates are multiples of the
;;; size of a tile, so are the marks of areas beside each other. Lines run through all tiles of a
;;; rectangle, so that large areas take few of them. Coordinates in a tile are from 0 to 1.

(define-constant +textures+
    '(:plain ()
      :lines ((:across 1/4) (:across 3/4))
      :hatching ((:rising))
      :bricks ((:across 0) (:across 1/2) (:stroke 1/4 0 1/4 1/2) (:stroke 3/4 1/2 3/4 1))
      :dots ((:box 1/4 1/4 1/2 1/2))
      :posts ((:down 1/4) (:down 3/4))
      :falling-hatching ((:falling))
      :crosses ((:rising) (:falling))
      :net ((:across 1/2) (:down 1/2))
      :chequers ((:box 0 0 1/2 1/2) (:box 1/2 1/2 1/2 1/2))
      :arrows ((:stroke 0 1/4 1/2 3/4) (:stroke 1/2 3/4 1 1/4)))
  :test #'equal
  :documentation "Textures by name, each a list of marks: (:across Y), (:down X), (:rising),
(:falling), (:stroke X1 Y1 X2 Y2), (:box X Y WIDTH HEIGHT).")

(defun tile-edges (low high tile)
  "Return where tiles begin that lie between LOW and HIGH, at least in part."
  (loop for edge from (* tile (floor low tile)) below high by tile collect edge))

(defun levels (low high tile part)
  "Return what is PART of a tile behind the edge of one, from LOW up to HIGH."
  (loop for edge in (tile-edges low high tile)
        for level = (+ edge (* part tile))
        when (and (<= low level) (< level high)) collect level))

(defun slants (left top right bottom tile sign)
  "Return diagonals through the corners of tiles, cut to the rectangle: those on which y - SIGN x is
a multiple of TILE."
  (let* ((ends (list (* sign left) (* sign right)))
         (least (- top (reduce #'max ends))) (most (- bottom (reduce #'min ends))))
    (loop for c in (rest (tile-edges least most tile))
          for from = (if (plusp sign) (max left (- top c)) (max left (- c bottom)))
          for to = (if (plusp sign) (min right (- bottom c)) (min right (- c top)))
          when (< from to)
            append (list from (+ c (* sign from)) to (+ c (* sign to))))))

(defun strokes-in-tiles (left top right bottom tile stroke)
  "Return STROKE, x1 y1 x2 y2 in parts of a tile, in each tile of the rectangle, cut to it."
  (flet ((cut-to (low value high) (clamp value low high)))
    (destructuring-bind (x1 y1 x2 y2) stroke
      (loop for y in (tile-edges top bottom tile)
            append (loop for x in (tile-edges left right tile)
                         append (list (cut-to left (+ x (* x1 tile)) right)
                                      (cut-to top (+ y (* y1 tile)) bottom)
                                      (cut-to left (+ x (* x2 tile)) right)
                                      (cut-to top (+ y (* y2 tile)) bottom)))))))

(defun mark-segments (mark left top right bottom tile)
  "Return the lines x1 y1 x2 y2 ... that MARK, which is no box, is in the rectangle."
  (ecase (first mark)
    (:across (loop for y in (levels top bottom tile (second mark)) append (list left y right y)))
    (:down (loop for x in (levels left right tile (second mark)) append (list x top x bottom)))
    (:rising (slants left top right bottom tile -1))
    (:falling (slants left top right bottom tile 1))
    (:stroke (strokes-in-tiles left top right bottom tile (rest mark)))))

(defun mark-boxes (mark left top right bottom tile)
  "Return the boxes x y width height ... that MARK is in the rectangle."
  (destructuring-bind (x y width height) (rest mark)
    (loop for (x1 y1 x2 y2) on (strokes-in-tiles left top right bottom tile
                                                 (list x y (+ x width) (+ y height)))
            by #'cddddr
          when (and (< x1 x2) (< y1 y2))
            append (list x1 y1 (- x2 x1) (- y2 y1)))))

(defun draw-texture (canvas gcontext texture rectangles tile)
  "Draw TEXTURE, one of +TEXTURES+, in RECTANGLES, a list x y width height ..., in tiles TILE pixels
wide and high."
  (let ((segments '()) (boxes '()) (marks (getf +textures+ texture)))
    (loop for (x y width height) on rectangles by #'cddddr
          do (dolist (mark marks)
               (let ((box (list x y (+ x width) (+ y height) tile)))
                 (if (eq :box (first mark))
                     (push (apply #'mark-boxes mark box) boxes)
                     (push (apply #'mark-segments mark box) segments)))))
    (flet ((all (lists) (reduce #'nconc lists :from-end t)))
      (let ((segments (all segments)) (boxes (all boxes)))
        (when segments (paint-segments canvas gcontext segments))
        (when boxes (paint-rectangles canvas gcontext boxes t))))))
