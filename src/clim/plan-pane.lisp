;;;; plan-pane.lisp -- the place of the display of plans.

(in-package :ars-magna.clim)

(defclass plan-pane (display-pane) ()
  (:documentation "The pane that shows the plans of the run."))

(defmethod pane-content ((pane plan-pane)) (multiple-value-list (pane-size pane)))

(defmethod paint ((pane plan-pane)) (clear pane))
