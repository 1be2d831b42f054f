;;;; layout-pane.lisp -- the pane that holds all others, placed by ARRANGE; splitters and titles.

(in-package :ars-magna.clim)

(defun pane-named (window name)
  (let ((pane (gethash name (window-panes window))))
    ;; CLIM may have made the panes of the layout anew.
    (if (and pane (clim:sheet-ancestor-p pane (clim:frame-top-level-sheet window)))
        pane
        (setf (gethash name (window-panes window)) (clim:find-pane-named window name)))))

(defclass layout-pane (clim:bboard-pane)
  (;; Where its children were put last, as ARRANGE says it.
   (places :initform '() :accessor pane-places)
   ;; The most pixels that each section has needed, as (section pixels), and what was shown then.
   (needed :initform '() :accessor pane-needed)
   (shown :initform nil :accessor pane-shown))
  (:default-initargs :background (clim-ink +outside-color+))
  (:documentation "The pane that holds all parts of the window."))

(defun pane-preferences (layout) (window-preferences (clim:pane-frame layout)))

(define-constant +first-size+ '(1180 820)
  :test #'equal
  :documentation "A window's initial width and height in pixels, if the screen has room.")

(defun screen-size (pane)
  "Return the width and height of the screen of PANE, or NIL and NIL if they are unknown."
  (graft-size (clim:graft pane)))

(defmethod clim:compose-space ((pane layout-pane) &key width height)
  (declare (ignore width height))
  (let ((magnification (magnification pane)))
    (multiple-value-bind (width height) (screen-size pane)
      (clim:make-space-requirement
       :width (min (* magnification (first +first-size+)) (or width 10000))
       :min-width (min (* magnification (first +smallest-size+)) (or width 10000))
       :max-width clim:+fill+
       :height (min (* magnification (second +first-size+)) (- (or height 10000) 60))
       :min-height (min (* magnification (second +smallest-size+)) (- (or height 10000) 60))
       :max-height clim:+fill+))))

(defun place-pane (pane left top width height)
  "Show PANE at LEFT, TOP, WIDTH x HEIGHT pixels large. Hide PANE if WIDTH or HEIGHT is 0."
  (let ((there-p (and (plusp width) (plusp height))))
    ;; Move it before it is shown, so that it never appears at the old place.
    (when there-p (move-and-resize-pane pane left top width height))
    (setf (clim:sheet-enabled-p pane) there-p)))

;;; A display grows when it has more to show, but does not shrink when it has less: titles and
;;; switches should not move from under the mouse during a run. It shrinks when the user changes the
;;; arrangement or what is shown, or when another display needs the room.

(defun current-height-needs (layout)
  "Return lists (section pixels): the height that each open section in the column of LAYOUT needs."
  (let* ((window (clim:pane-frame layout)) (preferences (pane-preferences layout))
         (width (pane-size layout)) (column (details-width preferences width)))
    (loop for section in (column-sections preferences width)
          unless (member section (preferences-folded preferences))
            collect (list section
                          (needed-section-height (pane-named window section) section column)))))

(defun needed-height-function (needs)
  "Return a function that returns the height of a section in NEEDS, lists (section pixels), or 0."
  (lambda (section) (or (second (assoc section needs)) 0)))

(defun compute-layout-places (layout needs)
  "Return the places of all parts of LAYOUT. NEEDS are lists (section pixels) of needed heights."
  (multiple-value-call #'compute-places (pane-preferences layout) (needed-height-function needs)
                       (pane-size layout)
    (input-line-rows layout)))

(defun input-line-rows (layout)
  (let ((interactor (pane-named (clim:pane-frame layout) 'interactor)))
    (if (and interactor (window-conversation (clim:pane-frame layout)))
        (needed-rows interactor)
        +least-prompt-rows+)))

(defun needs-met-p (places needs)
  "True if PLACES give each section at least its height in NEEDS, lists (section pixels). The
tall sections are ignored, because they take any height."
  (loop for (section pixels) in needs
        always (or (member section +tall-sections+)
                   (<= pixels (fifth (assoc section places))))))

(defun greatest-height-needs (layout)
  "Return lists (section pixels): the greatest height that each section of LAYOUT has needed so far.
If only the heights needed now fit, return those."
  (let* ((now (current-height-needs layout))
         (before (needed-height-function (pane-needed layout)))
         (most (loop for (section pixels) in now
                     collect (list section (max pixels (funcall before section))))))
    (flet ((enough-for-all-p (needs) (needs-met-p (compute-layout-places layout needs) now)))
      (if (and (not (enough-for-all-p most)) (enough-for-all-p now))
          now
          most))))

(defun update-absent-sections (window)
  "Give the display of plots of WINDOW room if anything is plotted. Unfold it when it gets room."
  (let ((preferences (window-preferences window))
        (absent (if (anything-plotted-p window) '() '(plots))))
    (unless (equal absent (preferences-absent preferences))
      (setf (preferences-absent preferences) absent)
      (when (and (null absent) (section-folded-p window 'plots))
        (removef (preferences-folded preferences) 'plots)
        (set-plots-folded window nil)))))

(defun places-of-parts (layout)
  "Return the places of all parts of LAYOUT for the user's preferences and the sections' needs."
  (update-absent-sections (clim:pane-frame layout))
  (let* ((window (clim:pane-frame layout))
         (shown (list (window-simulation window) (shown-robot-name window))))
    (unless (equal shown (shiftf (pane-shown layout) shown))
      (setf (pane-needed layout) '())))
  (compute-layout-places layout (setf (pane-needed layout) (greatest-height-needs layout))))

(defun place-parts (layout places)
  (let ((window (clim:pane-frame layout)))
    (clear-description window)
    (setf (pane-places layout) places)
    (loop for (name . place) in places
          for pane = (child-holding layout (pane-named window name))
          when pane do (apply #'place-pane pane place))))

(defun arrange-panes (layout)
  "Arrange all parts of LAYOUT by the heights that they need now. Earlier needs are ignored."
  (setf (pane-needed layout) '())
  (place-parts layout (places-of-parts layout)))

(defun child-holding (layout pane)
  "Return the child of LAYOUT that is or contains PANE, because CLIM may put borders around PANE."
  (loop for sheet = pane then (clim:sheet-parent sheet)
        while sheet
        when (eq layout (clim:sheet-parent sheet)) return sheet))

(defmethod clim:allocate-space ((pane layout-pane) width height)
  (clim:resize-sheet pane width height)
  (arrange-panes pane))

(defparameter *initial-heights*
  '((state 108) (designators 22) (cameras 140) (hands 84) (bins 84) (plan 100)
    (parameters 100))
  "Lists (section pixels): the height of each section before its contents are known. It is also the
least height of the designators.")

(defun initial-height (section) (second (assoc section *initial-heights*)))

(defconstant +plan-height-step+ (* 5 +line-height+)
  "The step in which the display of plans grows, in pixels.")

(defgeneric needed-section-height (pane section width)
  (:documentation "Return the height that PANE, which shows SECTION, needs at WIDTH, in pixels.")
  (:method (pane section width)
    (declare (ignore width))
    (max (pane-extent pane) (initial-height section)))
  ;; Tasks come and go while a plan runs. Other displays should not move each time.
  (:method ((pane plan-pane) section width)
    (declare (ignore width))
    (max (* +plan-height-step+ (ceiling (pane-extent pane) +plan-height-step+))
         (initial-height section)))
  (:method ((pane parameter-pane) section width)
    (declare (ignore section width))
    (panel-height pane))
  (:method ((pane plot-pane) section width)
    (declare (ignore section width))
    (plots-height pane))
  (:method ((pane detail-pane) section width)
    (if (window-robot (window-of pane))
        (max (+ +section-bottom-margin+
                (cached-content-height pane (max 1 (- width +scroll-bar-width+))))
             (if (eq section 'designators) (initial-height section) 0))
        (initial-height section))))

(defun window-layout (window)
  (pane-named window 'layout))

(defun rearrange (window)
  "Arrange all parts of WINDOW anew by the user's preferences, and paint them."
  (arrange-panes (window-layout window))
  (repaint-all window))

(defun rearrange-if-needed (window)
  "Arrange and paint the parts of WINDOW again if the contents of its displays need other heights."
  (let* ((layout (window-layout window)) (places (places-of-parts layout)))
    (unless (equal places (pane-places layout))
      (place-parts layout places)
      (repaint-all window))))

;;; Folding.

(defun section-folded-p (window section)
  (folded-p section (window-preferences window)))

(defun fold-section (window section &optional (folded-p t))
  "Fold SECTION of WINDOW, so that only its title is shown. If FOLDED-P is false, unfold SECTION."
  (unless (eq folded-p (section-folded-p window section))
    (let ((preferences (window-preferences window)))
      (setf (preferences-folded preferences)
            (if folded-p
                (cons section (preferences-folded preferences))
                (remove section (preferences-folded preferences)))))
    (when (eq section 'plots) (set-plots-folded window folded-p))
    (rearrange window)))

;;; A section that has nothing to show at the start is folded. It opens by itself once, unless the
;;; user has folded or unfolded it before.

(defun section-has-contents-p (window section)
  "True if SECTION of WINDOW has more to show than that there is nothing."
  (let ((robot (window-robot window)))
    (ecase section
      (designators (robot-image-designators robot))
      (cameras (some (lambda (camera)
                       (or (camera-image-view camera) (camera-image-track camera)
                           (camera-image-location camera)))
                     (robot-image-cameras robot)))
      (hands (some (lambda (hand) (or (hand-image-contents hand) (hand-image-location hand)))
                   (robot-image-hands robot)))
      (bins (some #'bin-image-contents (robot-image-bins robot)))
      (plan (plan-running-p (plan-look-simulation (plan-look-of (pane-named window 'plan))))))))

(defun mark-section-seen (window section)
  (let ((preferences (window-preferences window)))
    (setf (preferences-unseen preferences) (remove section (preferences-unseen preferences)))))

(defun open-sections-with-contents (window)
  "Unfold the sections of WINDOW that have something to show for the first time."
  (when (window-robot window)
    (dolist (section (preferences-unseen (window-preferences window)))
      (when (section-has-contents-p window section)
        (mark-section-seen window section)
        (fold-section window section nil)))))

;;; Bars between parts of the window that can be dragged.

(defclass splitter-pane (display-pane) ()
  (:default-initargs :background (clim-ink +splitter-color+))
  (:documentation "A bar between two parts of the window. The user can drag the bar."))

(defgeneric drag-splitter (name preferences layout x y)
  (:documentation "Change PREFERENCES so that the splitter NAME moves to X, Y of LAYOUT.")
  (:method ((name (eql 'side-splitter)) preferences layout x y)
    (declare (ignore y))
    (let* ((width (pane-size layout)) (right (max 120 (- width x +splitter-width+))))
      (if (plan-column-p preferences width)
          (setf (preferences-plan-width preferences)
                (max 120 (- right (details-width preferences width) +splitter-width+)))
          (setf (preferences-details-width preferences) right))))
  (:method ((name (eql 'plan-splitter)) preferences layout x y)
    (declare (ignore y))
    ;; The world keeps its size: what one of the columns gains the other loses.
    (let* ((width (pane-size layout))
           (both (+ (plan-width preferences width) (details-width preferences width))))
      (setf (preferences-details-width preferences)
            (clamp (- width x +splitter-width+) 120 (- both 120))
            (preferences-plan-width preferences) (- both (preferences-details-width preferences)))))
  (:method ((name (eql 'low-splitter)) preferences layout x y)
    (declare (ignore x))
    (setf (preferences-transcript-height preferences)
          (max 40 (- (nth-value 1 (pane-size layout))
                     y +splitter-width+ +least-prompt-height+ +status-strip-height+)))))

(defmethod pane-appearance ((pane splitter-pane))
  (list (multiple-value-list (pane-size pane)) (has-keys-p pane)))

(defmethod paint ((pane splitter-pane))
  (clear-pane pane)
  (when (has-keys-p pane)
    (multiple-value-bind (width height) (pane-size pane)
      (clim:draw-rectangle* pane 0 0 width height :ink clim:+dark-orange+))))

(defmethod handle-press ((pane splitter-pane) button x y)
  (declare (ignore button x y))
  (setf (pane-drag pane) t))

(defmethod hover-text ((pane splitter-pane) x y)
  (declare (ignore x y))
  "Drag to make the parts on either side larger or smaller")

(defmethod handle-drag ((pane splitter-pane) x y)
  (let ((layout (clim:sheet-parent pane)))
    (multiple-value-bind (x y) (position-in-parent pane x y)
      (drag-splitter (clim:pane-name pane) (pane-preferences layout) layout x y)
      (rearrange (window-of pane)))))

;;;; Titles

(defclass title-pane (display-pane)
  ((section :initarg :section :reader pane-section))
  (:default-initargs :background (clim-ink +title-color+))
  (:documentation "The title of a display. A click on the title folds or unfolds the display."))

(defun section-foldable-p (section) (and (member section +sections+) t))

(defun world-title (window)
  "Return the title of the world in WINDOW: the map; the fork or trial, if WINDOW shows one;
and the robot, if the run has several robots."
  (let ((map (and (window-snapshot window) (window-map window)))
        (simulation (window-simulation window)))
    (format nil "World~@[: ~(~A~)~]~@[, ~A~]~@[, ~A of ~D robots~]" (and map (map-name map))
            (and simulation (ars-magna.cli:trial-or-fork-text simulation))
            (and (rest (window-robots window)) (shown-robot-label window))
            (length (window-robots window)))))

(defun section-title (window section)
  (case section
    (world (world-title window))
    (transcript "Commands")
    (plan "Plan")
    (parameters "Parameters")
    (plots (plots-title window))
    (t (display-title (pane-display (pane-named window section))))))

(defmethod pane-appearance ((pane title-pane))
  (let ((window (window-of pane)) (section (pane-section pane)))
    (list (section-title window section) (section-folded-p window section)
          (focused-section-p window section) (multiple-value-list (pane-size pane)))))

(defmethod paint ((pane title-pane))
  (let* ((window (window-of pane)) (section (pane-section pane))
         (foldable-p (section-foldable-p section)))
    (with-pane-canvas (canvas pane)
      (when (focused-section-p window section)
        (multiple-value-bind (width height) (pane-size pane)
          (with-gcontext (draw-gcontext* :foreground +lit-color+)
            (draw-rectangle canvas draw-gcontext* 0 0 width height t))))
      (when foldable-p
        (draw-lines canvas draw-gcontext*
                    (if (section-folded-p window section) '(5 4 10 8 5 12) '(4 6 12 6 8 11))
                    :fill-p t))
      (draw-label canvas (if foldable-p 18 6) 13 (section-title window section) :bold-p t))))

(defmethod hover-text ((pane title-pane) x y)
  (declare (ignore x y))
  (case (pane-section pane)
    (world "Click to choose a robot")
    (transcript "")
    (parameters "Click to close this panel; the key P opens it again")
    (t (if (member (pane-section pane) (preferences-unseen (window-preferences (window-of pane))))
           "Nothing to show yet: this display opens by itself. Click to open it now"
           "Click to fold this display or to unfold it"))))

(defmethod handle-click ((pane title-pane) button x y)
  (declare (ignore button))
  (let ((window (window-of pane)) (section (pane-section pane)))
    (cond ((section-foldable-p section)
           (mark-section-seen window section)
           (fold-section window section (not (section-folded-p window section))))
          ((eq section 'world)
           (multiple-value-bind (x y) (position-in-parent pane x +title-height+)
             (open-popup window (robot-rows window) x y))))))
