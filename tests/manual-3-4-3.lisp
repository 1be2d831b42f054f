;;;; manual-3-4-3.lisp -- section 3.4.3 of the manual: views.

(in-package :ars-test-manual)
(in-readtable :nisp)

(def-suite* manual-3-4-3 :in ars-magna)

;;; camera-view.

(defun view (&optional (index 0)) (first (answer 'camera-view (eye index))))

(defun views (trials &optional (index 0))
  "Return the views that TRIALS ticks bring, each a list of numbers."
  (loop repeat trials
        collect (progn (camera-view (eye index))
                       (run-ticks 1)
                       (camera-last-view (eye index)))))

(test manual-3-4-3.camera-view-answers-in-the-next-tick
  "3.4.3, reading 149: camera and view come after NIL."
  (at-each-spot (:clean t)
    (destructuring-bind ((tick code camera view)) (call-times 5 'camera-view (eye))
      (is (= 1 tick))
      (is (null code))
      (is (eq (eye) camera))
      (is (every #'realp view)))))

(test manual-3-4-3.camera-view-shows-the-nearest-obstruction
  "3.4.3: the substance parameter of the nearest object or wall in the direction of each sample."
  (at-each-spot (:clean t)
    (is (= 10 (second (view 1))))
    (put-beside 'screen 12 0 :obsview #t :substance 70)
    (is (= 70 (second (view 1))))
    (put-beside 'nearer 5 0 :obsview #t :substance 55)
    (is (= 55 (second (view 1))))
    (put-beside 'bare 3 0 :obsview #t)
    (is (= 0 (second (view 1))))))

(test manual-3-4-3.camera-view-samples-equal-angles
  "3.4.3, reading 146: 5 pixels of a right angle are 18 degrees apart, from left to right."
  (dolist (heading '(0 1 -2.5))
    (with-scout (:clean t)
      (place-robot scout 10.5 10.5 heading)
      (loop for degrees from -36 to 36 by 18 for substance from 1
            for angle = (+ heading (* degrees (/ pi 180)))
            do (put-beside 'post (* 6 (cos angle)) (* 6 (sin angle))
                           :obsview #t :substance substance))
      (is (equal '(1d0 2d0 3d0 4d0 5d0) (view))))))

(test manual-3-4-3.camera-view-goes-where-the-camera-points
  "3.4.3: whatever the robot heads for."
  (at-each-spot (:clean t)
    (put-beside 'screen 0 5 :obsview #t :substance 70)
    (answer 'camera-turn (eye 1) (/ pi 2))
    (is (= 70 (second (view 1))))))

(test manual-3-4-3.pixels-err-within-their-range
  "3.4.3 and 4, reading 147: uniform within 2 of the truth, but for outliers."
  (with-scout (:seed 24 :parameters '((pixel-outlier-prob* 0)))
    (is (same-distribution-p (mapcar #'second (views 2000 1)) (uniform 8 12)))))

(test manual-3-4-3.pixels-are-outliers-now-and-then
  "4, reading 147: with 0.01 anything from the least to the greatest wall parameter, 10 to 30."
  (with-scout (:seed 25)
    (let* ((pixels (mapcar #'second (views 6000 1)))
           (gross (remove-if (lambda (pixel) (<= 8 pixel 12)) pixels)))
      (is (frequent-p (length gross) 6000 (* .01 18/20)))
      (is (same-distribution-p gross (uniform 12 30))))))

(test manual-3-4-3.pixels-err-independently
  "3.4.3: the errors of two pixels of one view have nothing to do with each other."
  (with-scout (:seed 26 :parameters '((pixel-outlier-prob* 0)))
    (turned-to pi)
    (let* ((views (views 4000 1))
           (products (loop for (a b) in views collect (* (- a 10) (- b 10)))))
      ;; The product of two independent errors has the mean 0 and the deviation 4/3.
      (is (< (abs (/ (reduce #'+ products) 4000)) (* 3.3 (/ 4/3 (sqrt 4000))))))))

(test manual-3-4-3.camera-view-has-no-errors
  "3.4.3: inside something, tracking, at a wall: it always succeeds."
  (at-each-spot (:clean t)
    (put-beside 'ball 5 0)
    (tracking (record (look '()))
      (is (null (end-code 'camera-view (eye)))))
    (answer 'camera-insert (eye 1) (bin-of-scout))
    (is (null (end-code 'camera-view (eye 1))))
    (place-robot scout 1 1 pi)
    (is (null (end-code 'camera-view (eye))))))

(test manual-3-4-3.camera-view-from-inside
  "Reading 148: all pixels are the container's parameter with noise, in a storage bin 0."
  (with-scout (:seed 27 :parameters '((pixel-outlier-prob* 0)))
    (let ((camera (eye)))
      (answer 'camera-insert camera (bin-of-scout))
      (let ((pixels (reduce #'append (views 400))))
        (is (= 2000 (length pixels)))
        (is (same-distribution-p pixels (uniform -2 2)))))))

(test manual-3-4-3.camera-view-of-several-things
  "Reading 240: the nearer cell wins, and in one cell the larger thing."
  (at-each-spot (:clean t)
    (put 'small '(15.9 10.1) :obsview #t :substance 40 :size 1)
    (put 'large '(15.1 10.9) :obsview #t :substance 80 :size 2)
    (is (= 80 (second (view 1))))
    (put 'near '(14.1 10.9) :obsview #t :substance 60)
    (is (= 60 (second (view 1))))))

(test manual-3-4-3.camera-view-does-not-see-where-it-is
  "Readings 65 and 130: what lies where the camera is hides nothing and corrupts nothing."
  (at-each-spot (:clean t)
    (put-beside 'rug 0 0 :obsview #t :substance 99)
    (put-beside 'mat 0 0 :substance 99)
    (is (= 10 (second (view 1))))))

;;; Delays, of all commands of the section.

(test manual-3-4-3.commands-take-their-delays
  "3.4.3 and 4: views and untracking the next tick (reading 149), turns camera-align-delay*,
insertion camera-move-delay*, acquiring and tracking camera-desig-delay*."
  (loop for (ticks command . arguments)
          in '((1 camera-view) (1 camera-untrack) (1 camera-turn 1) (1 camera-turn 9)
               (1 camera-align-robot) (1 camera-align-place) (2 camera-remove)
               (4 camera-get-place-designator doorway)
               (4 camera-get-all-place-designators doorway)
               (4 camera-get-object-designator :non-local ())
               (4 camera-get-all-object-designators :local ()))
        do (at-each-spot (:clean t)
             (put-beside 'ball 5 0)
             (is (= ticks (first (first (apply #'call-times 20 command (eye) arguments))))
                 "~A" command)))
  (with-scout (:clean t)
    (put-beside 'ball 5 0)
    (is (= 4 (first (first (call-times 20 'camera-track (eye) (look '()))))))
    (is (= 2 (first (first (call-times 20 'camera-insert (eye 1) (bin-of-scout))))))))

(test manual-3-4-3.delays-can-be-set
  "3.4.3 and 4: by the parameters."
  (with-scout (:clean t :parameters '((camera-desig-delay* 9) (camera-align-delay* 7)
                                      (camera-move-delay* 6)))
    (put-beside 'ball 5 0)
    (is (= 9 (first (first (call-times 20 'camera-get-object-designator
                                       (eye) :non-local '())))))
    (is (= 7 (first (first (call-times 20 'camera-turn (eye) 1)))))
    (is (= 6 (first (first (call-times 20 'camera-insert (eye) (bin-of-scout))))))))

(test manual-3-4-3.commands-can-be-interrupted
  "3.4.3 and 3.1.2: all that take time get :INTERRUPT and nothing else."
  (loop for (command . arguments) in '((camera-get-place-designator doorway)
                                       (camera-get-all-place-designators doorway)
                                       (camera-get-object-designator :non-local ())
                                       (camera-get-all-object-designators :non-local ())
                                       (camera-turn 1) (camera-align-robot)
                                       (camera-align-place) (camera-remove))
        do (with-scout (:clean t :parameters '((camera-align-delay* 5)))
             (put-beside 'ball 5 0)
             (recording (record)
               (apply command (eye) (append arguments (list (record command))))
               (run-ticks 1)
               (camera-view (eye))
               (run-ticks 9)
               (let ((calls (record)))
                 (is (equal '(:interrupt) (codes calls)))
                 (is (every #'null (cdddr (first calls)))))
               (is (= 0 (camera-angle (eye))))))))
