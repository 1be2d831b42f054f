;;;; menus.lisp -- the bar of menus at the top of the window, and keys in a menu.

(in-package :ars-magna.clim)

;;; A menu is shown by the window's popup, so it stays inside the window, scrolls if it is too high,
;;; and blocks nothing. A submenu replaces its menu.

;;; The menus have the lines of the prompt, by the families of HELP.

;;; A line without arguments runs at once; another is put where the user can type its arguments.

(defparameter *lines-run-at-once* '("STATUS")
  "The names of prompt lines that menus run at once, without their optional arguments.")

(defparameter *prompt-menu-titles*
  '((:moving "Moving") (:camera "Cameras") (:hand "Hands") (:storage-bin "Storage bins")
    (:manipulating "Manipulating") (:seeing "Seeing") (:planning "Plans") (:running "Running")
    (:general "Prompt"))
  "Lists (family title), in the order of menus: the menu title for each family of prompt lines.")

(defun prompt-menu-title (line)
  "Return the title of the menu with the prompt line LINE: Prompt if its family has no menu."
  (second (or (assoc (ars-magna.cli:line-family line) *prompt-menu-titles*)
              (assoc :general *prompt-menu-titles*))))

(defun prompt-line-items (group)
  (loop for line in (sort (copy-list (ars-magna.cli:all-line-commands)) #'string<
                          :key #'ars-magna.cli:line-name)
        when (string= group (prompt-menu-title line))
          collect (let ((name (ars-magna.cli:line-name line)))
                    (list name (lambda () (choose-prompt-line clim:*application-frame* name))))))

(defun choose-prompt-line (window name)
  "Run the prompt line NAME if it needs no arguments, else put it in the input line for arguments."
  (let ((conversation (window-conversation window)) (text (string-downcase name)))
    (cond ((and (ars-magna.cli:line-parameters (ars-magna.cli:find-line-command name))
                (not (member name *lines-run-at-once* :test #'string=)))
           (replace-input-line conversation (format nil "~A " text))
           (focus-and-repaint (pane-named window 'interactor)))
          (t (run-line-at-prompt conversation text)))))

;;; Menus.

(defstruct (menu (:constructor make-menu (title items)) (:copier nil))
  "A menu with TITLE. ITEMS is a list, or a function that returns a list. Its elements are lists
(title command), menus, and NIL for a gap. The title of an element may be a function of the window
that returns the title."
  (title "" :type string :read-only t)
  (items '() :type (or list function) :read-only t))

(defmethod subject-title ((menu menu)) (format nil "Menu ~A" (menu-title menu)))

(defun prompt-line-menus ()
  (loop for (nil group) in *prompt-menu-titles*
        for items = (prompt-line-items group)
        when items collect (make-menu group items)))

(defun robot-menu-items ()
  (append (prompt-line-menus) '(nil ("Parameters ..." com-parameters))))

(defparameter *menus*
  (list (make-menu "Run" '(("Pause" com-pause) ("Resume" com-resume) ("Step" com-step)
                           ("Back" com-back)
                           nil
                           ("Half as fast" com-slower) ("Twice as fast" com-faster)
                           ("Default rate" com-default-rate) ("As fast as possible" com-free)
                           nil
                           ("Interrupt" com-interrupt)))
        (make-menu "Edit" '(("Copy" com-copy) ("Paste" com-paste)))
        (make-menu "View" '(("Zoom in" com-zoom-in) ("Zoom out" com-zoom-out)
                            ("Whole map" com-fit) ("Go to the robot" com-find)
                            nil
                            ("Which robot ..." com-robots) ("Follow the robot" com-follow)
                            ("Names of all things" com-names) ("Layers ..." com-layers)
                            ("Plots ..." com-plots)
                            ("Colours on or off" com-color)
                            nil
                            ("All larger" com-larger) ("All smaller" com-smaller)))
        (make-menu "Robot" #'robot-menu-items)
        (make-menu "Window" '(("Save as SVG" com-save-svg) ("Save as PNG" com-save-png)
                              (recording-title com-record)
                              nil
                              ("Keys and mouse" com-help) ("Close window" com-close))))
  "The menus of the menu bar, from left to right.")

(defun current-menu-items (menu)
  (let ((items (menu-items menu)))
    (if (functionp items) (funcall items) items)))

;;; As rows of the popup.

(defun item-row (window item menu x y)
  (cond ((null item) (make-row ""))
        ((menu-p item)
         (make-row (format nil "~A >" (menu-title item))
                   :action (lambda () (open-menu window item x y menu))))
        (t (destructuring-bind (title command) item
             (make-row (if (stringp title) title (funcall title window))
                       :action (lambda () (funcall command)))))))

(defun open-menu (window menu x y &optional outer)
  "Show MENU at X, Y of WINDOW. OUTER is the menu that contains MENU, or NIL."
  (let ((rows (loop for item in (current-menu-items menu)
                    collect (item-row window item menu x y))))
    (when outer
      (push (make-row (format nil "< ~A" (menu-title outer))
                      :action (lambda () (open-menu window outer x y)))
            rows))
    (open-popup window rows x y (or outer menu))))

;;; The bar.

(defclass menu-pane (display-pane) ()
  (:default-initargs :background (clim-ink +menu-bar-color+))
  (:documentation "The menu bar."))

(defmethod pane-appearance ((pane menu-pane))
  (list (multiple-value-list (pane-size pane)) (popup-opener (window-of pane))))

(defun draw-menu-title (canvas menu x open-p)
  "Draw the title of MENU from X on, highlighted if OPEN-P. Return the x coordinate of its end."
  (let ((width (+ 16 (label-width (menu-title menu)))))
    (with-subject (canvas menu)
      (with-gcontext (draw-gcontext* :foreground (if open-p +lit-color+ +menu-bar-color+))
        (draw-rectangle canvas draw-gcontext* x 0 width +menus-height+ t))
      (draw-label canvas (+ x 8) 14 (menu-title menu)))
    (+ x width)))

(defmethod paint ((pane menu-pane))
  (with-pane-canvas (canvas pane)
    (loop with x = 0
          with opener = (popup-opener (window-of pane))
          for menu in *menus*
          do (setf x (draw-menu-title canvas menu x (eq menu opener))))))

(defun menu-left-edge (pane menu)
  (second (assoc menu (pane-subjects pane))))

(defun open-bar-menu (pane menu)
  (open-menu (window-of pane) menu (floor (menu-left-edge pane menu)) +menus-height+)
  (repaint-if-changed pane))

(defun menu-at (pane x y) (subject-at (pane-subjects pane) x y))

(defmethod handle-click ((pane menu-pane) button x y)
  (declare (ignore button))
  (let ((menu (menu-at pane x y)))
    (when menu (open-bar-menu pane menu))))

(defmethod handle-press-after-popup ((pane menu-pane) button x y opener)
  (unless (eq opener (menu-at pane x y)) (handle-click pane button x y)))

;;; Keys in the menu or list on top of the window, and the key that opens it.

;;; They work whatever has the focus, because the list is on top.

(defun scroll-to-row (popup row)
  (let* ((top (* +row-height+ (position row (pane-rows popup))))
         (height (nth-value 1 (pane-size popup)))
         (offset (pane-offset popup)))
    (scroll-to popup (clamp offset (- (+ top 6 +row-height+) height) top))))

(defun highlight-further-row (popup step)
  "Highlight the row that is STEP rows after the highlighted row of POPUP. Without a highlight,
highlight the first row, or the last if STEP is negative. Return true if POPUP has rows to choose."
  (let* ((rows (remove nil (pane-rows popup) :key #'row-action))
         (place (position (pane-pointed popup) rows))
         (row (nth (cond (place (mod (+ place step) (length rows)))
                         ((plusp step) 0)
                         (t (max 0 (1- (length rows)))))
                   rows)))
    (when row
      (setf (pane-pointed popup) row)
      (scroll-to-row popup row)
      t)))

(defun open-neighbouring-menu (window step)
  "If a menu of WINDOW's menu bar is open, open the menu STEP places to its right and return true."
  (let ((place (position (popup-opener window) *menus*)))
    (when place
      (open-bar-menu (pane-named window 'menus)
                     (nth (mod (+ place step) (length *menus*)) *menus*))
      t)))

(defun choose-highlighted-row (popup)
  (let ((row (pane-pointed popup)))
    (when (and row (row-action row))
      (choose-row popup row)
      t)))

(defun scroll-by-key (popup pixels)
  (scroll-pane popup pixels)
  t)

(defun handle-key-in-popup (window name)
  "Handle the key called NAME in the popup of WINDOW. Return true if the key has an effect."
  (let ((popup (window-popup window)))
    (when (popup-open-p window)
      (case name
        (:down (or (highlight-further-row popup 1) (scroll-by-key popup +scroll-step+)))
        (:up (or (highlight-further-row popup -1) (scroll-by-key popup (- +scroll-step+))))
        (:right (open-neighbouring-menu window 1))
        (:left (open-neighbouring-menu window -1))
        ((:return :kp-enter) (choose-highlighted-row popup))))))

(defun toggle-first-menu (window)
  "Open the first menu of the menu bar of WINDOW. If a menu is open, close it instead."
  (unless (menu-p (close-popup window))
    (open-bar-menu (pane-named window 'menus) (first *menus*))
    (highlight-further-row (window-popup window) 1)))
