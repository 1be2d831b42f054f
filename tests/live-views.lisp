;;;; live-views.lisp -- names that hold still in a window, and how the shown robot is drawn.

(in-package :ars-magna.tests)

(in-suite display)

(defun names-placed (view robot layers)
  "Return two lists of (text box): names at rest, and those above them, in the next picture of the
world of ROBOT, at 16 pixels a cell."
  (canvas:with-canvas ((make-instance 'canvas:canvas) :scale 16)
    (flet ((texts (names)
             (loop for name in names
                   collect (list (display::label-target-name (display::placed-name-target name))
                                 (display::placed-name-box name)))))
      (multiple-value-bind (resting moving)
          (display::place-names view (make-instance 'canvas:canvas)
                                (display:take-snapshot (robot:robot-world robot)) layers)
        (list (texts resting) (texts moving))))))

(defun box-of-name (text names)
  (second (assoc text names :test #'string=)))

(defun ring-box (robot)
  "Return the box of the ring of ROBOT, at 16 pixels a cell."
  (display::box-around (* 16 (robot:robot-x robot)) (* 16 (robot:robot-y robot)) 14))

(test live-views.names-of-things-at-rest-hold-still-while-a-robot-drives-over-them
  (in-studio (robot)
    (let* ((view (display:make-live-view)) (passed '())
           (before (first (names-placed view robot '(:names)))))
      (is (= 2 (length before)))
      (loop for x from 2 to 9 by 0.25
            do (robot:place-robot robot x 4.5 0)
               (run:run-ticks 1)
               (is (equal before (first (names-placed view robot '(:names)))))
               (loop for (text box) in before
                     when (display::overlap-p box (ring-box robot)) do (pushnew text passed)))
      (is (= 2 (length passed)) "the robot was on both names"))))

(defun middle-of-name (text names)
  "Return the middle of the box of the name TEXT in NAMES, in metres, as a list."
  (destructuring-bind (left top right bottom) (box-of-name text names)
    (list (/ (+ left right) 32) (/ (+ top bottom) 32))))

(test live-views.a-name-gives-way-to-a-thing-that-is-put-on-it
  "The names of other things stay."
  (in-studio (robot)
    (let* ((view (display:make-live-view))
           (before (first (names-placed view robot '(:names)))))
      (world:make-new-thing 'coin (cons (robot:robot-world robot) (middle-of-name "box" before))
                            '((:size 1)))
      (run:run-ticks 1)
      (let ((after (first (names-placed view robot '(:names)))))
        (is (not (equal (box-of-name "box" before) (box-of-name "box" after))))
        (is-true (box-of-name "box" after))
        (is-true (box-of-name "coin" after))
        (is (equal (box-of-name "pen" before) (box-of-name "pen" after)))))))

(test live-views.a-name-gives-way-to-a-moved-thing-when-it-has-come-to-rest
  (in-studio (robot)
    (let* ((view (display:make-live-view))
           (before (first (names-placed view robot '(:names)))))
      (run:run-ticks 1)
      (world:move-thing (world:find-thing 'pen) (middle-of-name "box" before))
      (flet ((box-now () (box-of-name "box" (first (names-placed view robot '(:names))))))
        (is (equal (box-of-name "box" before) (box-now)) "the pen may only pass")
        (run:run-ticks (1- display::+ticks-to-rest+))
        (is (equal (box-of-name "box" before) (box-now)))
        (run:run-ticks 1)
        (is (not (equal (box-of-name "box" before) (box-now))))))))

(test live-views.the-name-of-a-robot-stays-on-its-side
  "Where there is room, though another side would be first."
  (in-studio (robot)
    (let ((view (display:make-live-view)))
      (flet ((offset ()
               (destructuring-bind (left top right bottom)
                   (box-of-name "studio-robot" (second (names-placed view robot '(:names))))
                 (declare (ignore right bottom))
                 (list (round (- left (* 16 (robot:robot-x robot))))
                       (round (- top (* 16 (robot:robot-y robot))))))))
        ;; The wall to the right leaves room only on the left.
        (robot:place-robot robot 9.4 6.5 0)
        (let ((left (offset)))
          (is (minusp (first left)))
          (loop for x from 9.3 downto 8 by 0.1
                do (robot:place-robot robot x 6.5 0)
                   (run:run-ticks 1)
                   (is (equal left (offset)))))))))

(test live-views.marks-that-pass-do-not-move-names
  "A mark that stays does."
  (in-studio (robot)
    (let* ((view (display:make-live-view)) (layers '(:names :designators))
           (before (box-of-name "pen" (first (names-placed view robot layers)))))
      (flet ((box-now () (box-of-name "pen" (first (names-placed view robot layers)))))
        ;; Its mark is on the robot.
        (robot:add-designator robot :x 0 :y 0)
        (robot:place-robot robot 6.5 4.5 0)
        (run:run-ticks 1)
        (is (equal before (box-now)))
        (run:run-ticks display::+ticks-to-rest+)
        (is (not (equal before (box-now))))))))

(test live-views.write-the-name-of-what-the-mouse-points-at
  "Whatever layers there are; no name is written twice."
  (in-studio (robot)
    (let ((view (display:make-live-view)) (pen (world:find-thing 'pen)))
      (flet ((texts (layers)
               (mapcar #'first (apply #'append (names-placed view robot layers)))))
        (is (null (texts '())))
        (setf (display:live-view-pointed view) pen)
        (is (equal '("pen") (texts '())))
        (is (equal '("studio-robot" "pen") (texts '(:mover-names))))
        (is (= 1 (count "pen" (texts '(:names)) :test #'string=)))))))

(test layers.names-of-what-moves-are-those-of-robots-and-of-things-with-kickers
  (in-studio (robot)
    (flet ((written (&rest layers)
             (loop for text in (drawn-with :text (display:svg-picture robot :layers layers))
                   collect (of-element text :text))))
      (world:put-kicker twitch (it (world:find-thing 'pen)) () it)
      (is (null (written)))
      (is (null (set-exclusive-or '("studio-robot" "pen") (written :mover-names)
                                  :test #'string=)))
      (is (= 3 (length (written :mover-names :names))))
      (is (not (member :mover-names display:*picture-layers*))))))

(test live-views.draw-the-shown-robot-as-a-disc
  "Below things, which it may be about to grasp. Pictures have only rings."
  (in-studio (robot)
    (robot:place-robot robot 5.5 4.5 0)
    (let* ((view (display:make-live-view)) (snapshot (display:snapshot-of robot))
           (ink (format nil "fill=\"~A\"" (web (display::nth-ink 0)))))
      (flet ((discs (view)
               (count-if (lambda (line) (and (search "<ellipse" line) (search ink line)))
                         (drawing (canvas)
                           (display:draw-movers canvas snapshot '() view))))
             (position-of (part lines) (position-if (lambda (line) (search part line)) lines)))
        (is (= 0 (discs nil)))
        (is (= 0 (discs view)))
        (setf (display:live-view-robot view) 'studio-robot)
        (is (= 1 (discs view)))
        (let ((lines (drawing (canvas) (display:draw-movers canvas snapshot '() view))))
          (is (< (position-of ink lines)
                 (position-of (web (aref canvas:green* 9)) lines))))))))

(test trail.in-a-window-is-the-last-part-with-few-points
  (let* ((points (loop for x downfrom 100d0 repeat 500
                       append (list x 5d0 0 0)))
         (corner (list* 100d0 9d0 0 0 points)))
    (canvas:with-canvas ((make-instance 'canvas:canvas) :scale 8)
      (is (= 1000 (length (first (display::pieces-of-trail points)))))
      (let ((display::*drawn-trail-metres* 50))
        (is (equalp '((800 40 392 40)) (display::pieces-of-trail points)))
        (is (equalp '((800 72 800 40 424 40)) (display::pieces-of-trail corner)))))))

(test names.in-wide-characters-have-room
  (let ((wide (coerce (list (code-char #x82B1) (code-char #x5B50)) 'string)))
    (is (= 4 (display::name-columns wide)))
    (is (= 4 (display::name-columns "desk")))
    (is (>= 24 (display::name-columns
                (display::short-name (format nil "~{~A~}" (loop repeat 30 collect wide))))))
    (is (equal "desk" (display::short-name "desk")))))
