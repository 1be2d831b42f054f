;;;; world-mouse.lisp -- the mouse on the display of the world.

(in-package :ars-magna.clim)

;;; The wheel zooms. The left button selects by a click and moves the view by dragging. While time
;;; stands still, it drags things and robots to another place: a ghost shows where, and the prompt
;;; then gets the line that a user would type. While time passes, the status strip says what to do
;;; first. (PANE-DRAG PANE) is (subject from-x from-y moved-p).

(defmethod handle-wheel ((pane world-pane) steps x y)
  (zoom-view pane (expt 2 (- (signum steps))) x y))

(defun map-point-at (pane x y)
  "Return the map coordinates of the point that PANE shows at X, Y, in metres, as two values."
  (let ((scale (pane-scale pane)))
    (values (/ (+ x (pane-left pane)) scale) (/ (+ y (pane-top pane)) scale))))

(defun cell-at (pane x y)
  (when (in-view-p pane x y)
    (let ((map (view-map pane)))
      (multiple-value-bind (x y) (map-point-at pane x y)
        (and (map-index map x y) (map-cell map x y))))))

(defmethod subjects-under ((pane world-pane) x y)
  (when (in-view-p pane x y)
    (let ((cell (cell-at pane x y)))
      (append (call-next-method) (and cell (list cell))))))

(defmethod hover-text ((pane world-pane) x y)
  (let* ((subjects (subjects-under pane x y)) (cell (find-if #'cell-p subjects)))
    (format nil "~{~A~^; ~}"
            (cl:mapcar #'subject-description
                        (if cell (cons cell (remove cell subjects)) subjects)))))

(defmethod handle-press ((pane world-pane) button x y)
  (if (eq button :left)
      (setf (pane-drag pane) (list (draggable-at pane x y) x y nil))
      (handle-click pane button x y)))

;;; Dragging.

(defun at-robot-middle-p (pane image x y)
  (multiple-value-bind (to-x to-y) (map-point-at pane x y)
    (let ((reach (/ (with-canvas ((make-instance 'canvas) :scale (pane-scale pane))
                      (robot-radius))
                    2 (pane-scale pane))))
      (<= (max (abs (- to-x (robot-image-x image))) (abs (- to-y (robot-image-y image))))
          reach))))

(defun robots-at-middle (pane subjects x y)
  "Return the robots among SUBJECTS with their middles close to X, Y of PANE, the shown robot
first."
  (let ((robots (remove-if-not (lambda (subject)
                                 (and (typep subject 'robot-image)
                                      (at-robot-middle-p pane subject x y)))
                               subjects)))
    (stable-sort robots (lambda (one other) (and one (not other)))
                 :key (lambda (image) (shown-robot-p (window-of pane) image)))))

(defun draggable-at (pane x y)
  "Return the thing or robot that a drag from X, Y of PANE moves, or NIL. Of several objects at X,
Y, return the selected one, else a robot with its middle there, else the smallest."
  (let ((subjects (remove-if-not (lambda (subject) (typep subject '(or thing-image robot-image)))
                                 (subjects-under pane x y)))
        (key (window-selection (window-of pane))))
    (or (and key (find key subjects :key #'subject-key :test #'equal))
        (first (robots-at-middle pane subjects x y))
        (first subjects))))

(defun draggable-now-p (pane subject)
  "True if SUBJECT can be dragged in PANE: it is a thing or a robot, and time stands still."
  (and (typep subject '(or thing-image robot-image))
       (let ((simulation (window-simulation (window-of pane))))
         (or (paused-p simulation) (not (live-p simulation)) (idle-p simulation)))))

(defmethod handle-drag ((pane world-pane) x y)
  (destructuring-bind (subject from-x from-y moved-p) (pane-drag pane)
    (when (or moved-p (moved-far-p x y from-x from-y))
      (setf (pane-drag pane) (list subject from-x from-y t))
      (cond ((draggable-now-p pane subject) (show-drop-place pane subject x y))
            (subject (refuse-drag pane subject))
            (t (setf (pane-drag pane) (list nil x y t))
               (move-view pane (- from-x x) (- from-y y)))))))

(defun refuse-drag (pane subject)
  "Say in the status strip why SUBJECT cannot be dragged now in PANE. The view does not move,
because everything in it, SUBJECT too, would move with the mouse."
  (setf (pane-ghost pane) nil)
  (show-hint (window-of pane)
             (format nil "To move ~A, pause the run first (space). To move the view, drag an empty ~
                          place." (subject-title subject)))
  (repaint-if-changed pane))

(defun show-drop-place (pane subject x y)
  "Mark in PANE the place X, Y where SUBJECT would be dropped, and describe the place in the strip."
  (multiple-value-bind (to-x to-y) (map-point-at pane x y)
    (setf (pane-ghost pane) (list x y))
    (show-hint (window-of pane)
               (if (cell-at pane x y)
                   (format nil "~A to ~,2F, ~,2F~:[~;, inside a wall~]" (subject-title subject)
                           to-x to-y (wall-at-p (view-map pane) to-x to-y))
                   (format nil "~A: this place is not on the map" (subject-title subject))))
    (repaint-if-changed pane)))

(defun paint-drop-place (pane)
  (when (pane-ghost pane)
    (destructuring-bind (x y) (pane-ghost pane)
      (let ((radius (max 5 (* 1/2 (pane-scale pane)))))
        (clim:draw-circle* pane x y radius :filled nil :ink clim:+dark-orange+
                                           :line-thickness 2)))))

(defgeneric subject-moving-line (subject x y window)
  (:documentation "Return the prompt line that moves SUBJECT in WINDOW to X, Y. X and Y are texts.")
  (:method ((image thing-image) x y window)
    (declare (ignore window))
    (format nil "(move-thing ~A ~A ~A)" (find-thing-form-text image) x y))
  (:method ((image robot-image) x y window)
    (if (shown-robot-p window image)
        (format nil "pos ~A ~A" x y)
        (format nil "(place-robot (find-robot '~A) ~A ~A ~,3F)"
                (text-as-typed (robot-image-name image)) x y (robot-image-angle image)))))

(defun drop-subject (pane subject x y)
  (let ((window (window-of pane)))
    (setf (pane-ghost pane) nil)
    (if (cell-at pane x y)
        (multiple-value-bind (x y) (map-point-at pane x y)
          (run-line-at-prompt (window-conversation window)
                              (subject-moving-line subject (coordinate-text x) (coordinate-text y)
                                                   window))
          (show-hint window ""))
        (show-hint window "This place is not on the map."))
    (repaint-if-changed pane)))

(defmethod handle-drop ((pane world-pane) x y)
  (destructuring-bind (subject from-x from-y moved-p) (pane-drag pane)
    (declare (ignore from-x from-y))
    (cond ((not moved-p) (handle-click pane :left x y))
          ((draggable-now-p pane subject) (drop-subject pane subject x y))
          (subject (refuse-drag pane subject)))))
