;;;; popup.lisp -- a list of rows on top of the window: menus, help, layers, robots.

(in-package :ars-magna.clim)

;;; A window has one popup, shown or not. It is a pane above the others, so nothing waits for it and
;;; the world continues behind it. It is painted again whenever a pane below it is.

(defstruct (row (:constructor make-row (text &key more action tick stays-p)) (:copier nil))
  "A row of the popup, with TEXT, and MORE in a second column. A click on the row calls ACTION, NIL
or a function of no arguments, and closes the popup unless STAYS-P. TICK is NIL if the row has no
check box, else a function that returns true if the box is ticked."
  (text "" :type string :read-only t)
  (more nil :type (or null string) :read-only t)
  (action nil :type (or null function) :read-only t)
  (tick nil :type (or null function) :read-only t)
  (stays-p nil :read-only t))

(defconstant +row-height+ 18 "The height of a row, in pixels.")

(defclass popup-pane (display-pane)
  ((rows :initform '() :accessor pane-rows)
   ;; The row under the mouse, or NIL.
   (pointed :initform nil :accessor pane-pointed)
   ;; The command or menu that has opened it, or T.
   (opener :initform t :accessor pane-opener)
   ;; The time of the click that has replaced the rows, in milliseconds, or NIL.
   (turned :initform nil :accessor pane-turned))
  (:default-initargs :background (clim-ink +popup-color+))
  (:documentation "The popup of a window: a list of rows above its other panes."))

(defun window-popup (window) (pane-named window 'popup))

(defun popup-open-p (window)
  (let ((popup (window-popup window)))
    (and popup (clim:sheet-enabled-p popup))))

;;; Painting.

(defun row-ticked-p (row) (and (row-tick row) (funcall (row-tick row)) t))

(defmethod pane-appearance ((pane popup-pane))
  (list (pane-offset pane) (pane-pointed pane)
        (loop for row in (pane-rows pane)
              collect (list (row-text row) (row-more row) (row-ticked-p row)))))

(defun row-text-x (row) (if (row-tick row) 22 8))

(defun row-text-end (row) (+ (row-text-x row) (label-width (row-text row))))

(defun second-column-x (rows)
  "Return the x coordinate of the second column of ROWS, in pixels."
  (+ 16 (loop for row in rows when (row-more row) maximize (row-text-end row))))

(defun draw-tick-box (canvas row y)
  (draw-rectangle canvas draw-gcontext* 6 (+ y 4) 9 9)
  (when (row-ticked-p row)
    (with-lines (:width 2)
      (draw-lines canvas draw-gcontext* (list 7 (+ y 8) 10 (+ y 12) 16 (+ y 3))))))

(defun draw-row (canvas row y width more-x pointed-p)
  (when (and pointed-p (row-action row))
    (with-gcontext (draw-gcontext* :foreground +pointed-color+)
      (draw-rectangle canvas draw-gcontext* 1 y (- width 2) +row-height+ t)))
  (when (row-tick row) (draw-tick-box canvas row y))
  (draw-label canvas (row-text-x row) (+ y 13) (row-text row))
  (when (row-more row)
    (with-gcontext (draw-gcontext* :foreground +secondary-text-color+)
      (draw-label canvas more-x (+ y 13) (row-more row)))))

(defmethod paint ((pane popup-pane))
  (multiple-value-bind (width height) (pane-size pane)
    (with-pane-canvas (canvas pane)
      (with-origin (canvas 0 (- 3 (pane-offset pane)))
        (loop with more-x = (second-column-x (pane-rows pane))
              for row in (pane-rows pane)
              for y from 0 by +row-height+
              do (draw-row canvas row y width more-x (eq row (pane-pointed pane))))))
    (clim:draw-rectangle* pane 0 0 (1- width) (1- height)
                          :filled nil :ink (clim-ink +border-color+))))

(defun repaint-popup-if-covered (pane)
  "Paint the popup again if it is open and the painting of PANE may have covered it."
  (unless (or (typep pane 'popup-pane)
              (clim:sheet-direct-mirror pane)
              (not (popup-open-p (window-of pane))))
    (flet ((place (pane)
             (clim:transform-region (clim:sheet-transformation pane) (clim:sheet-region pane))))
      (let ((popup (window-popup (window-of pane))))
        (when (clim:region-intersects-region-p (place pane) (place popup))
          (repaint popup))))))

;;; Opening and closing.

(defun place-popup (popup x y)
  "Move POPUP to X, Y and make it as large as its rows need, but keep it inside the window."
  (multiple-value-bind (room-x room-y) (pane-size (clim:sheet-parent popup))
    (let* ((rows (pane-rows popup))
           (more-x (second-column-x rows))
           (end (loop for row in rows
                      maximize (if (row-more row)
                                   (+ more-x (label-width (row-more row)))
                                   (row-text-end row))))
           (width (min room-x (+ end 12 +scroll-bar-width+)))
           (extent (+ 6 (* +row-height+ (length rows))))
           (height (min room-y extent)))
      (setf (pane-extent popup) extent
            (pane-offset popup) 0)
      (place-pane popup (max 0 (min x (- room-x width))) (max 0 (min y (- room-y height)))
                  width height))))

(defun open-popup (window rows x y &optional (opener t))
  "Open the popup of WINDOW with ROWS and its upper left corner at X, Y. OPENER is what opens it:
the symbol of a command, the menu to show, or T."
  (let ((popup (window-popup window)))
    (setf (pane-rows popup) rows
          (pane-opener popup) opener
          (pane-pointed popup) nil)
    (place-popup popup x y)
    (clim:raise-sheet popup)
    (repaint popup)))

(defun popup-opener (window)
  (and (popup-open-p window) (pane-opener (window-popup window))))

(defun close-popup (window)
  "Close the popup of WINDOW. Return the command or menu that opened it, or NIL if none was open."
  (let ((opener (popup-opener window)))
    (when opener
      (setf (clim:sheet-enabled-p (window-popup window)) nil)
      (repaint-all window)
      (show-description-at-mouse window)
      opener)))

;;; The mouse.

(defun row-at (pane y)
  (nth (max 0 (floor (+ y -3 (pane-offset pane)) +row-height+)) (pane-rows pane)))

(defun choose-row (pane row)
  (let ((window (window-of pane)))
    (unless (and row (row-stays-p row)) (close-popup window))
    (when (and row (row-action row))
      (with-guarded-command (window (row-text row)) (funcall (row-action row))))
    (when (popup-open-p window) (repaint pane))))

(defmethod handle-click ((pane popup-pane) button x y)
  (declare (ignore button x))
  (choose-row pane (row-at pane y)))

(defmethod handle-hover ((pane popup-pane) x y)
  (declare (ignore x))
  (setf (pane-pointed pane) (row-at pane y))
  (repaint-if-changed pane))

;;; A click on a row may replace the rows. A double click's second click is not meant for these.

(defconstant +double-click-time+ 500
  "The longest time between the two clicks of a double click, in milliseconds.")

(defmethod clim:handle-event :around ((pane popup-pane) (event clim:pointer-button-press-event))
  (let ((rows (pane-rows pane)) (turned (pane-turned pane)) (time (clim:event-timestamp event)))
    (unless (and turned time (<= 0 (- time turned) +double-click-time+))
      (setf (pane-turned pane) nil)
      (call-next-method)
      (unless (eq rows (pane-rows pane)) (setf (pane-turned pane) time)))))

;;;; Help, layers and robots

(defparameter *mouse-help*
  '(("hover" "the strip at the bottom describes what is there")
    ("click" "select a thing and describe it among the commands")
    ("right button" "open a menu of actions")
    ("drag the map" "move the view; the mouse wheel zooms")
    ("drag a thing" "move the thing, while time stands still")
    ("titles, splitters" "click to fold a display, drag to resize it")
    ("designators" "if too long: left button scrolls down, right up, middle opens menu"))
  "Lists (gesture effect): the rows of the help panel on the mouse.")

(defparameter *key-help*
  '(("tab" "give the keys to the next display; with shift, to the last")
    ("arrows" "move the view, or scroll; left and right fold and unfold")
    ("page up, down" "scroll by a page; in the world, zoom")
    ("< >" "choose the previous or next object of the display")
    ("M" "open the menu of actions of the object, as the menu key does")
    ("return" "click on the chosen object, or go back to the input line")
    ("escape" "close this panel, or go back to the input line")
    ("F10" "open the menus: arrows move, return chooses"))
  "Lists (key effect): the rows of the help panel on keys that are not keys of buttons.")

(defun help-rows ()
  (flet ((rows (lists)
           (loop for (text more) in lists
                 collect (make-row (format nil "  ~A" text) :more more))))
    (append (list (make-row "Keys, after Tab in an empty line, or a click on a display"))
            (rows (loop for button in *bar-buttons*
                        collect (list (key-label (button-key button)) (button-help button))))
            (rows *key-help*)
            (list (make-row "") (make-row "Mouse"))
            (rows *mouse-help*))))

;;; Layers.

(defun toggle-layer (window layer)
  (let ((layers (window-layers window)))
    (setf (preferences-layers (window-preferences window))
          (if (member layer layers) (remove layer layers) (cons layer layers)))
    (repaint-if-changed (pane-named window 'world))))

(defun layer-names-text (layer)
  "Return the names of LAYER at the prompt, or NIL if they are like its title."
  (let ((names (layer-prompt-text layer)))
    (unless (string-equal (layer-title layer) names) (string-downcase names))))

(defun layer-rows (window)
  "Return the rows of the panel of layers. The layers for title and legend have no rows, because the
window has a title and the mouse shows what things are."
  (flet ((layer-row (layer)
           (make-row (layer-title layer) :more (layer-names-text layer)
                     :tick (lambda () (member layer (window-layers window)))
                     :action (lambda () (toggle-layer window layer)) :stays-p t)))
    (append (mapcar #'layer-row (remove :legend (remove :title (picture-layers))))
            (list (make-row "In colour" :tick (lambda () (window-color-p window))
                                        :action (lambda () (toggle-color window)) :stays-p t)))))

(defun toggle-color (window)
  (setf (preferences-color-p (window-preferences window)) (not (window-color-p window)))
  (repaint-all window))

;;; Robots.

(defun shown-robot-name (window)
  (watcher-robot (window-watcher window)))

(defun shown-robot-label (window)
  "Return the name of the robot that WINDOW shows, as a text."
  (ars-magna.cli:label-in-run (shown-robot-name window) (window-simulation window)))

(defun window-robots (window)
  "Return the images of the robots of the run that WINDOW shows."
  (let ((snapshot (window-snapshot window)))
    (and snapshot (snapshot-robots snapshot))))

(defun robot-rows (window)
  "Return the rows of the menu that chooses the robot to command at the prompt and to show."
  (flet ((robot-row (image)
           (make-row (robot-image-label image)
                     :tick (lambda () (eq (robot-image-name image) (shown-robot-name window)))
                     :action (lambda ()
                               (run-line-at-prompt (window-conversation window)
                                                   (format nil "robot ~(~A~)"
                                                           (robot-image-label image)))))))
    (cons (make-row "Which robot?") (mapcar #'robot-row (window-robots window)))))
