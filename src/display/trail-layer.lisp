;;;; trail-layer.lisp -- the layer of where robots have been, in one piece or more.

(in-package :ars-magna.display)

;;; A robot that is put elsewhere, by PLACE-ROBOT or in the window, goes no way from here to there.
;;; So lines end where it was taken away, and begin anew where it was put; dots join the two.

(define-constant +jump-dashes+ '(1 6)
  :test #'cl:equal
  :documentation "The dots and gaps between where a robot was and where it was put, in pixels.")

(defun draw-jump (canvas from to color)
  "Draw that something was put from FROM to TO, lists (x y) in pixels: dots of COLOR."
  (inked (color :width 3/2 :dashes +jump-dashes+)
    (draw-segments canvas draw-gcontext* (append from to))))

(defun draw-pieces (canvas pieces color draw)
  "Draw a way of COLOR: each of PIECES, lists x y ... in pixels, by the function DRAW, and the jumps
between them."
  (loop for (piece next) on pieces
        do (when (cddr piece) (funcall draw piece))
           (when next (draw-jump canvas (last piece 2) (subseq next 0 2) color))))

;;; Trails.

(defun pieces-of-trail (points)
  "Return the pieces, lists x y ... in pixels, of the trail POINTS, newest first."
  (let ((pieces '()) (before nil))
    (do-trail (points x y nil placements)
      do (unless (eql placements before) (push '() pieces))
         (setf before placements)
         (push (to-pixels x) (first pieces))
         (push (to-pixels y) (first pieces)))
    (nreverse (mapcar #'nreverse pieces))))

(defun jumps-p (points)
  "True if POINTS, of a trail, are in pieces."
  (do-trail (points nil nil nil placements)
    thereis (/= placements (fourth points))))

(defun draw-trail (canvas points color)
  "Draw a line of COLOR through POINTS, of a trail."
  (draw-pieces canvas (pieces-of-trail points) color
               (lambda (piece)
                 (inked (color :dashes (layer-dashes :trail))
                   (draw-lines canvas draw-gcontext* piece)))))
