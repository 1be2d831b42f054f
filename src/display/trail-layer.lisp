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

(defun trail-jumps-seen-p (snapshot)
  "True if it is to be seen on trails in SNAPSHOT that robots were put elsewhere."
  (let ((trails (mapcar #'robot-image-trail (snapshot-robots snapshot))))
    (and (some #'jumps-p trails)
         (jumps-seen-p (mapcar #'pieces-of-trail trails) (pixels-of (shown-part snapshot))))))

;;; Planned ways.

(defun planned-line (robot)
  "Return the line of the way that ROBOT is about to go, or NIL if none is known."
  (let ((points (robot-image-planned-way robot)))
    (and (rest points)
         (make-way-line (robot-image-position robot) (list (pixels-of (apply #'append points)))
                        :dashes (layer-dashes :planned-way) :arrows-p nil))))

(defun draw-planned-ways (canvas robots)
  "Draw the ways that ROBOTS are about to go, with a ring where each ends."
  (draw-way-lines canvas (remove nil (mapcar #'planned-line robots)))
  (draw-way-marks canvas
                  (loop for robot in robots
                        for points = (robot-image-planned-way robot)
                        when (rest points)
                          collect `(draw-start ,@(pixels-of (first (last points)))
                                               ,(turn-ink (robot-image-position robot))))))

(defun draw-ways-of-robots (canvas robots layers)
  "Draw what LAYERS list of the ways of ROBOTS."
  (when (member :trail layers) (draw-way-lines canvas (mapcar #'trail-line robots)))
  (when (member :planned-way layers) (draw-planned-ways canvas robots)))
