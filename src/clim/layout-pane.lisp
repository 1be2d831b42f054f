;;;; layout-pane.lisp -- the pane that holds all others and puts them where ARRANGE says.

(in-package :ars-magna.clim)

(defun pane-named (window name)
  "Return the part of WINDOW called NAME, or NIL."
  (let ((pane (gethash name (window-panes window))))
    ;; CLIM may have made the panes of the layout anew.
    (if (and pane (clim:sheet-ancestor-p pane (clim:frame-top-level-sheet window)))
        pane
        (setf (gethash name (window-panes window)) (clim:find-pane-named window name)))))

(defclass layout-pane (clim:bboard-pane)
  (;; Where its children were put last, as ARRANGE says it.
   (places :initform '() :accessor pane-places))
  (:documentation "The pane that holds all parts of the window."))

(defun pane-wishes (layout) (window-wishes (clim:pane-frame layout)))

(define-constant +first-size+ '(1180 820)
  :test #'equal
  :documentation "How wide and high a window is at first, in pixels, where the screen has room.")

(defun screen-size (pane)
  "Return the width and height of the screen that PANE is to be shown on, or NIL and NIL."
  (let ((graft (clim:graft pane)))
    (if graft
        (values (clim:graft-width graft) (clim:graft-height graft))
        (values nil nil))))

(defun first-size (pane)
  "Return how wide and high PANE should be at first: no larger than the screen."
  (multiple-value-bind (width height) (screen-size pane)
    (values (min (first +first-size+) (or width 10000))
            (min (second +first-size+) (- (or height 10000) 60)))))

(defmethod clim:compose-space ((pane layout-pane) &key width height)
  (declare (ignore width height))
  (multiple-value-bind (width height) (first-size pane)
    (clim:make-space-requirement
     :width width :min-width 320 :max-width clim:+fill+
     :height height :min-height 240 :max-height clim:+fill+)))

(defun place-pane (pane left top width height)
  "Put PANE where the rest says; one without room is not shown."
  (let ((there-p (and (plusp width) (plusp height))))
    (setf (clim:sheet-enabled-p pane) there-p)
    (when there-p
      (clim:move-and-resize-sheet pane left top width height)
      (clim:allocate-space pane width height))))

(defun places (layout)
  "Return where all parts of the window belong now, as the wishes of LAYOUT, their pane, want it."
  (multiple-value-bind (width height) (pane-size layout)
    (let* ((window (clim:pane-frame layout))
           (column (details-width (pane-wishes layout) width)))
      (arrange (pane-wishes layout)
               (lambda (section) (section-need (pane-named window section) section column))
               width height))))

(defun arrange-panes (layout)
  "Put all parts of the window where they belong now."
  (let ((window (clim:pane-frame layout)))
    (point-nowhere window)
    (setf (pane-places layout) (places layout))
    (loop for (name . place) in (pane-places layout)
          for pane = (child-with layout (pane-named window name))
          when pane do (apply #'place-pane pane place))))

(defun child-with (layout pane)
  "Return the child of LAYOUT that is or holds PANE; CLIM may put borders around panes."
  (loop for sheet = pane then (clim:sheet-parent sheet)
        while sheet
        when (eq layout (clim:sheet-parent sheet)) return sheet))

(defmethod clim:allocate-space ((pane layout-pane) width height)
  (clim:resize-sheet pane width height)
  (arrange-panes pane))

(defparameter *first-needs*
  '((state 108) (designators 22) (cameras 140) (hands 84) (bins 84) (plan 100))
  "How many pixels high sections would like to be of which nothing is known yet; designators and
plans would never like to be lower.")

(defun first-need (section) (second (assoc section *first-needs*)))

(defgeneric section-need (pane section width)
  (:documentation "Return how many pixels high PANE, which shows SECTION, would like to be if it is
WIDTH pixels wide.")
  (:method (pane section width)
    (declare (ignore width))
    (max (pane-extent pane) (first-need section)))
  (:method ((pane detail-pane) section width)
    (if (window-robot (window-of pane))
        (max (detail-height pane (max 1 (- width +scroll-bar+)))
             (if (eq section 'designators) (first-need section) 0))
        (first-need section))))

(defun window-layout (window)
  "Return the pane that holds all parts of WINDOW."
  (pane-named window 'layout))

(defun rearrange (window)
  "Put all parts of WINDOW where its wishes want them now."
  (arrange-panes (window-layout window))
  (repaint-all window))

(defun settle (window)
  "Give each display of WINDOW the room that it needs for what it shows now."
  (let ((layout (window-layout window)))
    (unless (equal (places layout) (pane-places layout)) (rearrange window))))

;;; Folding.

(defun folded-p (window section)
  (and (member section (wishes-folded (window-wishes window))) t))

(defun fold (window section &optional (folded-p t))
  "Show only the title of SECTION in WINDOW; or, if FOLDED-P is false, all of it."
  (unless (eq folded-p (folded-p window section))
    (let ((wishes (window-wishes window)))
      (setf (wishes-folded wishes)
            (if folded-p
                (cons section (wishes-folded wishes))
                (remove section (wishes-folded wishes)))))
    (rearrange window)))
