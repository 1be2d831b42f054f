;;;; clim-view.lisp -- which part of the world is in view in a window, and how large.

(in-package :ars-magna.tests)

(in-suite clim)

(test view.fits-on-opening-and-when-the-size-changes
  (in-window (window robot)
    (let ((pane (pane window 'window::world)))
      (flet ((filled-p ()
               (multiple-value-bind (width height) (window::pane-size pane)
                 (destructuring-bind (left top bottom) (window::pane-margins pane)
                   (decf width left)
                   (decf height (+ top bottom)))
                 (let ((scale (window::pane-scale pane)))
                   (and (<= (* 20 scale) width) (<= (* 10 scale) height)
                        (or (> (* 20 (1+ scale)) width) (> (* 10 (1+ scale)) height)
                            (= scale 64)))))))
        (loop for (width height) in *window-sizes*
              do (lay-out window width height)
                 (is (filled-p)))
        (window::zoom-view pane 2)
        (let ((scale (window::pane-scale pane)))
          (lay-out window 800 600)
          (is (= scale (window::pane-scale pane))))
        (window::fit-whole-map pane)
        (is (filled-p))))))

(test view.fits-maps-that-have-more-cells-than-the-pane-has-pixels
  (loop for (width height) in '((300 200) (1200 900) (100 2000))
        do (let ((scale (window::fitting-scale (world::%make-map :name 'big :width width
                                                                 :height height :clauses '())
                                               290 170)))
             (is (plusp scale))
             (is (<= (* scale width) 290))
             (is (<= (* scale height) 170)))))

(test walls.are-a-pixel-wide-at-least
  "In a small picture of a big map, too."
  (let ((canvas:graphics-scale* 1/4))
    (is (= 1 (display::wall-width-in-pixels 0 1)))
    (is (= 10 (display::wall-width-in-pixels 0 40)))))

(test view.leaves-room-for-what-stands-at-its-edges
  "Numbers and scale bar cover nothing of a map that is in view as a whole."
  (in-window (window robot)
    (let ((pane (pane window 'window::world)))
      (loop for (width height) in *window-sizes*
            do (lay-out window width height)
               (let ((bottom (- (* 10 (window::pane-scale pane)) (window::pane-top pane)))
                     (room (nth-value 1 (window::pane-size pane))))
                 (destructuring-bind (left top low) (window::pane-margins pane)
                   (is (every #'plusp (list left top low)))
                   (is (<= (window::pane-left pane) (- left)))
                   (is (<= (window::pane-top pane) (- top)))
                   (is (<= bottom (- room low))))))
      (setf (window::preferences-layers (window::window-preferences window)) '())
      (is (equal '(0 0 0) (window::pane-margins pane))))))

(test view.has-nothing-below-its-numbers
  "However the map is dragged: what lies under a strip is neither told of, nor picked, nor marked."
  (in-window (window robot)
    (lay-out window 640 480)
    (let ((pane (pane window 'window::world)))
      (window::zoom-view pane 4)
      (window::set-view-corner pane 30 30)
      (destructuring-bind (left top right bottom) (window::view-box pane)
        (flet ((cells (x y) (length (remove-if-not #'world:cell-p
                                                   (window::subjects-under pane x y)))))
          (is (= 1 (cells left top)))
          (is (= 1 (cells (1- right) (1- bottom))))
          (is (= 0 (cells (1- left) top) (cells left (1- top)) (cells left bottom)))
          (is (string= "" (window::hover-text pane (1- left) top))))))))

(test view.follows-the-robot-if-asked
  (in-window (window robot)
    (lay-out window 640 480)
    (let ((pane (pane window 'window::world)))
      (window::zoom-view pane 4)
      (window::com-follow)
      (robot:place-robot robot 17.5 8.5 0)
      (window::publish-snapshot (window::window-watcher window) (time:current-simulation))
      (window::refresh window)
      (is (not (window::robot-off-centre-p pane)))
      (window::com-follow)
      (robot:place-robot robot 2.5 2.5 0)
      (window::publish-snapshot (window::window-watcher window) (time:current-simulation))
      (window::refresh window)
      (is (window::robot-off-centre-p pane)))))

(test view.shows-the-scale-that-the-user-sets
  (in-window (window robot)
    (lay-out window 800 600)
    (let ((canvas:graphics-scale* 11))
      (window::refresh window)
      (is (= 11 (window::pane-scale (pane window 'window::world)))))))

(test view.outlives-a-scale-that-is-none
  (in-window (window robot)
    (lay-out window 800 600)
    (window::refresh window)
    (let ((before (window::pane-scale (pane window 'window::world))))
      (dolist (canvas:graphics-scale* '(0 -3 "x" nil 1000))
        (window::refresh window)
        (is (= before (window::pane-scale (pane window 'window::world))))))))

(test canvas.outlines-of-arcs-stay-in-their-box
  "Manual B.1: a circle inscribed in a cell has all of its pixels there."
  (is (equal '(8 8 7 7) (multiple-value-list (window::box-for-outline 8 8 8 8 1))))
  (is (equal '(9 9 5 5) (multiple-value-list (window::box-for-outline 8 8 8 8 3)))))

(test canvas.has-the-dashes-that-are-asked-for
  (flet ((dashes-of (magnification &rest options)
           (let ((canvas (make-instance 'window::clim-canvas :medium nil
                                                            :magnification magnification)))
             (apply #'canvas::call-with-gcontext
                    (lambda () (window::clim-line-dashes canvas canvas:draw-gcontext*))
                    canvas:draw-gcontext* options))))
    (is (null (dashes-of 1 :line-style :solid :dashes '(3 1))))
    (is (equal '(5 5) (dashes-of 1 :line-style :dash :dashes 5)))
    (is (equal '(7 2) (dashes-of 1 :line-style :dash :dashes '(7 2))))
    (is (equal '(21 6) (dashes-of 3 :line-style :dash :dashes '(7 2))))))
