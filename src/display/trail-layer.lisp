;;;; trail-layer.lisp -- the layers of where robots have been, and of where they are about to go.

(in-package :ars-magna.display)

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

(defun trail-line (robot)
  "Return the line of the trail of ROBOT."
  (make-way-line (robot-image-position robot) (pieces-of-trail (robot-image-trail robot))
                 :dashes (layer-dashes :trail) :width 1 :arrows-p nil))

(defun robots-with-trails (snapshot)
  (remove-if-not (lambda (robot) (cddddr (robot-image-trail robot))) (snapshot-robots snapshot)))

(defun draw-trails (canvas robots)
  (draw-way-lines canvas (mapcar #'trail-line robots)))

(defun jump-entry (color)
  "Return the entry for that something was put elsewhere, in COLOR."
  (sample-of (canvas x y) "put elsewhere"
    (draw-jump-dots canvas (list (list (- x 8) y (+ x 7) y)) color)))

(defun trail-jump-entries (snapshot)
  "Return the entry that says how jumps look, as a list, if one is to be seen in SNAPSHOT."
  (let ((trails (mapcar #'robot-image-trail (snapshot-robots snapshot))))
    (and (some #'jumps-p trails)
         (jumps-seen-p (mapcar #'pieces-of-trail trails) (pixels-of (shown-part snapshot)))
         (list (jump-entry (turn-ink 0))))))

;;; Planned ways.

(defun planned-line (robot)
  "Return the line of the way that ROBOT is about to go."
  (make-way-line (robot-image-position robot)
                 (list (pixels-of (apply #'append (robot-image-planned-way robot))))
                 :dashes (layer-dashes :planned-way) :arrows-p nil))

(defun robots-with-plans (snapshot)
  "Return the images of those robots in SNAPSHOT of which it is known where they are about to go."
  (remove-if-not (lambda (robot) (rest (robot-image-planned-way robot)))
                 (snapshot-robots snapshot)))

(defun end-of-planned-way (robot)
  "Return, in pixels, where the way ends that ROBOT is about to go."
  (pixels-of (first (last (robot-image-planned-way robot)))))

(defun ends-of-planned-ways (robots)
  "Return the boxes of the rings where the ways end that ROBOTS are about to go."
  (loop for robot in robots
        collect (destructuring-bind (x y) (end-of-planned-way robot)
                  (box-around x y (+ 2 +mark-radius+)))))

(defun draw-planned-ways (canvas robots)
  "Draw the ways that ROBOTS are about to go, with a ring where each ends."
  (draw-way-lines canvas (mapcar #'planned-line robots))
  (draw-way-marks canvas
                  (loop for robot in robots
                        collect `(draw-start ,@(end-of-planned-way robot)
                                             ,(turn-ink (robot-image-position robot))))))
