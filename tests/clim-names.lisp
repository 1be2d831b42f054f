;;;; clim-names.lisp -- names and layers in the window, and when its next picture is due.

(in-package :ars-magna.tests)

(in-suite clim)

(defun names-in-window (window)
  "Return the texts of the names above robots and things in the next picture of WINDOW."
  (let ((pane (pane window 'window::world)) (names '()))
    (host:wrap-function 'display::draw-placed-name
                        (lambda (draw canvas name)
                          (push (display::label-target-name (display::placed-name-target name))
                                names)
                          (funcall draw canvas name))
                        'test)
    (unwind-protect (window::repaint pane)
      (host:unwrap-function 'display::draw-placed-name 'test))
    names))

(test window.the-key-n-shows-or-hides-the-names-of-things
  (in-window (window robot)
    (painted-world window)
    (flet ((press-n () (window::handle-key window nil #\N)))
      (is (equal '("studio-robot") (names-in-window window)))
      (press-n)
      (is (= 3 (length (names-in-window window))))
      (press-n)
      (is (equal '("studio-robot") (names-in-window window))))))

(test window.has-at-first-the-layers-of-window-layers
  (let ((display:*window-layers* '(:grid)))
    (in-window (window robot)
      (is (equal '(:grid) (window::window-layers window)))))
  (let ((display:*window-layers* '(:aura)))
    (in-studio (robot)
      (signals base:wrong-argument (window::open-new-window robot)))))

(test pointing.writes-the-name-of-what-is-under-the-mouse
  (in-window (window robot)
    (let ((pane (painted-world window)))
      (setf (window::preferences-layers (window::window-preferences window)) '())
      (window::handle-hover pane 44 36)
      (is (equal '("pen") (names-in-window window)))
      (window::handle-hover pane 120 20)
      (is (null (names-in-window window)))
      (window::handle-hover pane 44 36)
      (window::clear-description window)
      (is (null (names-in-window window)) "the mouse has left"))))

(test pointing.paints-at-once
  (in-window (window robot)
    (let ((pane (painted-world window)))
      (flet ((painted-p (x y)
               (let ((before (window::pane-painted pane)))
                 (window::handle-hover pane x y)
                 (not (eq before (window::pane-painted pane))))))
        (is-true (painted-p 44 36))
        (is (not (painted-p 45 36)))
        (is-true (painted-p 120 20))))))

(test watcher.pictures-are-due-a-thirtieth-of-a-second-after-the-last-one-began
  (flet ((due (due painted) (float (window::time-of-next-picture due painted) 1d0)))
    (is (< (abs (- 10.0333d0 (due 10 10.005d0))) 0.001))
    (is (< 10.1d0 (due 10 10.1d0) 10.11d0) "a slow picture leaves time for others")))
