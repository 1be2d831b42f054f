;;;; clim-holding.lisp -- what the window shows and offers about things that a robot holds.

(in-package :ars-magna.tests)

(in-suite clim)

(defun hold-pen (window robot holder)
  "Let HOLDER, a part of ROBOT, hold the pen, as WINDOW shows then; return the image of it."
  (let ((pen (world:find-thing "PEN#2")))
    (world:move-thing pen holder)
    (robot:add-designator robot :x 2 :y 2)
    (publish-and-refresh window)
    (if (typep holder 'robot:hand)
        (display:hand-image-contents
         (first (display:robot-image-hands (window::window-robot window))))
        (first (display:bin-image-contents
                (first (display:robot-image-bins (window::window-robot window))))))))

(defun lines-offered (window image)
  (mapcar #'second (window::offers image window)))

(test holding.what-is-held-is-told-of-where-it-is
  "In a hand or a bin, and not where it was picked up."
  (in-window (window robot)
    (is (mentions-p (window::subject-description (hold-pen window robot (robot:robot-hand robot 0)))
                    "PEN#2 in hand 0 of STUDIO-ROBOT"))
    (is (mentions-p (with-output-to-string (*standard-output*)
                      (describe (world:find-thing "PEN#2")))
                    "Where: in hand 0 of STUDIO-ROBOT"))
    (is (mentions-p (window::subject-description
                     (hold-pen window robot (robot:robot-storage-bin robot 0)))
                    "PEN#2 in storage-bin 0 of STUDIO-ROBOT"))
    (world:move-thing (world:find-thing "PEN#2") (world:find-thing "BOX#1"))
    (is (mentions-p (window::subject-description
                     (display::image-of-thing (world:find-thing "PEN#2")))
                    "PEN#2 in BOX#1"))))

(test holding.what-is-held-can-be-let-go-of-and-stowed
  (in-window (window robot)
    (let ((lines (lines-offered window (hold-pen window robot (robot:robot-hand robot 0)))))
      (is (member "hand-ungrasp 0" lines :test #'equal))
      (is (member "hand-insert-bin 0 0" lines :test #'equal))
      (is (notany (lambda (line) (search "hand-grasp 0" line)) lines)))
    (let ((lines (lines-offered window (hold-pen window robot
                                                 (robot:robot-storage-bin robot 0)))))
      (is (member "hand-insert-bin 0 0" lines :test #'equal))
      (is (member "bin-close 0" lines :test #'equal)))))

(test holding.what-a-camera-tracks-is-not-offered-to-it-again
  (in-window (window robot)
    (let ((pen (world:find-thing "PEN#2")))
      (world:move-thing pen (robot:robot-hand robot 0))
      (let ((designator (robot:add-designator robot :denotation pen)))
        (setf (robot::camera-tracking (robot:robot-camera robot 0))
              (robot::make-track designator nil))
        (publish-and-refresh window)
        (let ((lines (lines-offered window
                                    (display:hand-image-contents
                                     (first (display:robot-image-hands
                                             (window::window-robot window)))))))
          (is (member "cam-untrack 0" lines :test #'equal))
          (is (notany (lambda (line) (search "cam-track 0" line)) lines))
          (is (notany (lambda (line) (search "hand-grasp" line)) lines)))))))

(test holding.dragging-it-out-of-its-display-says-why-nothing-comes-of-that
  (in-window (window robot)
    (lay-out window 1180 900)
    (hold-pen window robot (robot:robot-hand robot 0))
    (let* ((pane (pane window 'window::hands))
           (box (rest (find-if (lambda (entry) (typep (first entry) 'display:thing-image))
                               (window::pane-subjects pane))))
           (x (1+ (first box))) (y (1+ (second box))))
      (window::handle-press pane :left x y)
      (window::handle-drag pane (+ x 40) y)
      (is (mentions-p (window::window-hint window) "To let go of PEN#2, use a prompt line"))
      (is (mentions-p (window::window-hint window) "hand-ungrasp 0"))
      (window::handle-drop pane (+ x 40) y)
      (is (null (window::window-selection window)) "it was no click")
      (setf (window::pane-drag pane) nil)
      (window::handle-press pane :left x y)
      (window::handle-drop pane x y)
      (is (equal (list :thing (world:find-thing "PEN#2")) (window::window-selection window))))))
