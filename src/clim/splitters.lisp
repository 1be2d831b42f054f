;;;; splitters.lisp -- bars between parts of the window that can be dragged.

(in-package :ars-magna.clim)

(defclass splitter-pane (display-pane) ()
  (:default-initargs :background clim:+gray75+)
  (:documentation "A bar between two parts of the window that can be dragged."))

(defgeneric drag-splitter (name wishes layout x y)
  (:documentation "Change WISHES so that the splitter NAME is at X, Y of the pane LAYOUT.")
  (:method ((name (eql 'side-splitter)) wishes layout x y)
    (declare (ignore y))
    (let* ((width (pane-size layout)) (right (max 120 (- width x +splitter+))))
      (if (plan-column-p wishes width)
          (setf (wishes-plan-width wishes)
                (max 120 (- right (details-width wishes width) +splitter+)))
          (setf (wishes-details-width wishes) right))))
  (:method ((name (eql 'plan-splitter)) wishes layout x y)
    (declare (ignore y))
    ;; The world stays as it is: what one of the columns gains the other loses.
    (let* ((width (pane-size layout))
           (both (+ (plan-width wishes width) (details-width wishes width))))
      (setf (wishes-details-width wishes) (clamp (- width x +splitter+) 120 (- both 120))
            (wishes-plan-width wishes) (- both (wishes-details-width wishes)))))
  (:method ((name (eql 'low-splitter)) wishes layout x y)
    (declare (ignore x))
    (setf (wishes-transcript-height wishes)
          (max 40 (- (nth-value 1 (pane-size layout))
                     y +splitter+ +prompt-height+ +strip-height+)))))

(defmethod pane-content ((pane splitter-pane)) (multiple-value-list (pane-size pane)))

(defmethod paint ((pane splitter-pane)) (clear pane))

(defmethod press ((pane splitter-pane) button x y)
  (declare (ignore button x y))
  (setf (pane-drag pane) t))

(defmethod hover-text ((pane splitter-pane) x y)
  (declare (ignore x y))
  "Drag to make the parts on either side larger or smaller")

(defmethod drag ((pane splitter-pane) x y)
  (let ((layout (clim:sheet-parent pane)))
    (multiple-value-bind (x y) (place-outside pane x y)
      (drag-splitter (clim:pane-name pane) (pane-wishes layout) layout x y)
      (rearrange (window-of pane)))))
