;;;; looking-views.lisp -- views, and the rays of scans (manual 3.4.3).

(in-package :ars-magna.tests)

(in-suite looking)

(defun view (&optional (camera (eye)))
  (third (call-once 'command:camera-view camera)))

(test camera-view.sees-the-nearest-surfaces
  (with-watcher (:clean t)
    (destructuring-bind ((tick code camera view)) (call-times 3 'command:camera-view (eye 1))
      (is (= 1 tick))
      (is (null code))
      (is (eq camera (eye 1)))
      ;; Middle: through the doorway to the far wall.
      (is (equal '(30d0 10d0 30d0) view))
      (is (equal view (robot:camera-last-view (eye 1)))))
    (is (equal '("camera-view: Camera 1 sees 30.00 10.00 30.00") (queued-texts)))))

(test camera-view.samples-at-equal-angles
  "Manual 3.4.3: the pixels of 5 over a right angle are 18 degrees apart, left to right."
  (with-watcher (:clean t)
    (flet ((put-at (degrees substance)
             (let ((angle (* degrees (/ pi 180))))
               (put 'post (list (+ 5.5 (* 6 (cos angle))) (+ 10.5 (* 6 (sin angle))))
                    :obsview t :substance substance))))
      (loop for degrees from -36 to 36 by 18 for substance from 1 do (put-at degrees substance)))
    (is (equal '(1d0 2d0 3d0 4d0 5d0) (view)))))

(test camera-view.of-things
  (with-watcher (:clean t)
    (flet ((middle () (second (view (eye 1)))))
      (put 'rug '(5.7 10.5) :substance 50)
      (is (= 10 (middle)))
      (put 'air '(7.5 10.5))
      (is (= 10 (middle)))
      ;; What does not obstruct vision corrupts what is behind it.
      (put 'pane '(8.5 10.5) :substance 40)
      (is (= (/ (+ 10 40) 2) (middle)))
      (put 'pane '(9.5 10.5) :substance 100)
      (is (= (/ (+ 10 40 100) 3) (middle)))
      (put 'screen '(12.5 10.5) :substance 70 :obsview t :size 3)
      (is (= (/ (+ 70 40 100) 3) (middle)))
      (put 'larger '(12.2 10.2) :substance 130 :obsview t :size 4)
      (is (= (/ (+ 130 40 100) 3) (middle)))
      (put 'nearer '(7.5 10.5) :obsview t)
      (is (= 0 (middle))))))

(test camera-view.from-inside
  (with-watcher (:clean t)
    (let ((box (put 'box '(5.5 10.5) :capacity 9 :substance 'world:wood)))
      (robot:move-part (eye) box)
      (is (equal '(120d0 120d0 120d0 120d0 120d0) (view)))
      (robot:move-part (eye) (robot:robot-storage-bin watcher 0))
      (is (equal '(0d0 0d0 0d0 0d0 0d0) (view))))))

(test camera-view.leaves-a-track-alone
  (with-watcher (:clean t)
    (put 'ball '(9.5 10.5))
    (let ((designator (find-object '())))
      (robot:start-track (eye) designator nil)
      (view)
      (is (robot:tracking-p (eye) designator)))))

;;; Scans.

(test scan.sees-a-thing-once-and-leaves-no-mark
  (with-watcher (:clean t)
    (loop for x from 7 below 19 do (loop for y from 3 below 18 do (put 'ball (list x y))))
    (let* ((world world:*world*)
           (things (robot::things-in-view (eye) :non-local)))
      (is (< 60 (length things) 180))
      (is (equal things (remove-duplicates things)))
      (is (null (world:world-invariant-violations world)))
      (is (notany (lambda (flags) (logtest flags robot::+seen+)) (world:world-flags world))))))

(test scan.agrees-with-the-line-of-sight
  "What a scan of a cluttered room finds, a track does not lose at once, but for a few slivers."
  (let ((found 0) (lost 0) (dice (base:make-dice 11)))
    (loop repeat 40
          do (with-watcher (:clean t)
               (loop repeat 60
                     do (put 'post (list (base:roll-between 7 19 dice)
                                         (base:roll-between 1 19 dice))
                             :obsview t))
               (let ((designators (loop for sighting in (robot:look-for-things
                                                         (eye) :non-local '() :all t)
                                        collect (robot:designate sighting (eye)))))
                 (incf found (length designators))
                 (incf lost (count-if-not (lambda (designator)
                                            (robot:trackable-p designator (eye)))
                                          designators)))))
    (is (< 200 found))
    (is (< lost (* 0.05 found)) "~D of ~D" lost found)))

(test rays.agree-with-sines-and-cosines
  "A fan is turned by a rotation; its rays must be where the angles say."
  (let ((expected (loop for index below 50
                        collect (+ 0.3d0 (* (/ pi 2) (- (/ (+ index 0.5d0) 50) 0.5d0)))))
        (directions '()))
    (robot::do-rays (dx dy) (0.3d0 (/ pi 2) 50) (push (atan dy dx) directions))
    (is (every #'near expected (reverse directions)))))

;;; Scans have a walk of their own, which has to meet the cells of all other walks.

(world:defmap walled-court (30 20)
  (rect (0 0) (29 19) bricks 10)
  (wall (12 5) (12 12) slate 30))

(world:defmap open-court (30 20)
  (wall (12 5) (12 12) slate 30)
  (wall (0 7) (0 12) slate 30))

(defun cells-by-walks (world x y angle)
  "Return what OCCUPIED-CELLS finds with 50 rays over a right angle, walked by WALK-CELLS-ON-LINE."
  (let* ((flags (world:world-flags world)) (map (world:world-map world)) (found '()))
    (labels ((visit (index)
               (when (logtest world:+occupied+ (aref flags index)) (pushnew index found))
               (logtest world:+opaque+ (aref flags index)))
             (walk (x y dx dy)
               (let* ((stopped nil)
                      (at (world:walk-cells-on-line (lambda (index at column)
                                                      (declare (ignore at column))
                                                      (setf stopped (visit index)))
                                                    (world:map-width map) (world:map-height map)
                                                    x y dx dy world:+no-limit+)))
                 (when stopped
                   (go-past (+ x (* dx at)) (+ y (* dy at)) dx dy))))
             (go-past (x y dx dy)
               (multiple-value-bind (x y) (robot::line-point-beyond-corner world world:+opaque+ x y
                                                                           dx dy)
                 (unless (or (null x) (visit (world:map-index map x y)))
                   (walk x y dx dy)))))
      (robot::do-rays (dx dy) (angle (/ pi 2) 50)
        (walk x y (robot::nonzero-component dx)
              (robot::nonzero-component dy))))
    (nreverse found)))

(defun cells-near (world x y reach cells)
  "Return those of CELLS that are no more than REACH columns and rows away from (X,Y)."
  (let ((width (world:map-width (world:world-map world))))
    (remove-if-not (lambda (index)
                     (multiple-value-bind (row column) (floor index width)
                       (and (<= (abs (- row (floor y))) reach)
                            (<= (abs (- column (floor x))) reach))))
                   cells)))

(defun court-with-things (name dice)
  "Return a world of the map NAME with 40 things, some of which obstruct sight."
  (let ((world (world:make-world (world:find-map name) :seed 1)))
    (loop repeat 40
          do (world:make-new-thing 'box (list world (base:roll-between 1 29 dice)
                                              (base:roll-between 1 19 dice))
                                   `((:size 5) (:obsview ,(base:chance 0.2d0 dice)))))
    world))

(test rays.scans-meet-the-cells-of-all-walks
  "With walls around and without, from anywhere, corners and edges included; no mark is left."
  (dolist (name '(walled-court open-court))
    (let* ((dice (base:make-dice 3)) (world (court-with-things name dice)) (seen 0)
           (flags (copy-seq (world:world-flags world))))
      (loop repeat 2000
            for whole = (base:chance 0.3d0 dice)
            for (x y) = (loop for size in '(30 20)
                              for at = (base:roll-between 0d0 size dice)
                              collect (if whole (float (floor at) 1d0) at))
            for angle = (if (base:chance 0.3d0 dice)
                            (* (/ pi 100) (floor (base:roll-between 0 200 dice)))
                            (base:roll-between 0d0 7d0 dice))
            for reach = (if (base:chance 0.2d0 dice) 1 world:+no-limit+)
            for found = (robot::occupied-cells world x y angle (/ pi 2) 50 reach)
            do (incf seen (length found))
               (unless (equal (cells-near world x y reach found)
                              (cells-near world x y reach (cells-by-walks world x y angle)))
                 (fail "~A, from ~A ~A, at ~A: ~A" name x y angle found)))
      (is (< 1000 seen))
      (is (equalp flags (world:world-flags world))))))
