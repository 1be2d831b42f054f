;;;; choosing.lisp -- keys in place of the mouse: choosing a display, and an object that it shows.

(in-package :ars-magna.clim)

;;; Tab gives the keys to the next display. There, keys choose an object, and then do what a click
;;; on the object would do. (PANE-CHOSEN PANE) is the key of the chosen object, or NIL.

;;; Displays.

(defun section-pane (window section)
  "Return the pane of WINDOW that shows SECTION, or the title of SECTION if it is folded."
  (pane-named window (if (section-folded-p window section) (title-pane-name section) section)))

(defun panes-for-keys (window)
  "Return the panes of WINDOW that Tab goes to, in this order. The input line is the last one."
  (remove-if-not #'pane-shown-p
                 (append (loop for section in (cons 'world +sections+)
                               collect (section-pane window section))
                         (loop for name in +splitters+ collect (pane-named window name))
                         (list (pane-named window 'interactor)))))

(defun focused-section-p (window section)
  "True if the display SECTION of WINDOW, or its title, gets the keys."
  (let ((focus (window-focus window)))
    (and focus
         (member (clim:pane-name focus) (list section (title-pane-name section))))))

(defgeneric keys-hint (pane)
  (:documentation "Return a text for the status strip on the keys that PANE takes.")
  (:method ((pane display-pane))
    "Arrows up and down scroll, left folds; > and < choose; M opens a menu; Tab goes on.")
  (:method ((pane world-pane))
    "Arrows move the view; > and < choose a thing or robot; M opens a menu; Tab goes on.")
  (:method ((pane title-pane)) "Arrow right unfolds this display; Tab goes on.")
  (:method ((pane splitter-pane)) "Arrows move this bar; Tab goes on.")
  (:method ((pane interactor-pane)) ""))

(defun give-keys-to (pane)
  "Send keys to PANE from now on, and say in the status strip what they do."
  (let ((window (window-of pane)))
    (setf (window-typing-p window) nil)
    (close-popup window)
    (focus-on pane)
    (show-hint window (keys-hint pane))
    (refresh window)))

(defun move-keys (window step)
  "Give the keys to the pane that is STEP places after the one that has them, among those for Tab."
  (let* ((panes (panes-for-keys window))
         (place (or (position (window-focus window) panes) (1- (length panes)))))
    (give-keys-to (nth (mod (+ place step) (length panes)) panes))))

;;; Escape.

(defun clear-selection (window)
  "Select nothing in WINDOW. Return true if something was selected."
  (when (window-selection window)
    (select-subject window nil)
    t))

(defun close-by-escape (window)
  "Close the popup of WINDOW. Without one, clear the selection, or close the panel of parameters.
Return true if something was closed or cleared."
  (or (close-popup window)
      (clear-selection window)
      (unless (section-folded-p window 'parameters)
        (fold-section window 'parameters)
        t)))

;;; Arrows.

(defgeneric handle-arrow (pane dx dy)
  (:documentation "Handle an arrow key that asks PANE to move by DX, DY pixels.")
  (:method ((pane display-pane) dx dy)
    (cond ((minusp dx) (fold-by-key pane t))
          ((/= dy 0) (scroll-pane pane (* (signum dy) +scroll-step+)))))
  (:method ((pane world-pane) dx dy) (move-view pane dx dy))
  (:method ((pane title-pane) dx dy)
    (declare (ignore dy))
    (when (plusp dx) (fold-by-key pane nil)))
  (:method ((pane splitter-pane) dx dy) (handle-drag pane (round dx 4) (round dy 4))))

(defun section-of-pane (pane)
  (if (typep pane 'title-pane) (pane-section pane) (clim:pane-name pane)))

(defun fold-by-key (pane folded-p)
  "Fold the display of PANE, or unfold it. It keeps the keys."
  (let ((window (window-of pane)) (section (section-of-pane pane)))
    (fold-section window section folded-p)
    (give-keys-to (section-pane window section))))

(defgeneric handle-page-key (pane direction)
  (:documentation "Scroll PANE by a page: down if DIRECTION is 1, up if it is -1.")
  (:method ((pane display-pane) direction)
    (scroll-pane pane (* direction (max +scroll-step+
                                        (- (nth-value 1 (pane-size pane)) +scroll-step+)))))
  (:method ((pane world-pane) direction)
    (zoom-window (window-of pane) (if (plusp direction) 1/2 2))))

;;; Objects.

(defgeneric choice-rank (pane left top right bottom)
  (:documentation "Return a number: the place, among others, of the object that PANE shows in the
box LEFT ... BOTTOM. Keys choose objects in the order of these numbers.")
  ;; By rows.
  (:method ((pane display-pane) left top right bottom)
    (declare (ignore right bottom))
    (+ left (* 10000 (round top 8))))
  ;; By the distance from the robot.
  (:method ((pane world-pane) left top right bottom)
    (multiple-value-bind (x y) (robot-position-in-pane pane)
      (if x
          (+ (expt (- (/ (+ left right) 2) x) 2) (expt (- (/ (+ top bottom) 2) y) 2))
          0))))

(defun box-key (box) (choice-key (first box)))

(defun subjects-in-order (pane)
  "Return lists (subject left top right bottom), one for each object of PANE, in the order of keys."
  (stable-sort (remove-duplicates (remove nil (pane-subjects pane) :key #'box-key)
                                  :key #'box-key :test #'equal)
               #'< :key (lambda (box) (apply #'choice-rank pane (rest box)))))

(defun chosen-box (pane)
  "Return the list (subject left top right bottom) of the object chosen in PANE by keys, or NIL."
  (and (pane-chosen pane)
       (find (pane-chosen pane) (pane-subjects pane) :key #'box-key :test #'equal)))

(defun selected-box (pane)
  "Return the list (subject left top right bottom) of the selected object if PANE shows it."
  (find-if (lambda (box)
             (let ((key (subject-key (first box))))
               (and key (equal key (window-selection (window-of pane))))))
           (pane-subjects pane)))

(defgeneric bring-into-view (pane left top right bottom)
  (:documentation "Scroll PANE, if necessary, so that the box LEFT ... BOTTOM is in view.")
  (:method ((pane display-pane) left top right bottom)
    (declare (ignore left right))
    (let ((height (nth-value 1 (pane-size pane))))
      (cond ((minusp top) (scroll-pane pane (floor (- top 4))))
            ((> bottom height) (scroll-pane pane (ceiling (- (+ bottom 4) height)))))))
  (:method ((pane world-pane) left top right bottom)
    (let ((x (round (+ left right) 2)) (y (round (+ top bottom) 2)))
      (unless (in-view-p pane x y)
        (multiple-value-bind (width height) (pane-size pane)
          (move-view pane (- x (floor width 2)) (- y (floor height 2))))))))

(defun choose-further-subject (pane step)
  "Choose the object that is STEP places after the chosen one in PANE, and describe it."
  (let* ((boxes (subjects-in-order pane))
         (before (or (chosen-box pane) (selected-box pane)))
         (place (and before
                     (position (box-key before) boxes :key #'box-key :test #'equal)))
         (box (and boxes
                   (nth (mod (if place (+ place step) (min 0 step)) (length boxes)) boxes))))
    (if box
        (choose-subject pane (first box) (rest box))
        (show-hint (window-of pane) "There is nothing to choose in this display."))))

(defun choose-subject (pane subject box)
  (let ((window (window-of pane)))
    (setf (pane-chosen pane) (choice-key subject))
    (apply #'bring-into-view pane box)
    (when (subject-key subject) (select-subject window subject))
    (repaint-if-changed pane)
    (show-hint window (subject-description subject))))

;;; What a click does with the chosen object.

(defgeneric subjects-for-menu (pane subject x y)
  (:documentation "Return SUBJECT, chosen by keys, and the other objects that PANE shows at X, Y.")
  (:method ((pane display-pane) subject x y)
    (cons subject (remove subject (subjects-under pane x y) :test #'same-subject-p)))
  (:method ((pane plan-pane) subject x y)
    (let ((tick (tick-at-mouse pane x y)))
      (list (if tick (make-timeline-point tick subject) subject)))))

(defun open-menu-of-box (pane subject left top right bottom)
  "Open the context menu of SUBJECT, which PANE shows in the box LEFT ... BOTTOM, for keys."
  (open-offers-at pane (subjects-for-menu pane subject (round (+ left right) 2)
                                          (round (+ top bottom) 2))
                  (round left) (round bottom))
  (highlight-further-row (window-popup (window-of pane)) 1))

(defun open-menu-by-key (pane)
  "Open the context menu of the object that is chosen or selected in PANE. Press a chosen button."
  (let ((box (or (chosen-box pane) (selected-box pane))))
    (cond ((null box)
           (show-hint (window-of pane)
                      "Nothing is chosen here. The keys > and < choose an object."))
          ((typep (first box) '(or button fold-mark)) (click-chosen pane))
          (t (apply #'open-menu-of-box pane box)))))

(defun click-chosen (pane)
  "Do what a click on the object chosen in PANE does. Return true if an object is chosen."
  (let ((box (chosen-box pane)))
    (when box
      (destructuring-bind (subject left top right bottom) box
        (if (typep subject '(or button fold-mark))
            (handle-click pane :left (round (+ left right) 2) (round (+ top bottom) 2))
            (select-and-describe (window-of pane) subject)))
      t)))

(defun pane-for-keys (window)
  "Return the pane of WINDOW to which the keys of displays apply."
  (let ((focus (window-focus window)))
    (if (and focus
             (member focus (panes-for-keys window))
             (not (typep focus 'interactor-pane)))
        focus
        (pane-named window 'world))))

(defun handle-choice-key (window name character)
  "Handle the key NAME, with CHARACTER or NIL, if it chooses in a display of WINDOW. Return true if
it has an effect."
  (let ((pane (pane-for-keys window)))
    (flet ((done (&rest results) (declare (ignore results)) t))
      (case name
        (:tab (done (move-keys window 1)))
        (:iso-left-tab (done (move-keys window -1)))
        (:prior (done (handle-page-key pane -1)))
        (:next (done (handle-page-key pane 1)))
        (:menu (done (open-menu-by-key pane)))
        ((:return :kp-enter) (and (not (popup-open-p window)) (click-chosen pane)))
        (t (case character
             (#\> (done (choose-further-subject pane 1)))
             (#\< (done (choose-further-subject pane -1)))
             (#\M (done (open-menu-by-key pane)))))))))
