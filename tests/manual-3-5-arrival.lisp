;;;; manual-3-5-arrival.lisp -- what counts as being there, and as standing (manual 3.5, 2.1).

(in-package :ars-magna.tests)

(in-suite manual-3-5)

(defparameter *sure-approach* '((ars:prob-lose-track* 0) (ars:miss-thing-prob* 0)
                                (ars:false-thing-prob* 0))
  "Settings with which nothing but the noise of motion and angles can spoil an approach.")

(defun approach-from (x y to-x to-y &rest attributes)
  "Put SPRINTER at (X,Y), facing a new ball at (TO-X,TO-Y) with ATTRIBUTES, and make it go there.
Return the arguments of the continuation."
  (place-sprinter x y (atan (- to-y y) (- to-x x)))
  (apply #'follow-ball to-x to-y attributes)
  (approach-it))

(defun local-ball-p ()
  "True if a search for local things finds the ball, in front of the robot or where it stands."
  (not (null (spot-tag 'ball :type :local))))

(test manual-3-5.natural-ends-need-no-braking
  "3.5, reading 95: a motion that has ended by itself has stopped; stopping right after it changes
nothing."
  (loop for (command . arguments) in '((ars:robot-go-forward 4) (ars:robot-goto-wall))
        do (with-sprinter (:clean t)
             (place-sprinter 14.5 5.5 0)
             (let ((stopped nil) (ended nil))
               (apply command sprinter
                      (append arguments
                              (list (lambda (&rest call)
                                      (declare (ignore call))
                                      (setf ended (ars:robot-x sprinter))
                                      (ars:robot-stop sprinter (lambda (&rest call)
                                                                 (setf stopped call)))))))
               (ars:run-ticks 30)
               (is (equal (list nil sprinter) stopped))
               (is (= ended (ars:robot-x sprinter)) "~A" command)))))

(test manual-3-5.only-what-a-stop-interrupts-coasts
  "3.5, reading 95: an interrupted motion stops at once, also if the robot gets a stop in the same
tick."
  (with-sprinter (:clean t)
    (under-way 'ars:robot-go-forward 50)
    (let ((gone (far-to-x)))
      (ars:robot-turn sprinter 1)
      (is (equal (list 1 nil sprinter) (sprint 'ars:robot-stop)))
      (is (= gone (far-to-x))))))

(test manual-3-5.stop-never-fails
  "3.5: stopping has no error codes; a robot that cannot move any more has stopped."
  (loop for halt in (list (lambda () (ars:robot-set-speed sprinter 0))
                          (lambda () (setf ars:max-speed* 0)))
        do (with-sprinter (:clean t)
             (under-way 'ars:robot-go-forward 50)
             (funcall halt)
             (is (equal (list nil sprinter) (rest (sprint 'ars:robot-stop)))))))

(test manual-3-5.goto-designator-arrives-at-whole-coordinates
  "3.5, reading 108: at the places of most of the manual's own things, along the axes from all sides
and at other angles. At the end the thing is local, and the track has ended."
  (loop for (x y) in '((5 10) (15 10) (10 4) (10 16) (4.5 10) (10 16.5) (5.5 7.5) (15.5 13.5)
                       (5 5) (14.37 12.91))
        do (with-sprinter (:clean t)
             (let ((answer (approach-from x y 10 10)))
               (is (equal (list nil sprinter (lens)) (subseq answer 0 3)) "~A" (list x y)))
             (is (null (ars:camera-tracks (lens))))
             (is-true (local-ball-p) "~A" (list x y)))))

(test manual-3-5.goto-designator-arrives-at-what-blocks
  "3.5, reading 108: a thing with :OBSMOVE cannot be driven into; the robot has arrived when it
stands before its cell, however far its centre is from there."
  (loop for (to-x to-y) in '((10 10) (10.5 10.5) (10.9 10.1))
        do (loop for (x y) in '((5.5 10.5) (15 10) (10.5 5.5) (4.5 6.5) (14.5 13.5))
                 do (with-sprinter (:clean t)
                      (let ((answer (approach-from x y to-x to-y :obsmove t :size 4)))
                        (is (equal (list nil sprinter (lens)) (subseq answer 0 3))
                            "~A" (list x y to-x to-y)))
                      (is-false (sprinter-in-cell-p to-x to-y))
                      (is (null (ars:camera-tracks (lens))))
                      (is-true (local-ball-p) "~A" (list x y to-x to-y))))))

(test manual-3-5.goto-designator-arrives-amid-noise-anywhere
  "3.5, reading 108: in 99 of 100 cases, at whole coordinates or others, if the track is not
lost."
  (loop for (to-x to-y . attributes) in '((14 9) (14.5 9.5) (14 9 :obsmove t))
        do (is (<= 59 (loop for seed from 1 to 60
                            count (with-sprinter (:seed seed :parameters *sure-approach*)
                                    (null (first (apply #'approach-from 5.5 5.5 to-x to-y
                                                        attributes)))))))))

(test manual-3-5.goto-designator-ends-the-track-after-its-own-answer
  "3.5, readings 108, 112: the approach gets NIL and only then the tracker :LOST-TRACK, in that
tick."
  (loop for attributes in '(() (:obsmove t))
        do (with-sprinter (:clean t)
             (let ((designator (apply #'follow-ball 12 5 attributes)) (ticks '()))
               (ars:add-observer (lambda (simulation)
                                   (declare (ignore simulation))
                                   (push (length *answers*) ticks)))
               (ars:robot-goto-designator sprinter (lens) (recorder :goto))
               (ars:run-ticks 60)
               (is (equal (list (list :track nil (lens) designator)
                                (list :goto nil sprinter (lens) designator)
                                (list :track :lost-track (lens) designator))
                          (reverse *answers*)))
               (is-false (member 2 ticks) "both in one tick")))))
