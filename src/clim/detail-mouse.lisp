;;;; detail-mouse.lisp -- the mouse on the displays of the robot's parts.

(in-package :ars-magna.clim)

;;; What is drawn there is not where it lies, so it cannot be dragged. Who tries to is told what to
;;; do instead. (PANE-DRAG PANE) is (thing from-x from-y moved-p).

(defun instead-of-dragging (image window)
  "Return in words why the thing of IMAGE cannot be dragged out of a display of WINDOW."
  (let ((hand (hand-with image window)) (name (subject-title image)))
    (cond (hand (format nil "Only lines let go of ~A, such as hand-ungrasp ~D: the right button ~
                             offers them."
                        name (hand-image-index hand)))
          ((thing-image-location image)
           (format nil "~A is ~A: only lines take it out." name (thing-image-location image)))
          (t (format nil "~A can be dragged where it lies in the world." name)))))

(defmethod press ((pane detail-pane) button x y)
  (let ((thing (find-if (lambda (subject) (typep subject 'thing-image))
                        (subjects-under pane x y))))
    (if (and thing (eq button :left))
        (setf (pane-drag pane) (list thing x y nil))
        (click pane button x y))))

(defmethod drag ((pane detail-pane) x y)
  (destructuring-bind (thing from-x from-y moved-p) (pane-drag pane)
    (when (and (not moved-p) (beyond-shake-p x y from-x from-y))
      (setf (pane-drag pane) (list thing from-x from-y t))
      (hint (window-of pane) (instead-of-dragging thing (window-of pane))))))

(defmethod drop ((pane detail-pane) x y)
  (unless (fourth (pane-drag pane)) (click pane :left x y)))
