;;;; way-picture.lisp -- a map with ways drawn on it, in a file.

(in-package :ars-magna.display)

(defparameter *way-colors* '(#x9C1408 #x0C3C9C #x0A5A1C #x6A3C00 #x5C1478)
  "What ways are drawn in, by turns: dark enough for the marks of all built-in places.")

(defun coordinates-of (point)
  "Return the coordinates of POINT, a PT or a list (x y), as a list in pixels."
  (list (* graphics-scale* (if (pt-p point) (pt-x point) (first point)))
        (* graphics-scale* (if (pt-p point) (pt-y point) (second point)))))

(defun draw-way-on-map (canvas way color)
  "Draw WAY, a list of points, as a line of COLOR, with a spot where it ends."
  (inked (color :width 2)
    (draw-lines canvas draw-gcontext* (mapcan #'coordinates-of way)))
  (with-gcontext (draw-gcontext* :foreground color)
    (destructuring-bind (x y) (coordinates-of (first (last way)))
      (draw-arc canvas draw-gcontext* (- x 3) (- y 3) 6 6 0 (* 2 pi) t))))

(defun ways-p (ways)
  (flet ((point-p (point) (or (pt-p point) (number-pair-p point))))
    (and (proper-list-p ways)
         (every (lambda (way) (and (consp way) (proper-list-p way) (every #'point-p way))) ways))))

(addition save-way-picture)
(defun save-way-picture (map ways file &key scale)
  "Save in FILE, replacing it, a picture of MAP, a map or the name of one, and of WAYS in it: a
list of ways, each a list of PTs or of lists (x y), as FIND-WAY returns it. SCALE is how many
pixels there are to a cell; without it, as SAVE-PICTURE has it. FILE is SVG or, where the program
rsvg-convert is installed, PNG, as its name ends. Return its truename. Signals WRONG-ARGUMENT,
UNKNOWN-NAME, and MISUSE without that program."
  (check-argument save-way-picture ways (ways-p ways)
                  "a list of ways, each a list of PTs or of lists (x y)")
  (check-scale 'save-way-picture scale)
  (let* ((map (find-map map)) (kind (picture-kind 'save-way-picture file))
         (scale (suitable-scale scale (make-snapshot :map map) '())))
    (save-svg (with-output-to-string (stream)
                (with-svg (canvas stream)
                  (with-canvas (canvas :scale scale)
                    (draw-terrain canvas map)
                    (loop for way in ways for i from 0
                          do (draw-way-on-map canvas way
                                              (nth (mod i (length *way-colors*)) *way-colors*)))
                    (values (* scale (map-width map)) (* scale (map-height map))))))
              file kind)))
