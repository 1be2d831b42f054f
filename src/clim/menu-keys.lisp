;;;; menu-keys.lisp -- keys in the menu or list that is on top of the window, and one that opens it.

(in-package :ars-magna.clim)

;;; They work wherever the keys go just then: the list is nearer than a line that is typed below it.

(defun show-row (popup row)
  "Scroll POPUP so that ROW is in view."
  (let* ((top (* +row-height+ (position row (pane-rows popup))))
         (height (nth-value 1 (pane-size popup)))
         (offset (pane-offset popup)))
    (scroll-to popup (clamp offset (- (+ top 6 +row-height+) height) top))))

(defun point-further (popup step)
  "Let the row of POPUP be pointed at that is STEP further than the one which is, or the first or
last. True if there is one."
  (let* ((rows (remove nil (pane-rows popup) :key #'row-action))
         (place (position (pane-pointed popup) rows))
         (row (nth (cond (place (mod (+ place step) (length rows)))
                         ((plusp step) 0)
                         (t (max 0 (1- (length rows)))))
                   rows)))
    (when row
      (setf (pane-pointed popup) row)
      (show-row popup row)
      t)))

(defun turn-menu (window step)
  "If a menu of the bar is open in WINDOW, open the one STEP further there. True if so."
  (let ((place (position (open-opener window) *menus*)))
    (when place
      (open-menu-of-bar (pane-named window 'menus)
                        (nth (mod (+ place step) (length *menus*)) *menus*))
      t)))

(defun choose-pointed (popup)
  "Do what the row says that is pointed at in POPUP. True if there is one."
  (let ((row (pane-pointed popup)))
    (when (and row (row-action row))
      (choose-row popup row)
      t)))

(defun press-in-popup (window name)
  "Do what the key called NAME does in the menu or list on top of WINDOW. True if anything."
  (let ((popup (window-popup window)))
    (when (popup-open-p window)
      (case name
        (:down (point-further popup 1))
        (:up (point-further popup -1))
        (:right (turn-menu window 1))
        (:left (turn-menu window -1))
        ((:return :kp-enter) (choose-pointed popup))))))

(defun open-first-menu (window)
  "Open the first menu of the bar of WINDOW, or close the one that is open."
  (unless (menu-p (close-popup window))
    (open-menu-of-bar (pane-named window 'menus) (first *menus*))
    (point-further (window-popup window) 1)))
