;;;; clim-robots.lisp -- several robots in a window: their names, and robots that others have seen.

(in-package :ars-magna.tests)

(in-suite clim)

(test window.tells-robots-of-one-name-apart
  "In its titles, in the menu of robots, and in the line that this menu runs."
  (in-twin-shed (one two loner)
    (call-with-window
     (lambda (window)
       (publish-and-refresh window)
       (is (string= "ARS MAGNA: TWINS-B::TWIN" (clim:frame-pretty-name window)))
       (is (mentions-p (window::title-now window) "TWINS-B::TWIN"))
       (is (mentions-p (window::world-title window) "TWINS-B::TWIN of 3 robots"))
       (let ((rows (window::robot-rows window)))
         (is (equal '("Which robot?" "TWINS-A::TWIN" "TWINS-B::TWIN" "LONER")
                    (mapcar #'window::row-text rows)))
         (is (equal '(nil t nil)
                    (loop for row in (rest rows)
                          collect (and (funcall (window::row-tick row)) t)))))
       (is (member "robot twins-a::twin"
                   (lines-offered window (first (display:snapshot-robots
                                                 (window::window-snapshot window))))
                   :test #'string=)))
     two)))

(test window.offers-for-a-robot-that-was-seen-what-it-offers-for-a-robot
  "Wherever it is clicked: on the map, or in the display of designators."
  (in-twin-shed (one two loner)
    (robot:add-designator one :denotation (robot:robot-body loner))
    (call-with-window
     (lambda (window)
       (publish-and-refresh window)
       (let* ((robot (third (display:snapshot-robots (window::window-snapshot window))))
              (seen (display:designator-image-denotation
                     (first (display:robot-image-designators (window::window-robot window)))))
              (lines (lines-offered window robot)))
         (is-true (window::same-subject-p robot seen))
         (is (equal lines (lines-offered window seen)))
         (is (subsetp '("robot loner" "obj-desig 0 non-local ()" "cam-track 0 0") lines
                      :test #'string=))
         (is (notany (lambda (line) (search "hand-grasp" line)) lines))
         (is (mentions-p (window::subject-description seen) "LONER at 9.50, 3.50"))))
     one)))
