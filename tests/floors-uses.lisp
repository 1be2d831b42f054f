;;;; floors-uses.lisp -- imported maps in use: coordinates of the source, robots, journals.

(in-package :ars-magna.tests)

(in-suite floors)

(defun near-list-p (expected list)
  (and (= (length expected) (length list))
       (every (lambda (a b) (< (abs (- a b)) 1d-9)) expected list)))

(test frame.leads-there-and-back
  "Elsewhere y grows upwards, and angles against the clock."
  (with-own-definitions
    (eval '(world:defmap framed (20 10 :frame (1/2 -3 4 0))))
    (flet ((there (&rest arguments)
             (multiple-value-list (apply #'ars:map-to-frame 'framed arguments))))
      (is (near-list-p '(-3 4 0) (there 0 10)) "the lower left corner")
      (is (near-list-p '(-3 9 0) (there 0 0)))
      (is (near-list-p '(7 9 -1) (there 20 0 1))))
    (eval `(world:defmap framed (20 10 :frame (1/2 -3 4 ,(/ pi 2)))))
    (is (near-list-p (list -3 14 (/ pi 2)) (multiple-value-list (ars:map-to-frame 'framed 20 10))))
    (let ((dice (base:make-dice 4)))
      (dotimes (i 50)
        (let ((pose (loop repeat 3 collect (base:roll-between -30 30 dice))))
          (eval `(world:defmap framed (20 10 :frame (.05 -3 4 ,(base:roll dice)))))
          (is (near-list-p pose (multiple-value-list
                                 (multiple-value-call #'ars:frame-to-map 'framed
                                   (apply #'ars:map-to-frame 'framed pose))))))))))

(test frame.must-make-sense
  (dolist (frame '(nil 1 (1 0 0) (0 0 0 0) (-1 0 0 0) (1 0 0 x) (1 0 0 1e10) (1 0 0 . 0)))
    (signals base:malformed-definition
      (eval `(world:defmap framed (20 10 :frame ,frame)))))
  (is (equal '(1 0 0 0) (with-own-definitions
                          (eval '(world:defmap framed (20 10)))
                          (world:map-frame (world:find-map 'framed)))))
  (signals base:wrong-argument (ars:map-to-frame 7 1 1))
  (signals base:unknown-name (ars:frame-to-map 'no-such-floor 1 1))
  (signals base:wrong-argument (ars:frame-to-map 'no-such-floor 1 "1"))
  (signals base:wrong-argument (ars:map-to-frame 'no-such-floor 1d300 1)))

;;; A floor with a robot.

(defparameter *two-rooms*
  (flet ((row (text) (map 'list (lambda (char) (if (char= #\# char) 0 254)) text)))
    (mapcar #'row '("################"
                    "#......#.......#"
                    "#......#.......#"
                    "#..............#"
                    "#......#.......#"
                    "#......#.......#"
                    "################")))
  "The rows of an image of two rooms and a doorway between them.")

(defmacro with-two-rooms ((yaml) &body body)
  "Run BODY with the map TWO-ROOMS, imported from YAML, and the robot GUIDE in it."
  `(with-floor (,yaml (pgm-octets *two-rooms*))
     (ars:import-map ,yaml :name 'two-rooms
                           :clauses '((obj vase (12.5 3.5) ((:size 1) (:color red)))))
     (eval '(robot:defrobot guide (two-rooms (2.5 3.5) 0) :cameras ((1 12))))
     ,@body))

(test floor.is-lived-in-like-any-map
  (with-two-rooms (yaml)
    (let ((map (world:find-map 'two-rooms)) (blocked '()) (found nil) (view nil))
      (is (eq 'world:doorway (world:place-type-name
                              (world:place-type (world:cell-type (world:map-cell map 7 3))))))
      (is (subsetp '((6.5d0 3.5d0) (8.5d0 3.5d0))
                   (mapcar (lambda (point) (list (geo:pt-x point) (geo:pt-y point)))
                           (ars:find-way map '(2.5 1.5) '(13.5 5.5)))
                   :test #'equal)
          "ways lead through the doorway")
      (run:with-simulation ('guide :clean t :seed 1)
        (let* ((robot (robot:find-robot 'guide)) (camera (robot:robot-camera robot 0)))
          (command:camera-get-object-designator camera :non-local '((:color red))
                                                (lambda (code camera designator)
                                                  (declare (ignore code camera))
                                                  (setf found designator)))
          (run:run-ticks 5)
          (command:camera-view camera (lambda (code camera pixels)
                                        (declare (ignore code camera))
                                        (setf view pixels)))
          (run:run-ticks 5)
          (command:robot-turn robot (/ pi 2))
          (command:robot-go-forward robot 30 (lambda (code &rest more)
                                               (declare (ignore more))
                                               (push code blocked)))
          (run:run-ticks 60)))
      (is-true found "the vase is seen through the doorway")
      (is (member 20 view :test #'=) "and so are walls of bricks")
      (is (equal '(:robot-blocked) blocked)))))

(test floor.can-be-replayed-saved-and-forked
  (with-two-rooms (yaml)
    (flet ((drive ()
             (command:robot-turn (robot:find-robot 'guide) .3)
             (run:run-ticks 5)
             (command:robot-go-forward (robot:find-robot 'guide) 4)
             (run:run-ticks 5)))
      (uiop:with-temporary-file (:pathname saved)
        (let ((journal nil) (digest nil))
          (run:with-simulation ('guide :seed 3 :journal t)
            (drive)
            (run:save-simulation saved)
            (run:run-ticks 20)
            (setf journal (run:journal-up-to-now (time:current-simulation))
                  digest (run:state-digest)))
          (is (= digest (nth-value 1 (run:replay journal))))
          (run:with-loaded-simulation (saved)
            (run:run-ticks 20)
            (is (= digest (run:state-digest))))
          (write-as-octets (pgm-octets (reverse *two-rooms*))
                        (merge-pathnames "floor.pgm" directory))
          (ars:import-map yaml :name 'two-rooms :substance 'ars:slate)
          (signals run:different-definitions (run:replay journal)))))))
