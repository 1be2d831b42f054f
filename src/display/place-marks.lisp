;;;; place-marks.lisp -- how the built-in place types are marked (manual B).

(in-package :ars-magna.display)

;;; Each is a :graphics function as a user would write it. A circle denotes a convex corner, a dot a
;;; concave one or a beak, a square a doorway; on a display with colours over a tint, in a dark
;;; shade of the same hue, so that the tint need not be told from others.

(defun fill-cell (canvas x y color)
  "Tint the cell, if there are colours."
  (when in-color*
    (with-color color
      (draw-rectangle canvas draw-gcontext* x y graphics-scale* graphics-scale* t))))

;; As reading 209 says.
(defun draw-dot (canvas x y)
  (let* ((size (max 2 (floor graphics-scale* 3)))
         (margin (/ (- graphics-scale* size) 2)))
    (draw-arc canvas draw-gcontext* (+ x margin) (+ y margin) size size 0 2pi t)))

;; As reading 68 says.
(defun draw-convex (canvas x y)
  (fill-cell canvas x y (svref lightred* 9))
  (with-color (svref lightred* 0)
    (draw-arc canvas draw-gcontext* x y graphics-scale* graphics-scale* 0 2pi nil)))

(defun draw-concave (canvas x y)
  (fill-cell canvas x y (svref lightred* 11))
  (with-color (svref lightred* 0) (draw-dot canvas x y)))

(defun draw-beak (canvas x y)
  (fill-cell canvas x y (svref violet* 11))
  (with-color (svref violet* 0) (draw-dot canvas x y)))

(defun draw-doorway (canvas x y)
  (fill-cell canvas x y (svref lightblue* 9))
  (with-color (svref lightblue* 0)
    (draw-rectangle canvas draw-gcontext* (1+ x) (1+ y)
                    (- graphics-scale* 2) (- graphics-scale* 2) nil)))

(loop for (name function) in '((convex draw-convex) (concave draw-concave)
                               (beak draw-beak) (doorway draw-doorway))
      do (setf (place-type-graphics (find-place-type name)) (symbol-function function)))
