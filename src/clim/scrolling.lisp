;;;; scrolling.lisp -- what is higher than its pane is scrolled: by the wheel, or a bar beside it.

(in-package :ars-magna.clim)

(defconstant +scroll-bar+ 10 "How wide scroll bars are, in pixels.")

(defgeneric scroll-state (pane)
  (:documentation "Return how far down PANE begins in what it shows, how much is in view, and how
much there is, all in the same unit.")
  (:method (pane)
    (values (pane-offset pane) (nth-value 1 (pane-size pane)) (pane-extent pane))))

(defgeneric scroll-to (pane position)
  (:documentation "Let PANE begin at POSITION, in the unit of SCROLL-STATE.")
  (:method (pane position)
    (setf (pane-offset pane) (max 0 (round position)))
    (limit-offset pane)
    (repaint-if-changed pane)))

(defun scrollable-p (pane)
  (multiple-value-bind (position page total) (scroll-state pane)
    (declare (ignore position))
    (> total page)))

(defun content-width (pane)
  "Return how many pixels of the width of PANE are not the scroll bar's."
  (max 1 (- (pane-size pane) +scroll-bar+)))

(defgeneric limit-offset (pane)
  (:documentation
   "Let PANE begin no further down than there is something. True if that was mended.")
  (:method (pane)
    (let ((room (max 0 (- (pane-extent pane) (nth-value 1 (pane-size pane))))))
      (when (> (pane-offset pane) room)
        (setf (pane-offset pane) room)
        t))))

(defun scroll (pane pixels)
  "Show what is PIXELS further down in the picture in PANE, but not more than there is."
  (scroll-to pane (+ (scroll-state pane) pixels)))

;;; The bar.

(defun thumb (pane)
  "Return where the movable part of the scroll bar of PANE begins and ends, from the top."
  (multiple-value-bind (position page total) (scroll-state pane)
    (let* ((height (nth-value 1 (pane-size pane)))
           (length (clamp (round (* height page) (max 1 total)) (min 12 height) height))
           (top (round (* (- height length) position) (max 1 (- total page)))))
      (values top (+ top length)))))

(defun paint-scroll-bar (pane)
  (when (scrollable-p pane)
    (multiple-value-bind (width height) (pane-size pane)
      (multiple-value-bind (top bottom) (thumb pane)
        (clim:draw-rectangle* pane (- width +scroll-bar+) 0 width height :ink clim:+gray90+)
        (clim:draw-rectangle* pane (- width +scroll-bar+ -2) top (- width 2) bottom
                              :ink clim:+gray55+)))))

(defun on-scroll-bar-p (pane x)
  (and (scrollable-p pane) (>= x (content-width pane))))

(defun drag-scroll-bar (pane y)
  "Scroll PANE so that the middle of the bar's movable part is at Y, as far as that goes."
  (multiple-value-bind (position page total) (scroll-state pane)
    (declare (ignore position))
    (multiple-value-bind (top bottom) (thumb pane)
      (let ((length (- bottom top)) (height (nth-value 1 (pane-size pane))))
        (scroll-to pane (* (- total page)
                           (/ (clamp (- y (/ length 2)) 0 (max 0 (- height length)))
                              (max 1 (- height length)))))))))
