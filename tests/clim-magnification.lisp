;;;; clim-magnification.lisp -- a window on a screen with high resolution.

(in-package :ars-magna.tests)

(in-suite clim)

(defun sizes-of-panes (window)
  "Return width and height of each pane of WINDOW that is to be seen."
  (loop for pane in (window::display-panes window)
        when (window::pane-shown-p pane) collect (multiple-value-list (window::pane-size pane))))

(test magnification.follows-what-programs-are-told-of-the-screen
  (flet ((magnification (resources)
           (window::usual-magnification (window::resolution-in-resources resources))))
    (is (= 1 (magnification "")))
    (is (= 1 (magnification (format nil "Xft.antialias: 1~%Xft.dpi: 96~%"))))
    (is (= 2 (magnification (format nil "*color: red~%Xft.dpi:~C192" #\Tab))))
    (is (= 3 (magnification "Xft.dpi: 288")))
    (is (= 1 (magnification "Xft.dpi: fine")))
    (is (= 1 (magnification "Xft.dpi: 0")))
    (is (= 6 (magnification "Xft.dpi: 100000")))))

(test magnification.of-a-window-follows-the-x-resources-of-its-screen
  (loop for (resources screen magnification) in '(("Xft.dpi: 192" "1300x960x24" 2)
                                                  ("Xft.dpi: 192.5" "2560x1440x24" 2)
                                                  ("Xft.dpi: none" "1300x960x24" 1)
                                                  ("no resource" "1300x960x24" 1)
                                                  ("" "640x480x24" 1))
        do (let ((*x-resources* resources) (*x-screen* screen))
             (in-x-window (window robot)
               (is (= magnification (window::window-usual-magnification window))
                   "~A on ~A" resources screen)))))

(test opening.says-what-an-x-server-lacks
  (loop for (screen options . words) in '(("1300x900x8" () "8 bits per pixel" "24")
                                          ("1300x900x24" ("-extension" "RENDER") "lacks" "RENDER"))
        do (let ((*x-screen* screen) (*x-options* options))
             (with-x-server ()
               (in-studio (robot)
                 (handler-case (progn (window::open-window robot) (fail "~A" screen))
                   (base:misuse (condition)
                     (is-true (apply #'has-words-p (princ-to-string condition)
                                     "No window: the X server" words)))))))))

(test magnification.leaves-room-on-the-screen-for-all
  (is (= 2 (window::usual-magnification 192 1920 1080)))
  (is (= 1 (window::usual-magnification 192 1280 900)))
  (is (= 3 (window::usual-magnification 480 2560 1600)))
  (is (= 1 (window::usual-magnification 480 320 200))))

(test magnification.leaves-all-where-it-is
  "A screen twice as fine is divided as one of half as many pixels."
  (in-window (window robot)
    (lay-out window 700 500)
    (let ((sizes (sizes-of-panes window)))
      (lay-out window 1400 1000)
      (is (not (equal sizes (sizes-of-panes window))))
      (window::set-magnification window 2)
      (is (equal sizes (sizes-of-panes window))))))

(test magnification.can-be-chosen-in-a-menu
  (in-window (window robot)
    (lay-out window 800 600)
    (let ((clim:*application-frame* window))
      (window::com-larger)
      (is (= 2 (window::window-magnification window)))
      (window::com-smaller)
      (window::com-smaller)
      (is (= 1 (window::window-magnification window)))
      (window::com-smaller)
      (is (mentions-p (said-in window) "The window is at its smallest size"))
      (dotimes (times 10) (window::com-larger))
      (is (<= (window::window-magnification window) window::+greatest-magnification+))
      (is (mentions-p (said-in window) "The window is at its largest size")))))

(test magnification.points-where-the-mouse-is
  "A click on the screen picks what is drawn there, a drag of a splitter follows."
  (in-window (window robot)
    (window::set-magnification window 3)
    (lay-out window 2400 1800)
    (let* ((pane (pane window 'window::world)) (splitter (pane window 'window::side-splitter))
           (width (window::pane-size pane)))
      (multiple-value-bind (x y) (window::robot-position-in-pane pane)
        (is (mentions-p (window::hover-text pane (floor x) (floor y)) "STUDIO-ROBOT"))
        (multiple-value-bind (at-x at-y)
            (window::event-position pane (motion-event pane (* 3 (floor x)) (* 3 (floor y))))
          (is (= (floor x) at-x))
          (is (= (floor y) at-y))))
      (window::handle-press splitter :left 1 1)
      (clim:handle-event splitter (motion-event splitter -300 0))
      (is (= (- width 100) (window::pane-size pane))))))

(defun motion-event (pane x y)
  "Return the event that the mouse has moved to X, Y of PANE, in pixels of the screen."
  (multiple-value-bind (x y) (clim:transform-position (clim:sheet-transformation pane) x y)
    (make-instance 'clim:pointer-motion-event :sheet pane :x x :y y :modifier-state 0)))

(test magnification.is-kept-for-the-next-window
  (in-window (window robot)
    (window::set-magnification window 2)
    (let ((window::*last-preferences* nil) (window::*window-states* '()))
      (window::save-settings window)
      (call-with-window
       (lambda (next)
         (is (= 1 (window::window-magnification next)))
         (window::restore-settings next)
         (is (= 2 (window::window-magnification next))))
       robot))))
