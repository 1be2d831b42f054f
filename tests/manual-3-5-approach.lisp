;;;; manual-3-5-approach.lisp -- going to what a camera tracks (manual 3.5).

(in-package :ars-magna.tests)

(in-suite manual-3-5)

(defun lens (&optional (index 0)) (ars:robot-camera sprinter index))

(defun spot-tag (tag &key (type :non-local) (camera (lens)))
  "Return the designator that CAMERA finds on what has TAG."
  (third (reply 'ars:camera-get-object-designator camera type `((:tag ,tag)))))

(defun follow-designator (designator &optional (camera (lens)))
  "Track DESIGNATOR with CAMERA, under the name :TRACK. Return DESIGNATOR."
  (setf *answers* '())
  (ars:camera-track camera designator (recorder :track))
  (ars:run-ticks 5)
  designator)

(defun follow-ball (x y &rest attributes)
  "Track a new ball at (X,Y) with ATTRIBUTES by camera 0. Return the designator."
  (apply #'put 'ball (list x y) :tag 'ball attributes)
  (follow-designator (spot-tag 'ball)))

(defun approach-it ()
  "Make SPRINTER go to what camera 0 tracks. Return the arguments of the continuation."
  (rest (sprint 'ars:robot-goto-designator (lens))))

(defun sprinter-in-cell-p (x y)
  (and (= (floor x) (floor (ars:robot-x sprinter))) (= (floor y) (floor (ars:robot-y sprinter)))))

(test manual-3-5.goto-designator-gets-to-the-same-cell
  "3.5: the robot gets next to what its camera tracks, into the same cell. Camera and designator
are returned."
  (loop for (x y) in '((12.5 5.5) (9.7 8.3) (10.25 1.75) (14.9 12.1) (18.5 17.5))
        do (with-sprinter (:clean t)
             (let ((designator (follow-ball x y)))
               (is (equal (list nil sprinter (lens) designator) (approach-it)))
               (is-true (sprinter-in-cell-p x y) "~A" (list x y))))))

(test manual-3-5.goto-designator-gets-there-amid-noise
  "3.5: so it does with noise, as long as the track lasts."
  (loop for seed from 1 to 25
        do (with-sprinter (:seed seed :parameters '((ars:prob-lose-track* 0)
                                                    (ars:miss-thing-prob* 0)
                                                    (ars:false-thing-prob* 0)))
             (let ((designator (follow-ball 14.5 9.5)))
               (is (equal (list nil sprinter (lens) designator) (approach-it)) "seed ~D" seed)
               (is-true (sprinter-in-cell-p 14.5 9.5) "seed ~D" seed)))))

(test manual-3-5.goto-designator-turns-first
  "3.5: it turns to face the designator before it drives, after ROBOT-MOVE-DELAY*."
  (with-sprinter (:clean t)
    (follow-ball 12.5 5.5)
    (sprint 'ars:robot-turn 2.7d0)
    (setf *answers* '())
    (ars:robot-goto-designator sprinter (lens) (recorder :goto))
    (ars:run-ticks 4)
    (is-true (sprinter-heads-p 2.7d0) "the delay is not over")
    (ars:run-ticks 8)
    (is-true (sprinter-heads-p .3d0))
    (is-true (sprinter-at-p 5.5 5.5))
    (ars:run-ticks 20)
    (is (equal '(nil) (mapcar #'first (answers-to :goto))))
    (is-true (sprinter-in-cell-p 12.5 5.5))))

(test manual-3-5.goto-designator-waits-for-the-track
  "3.5, first finding of the readings: a track that is asked for in the same breath has begun when
the approach does, since CAMERA-DESIG-DELAY* is the shorter delay."
  (with-sprinter (:clean t)
    (put 'ball '(12.5 5.5) :tag 'ball)
    (let ((designator (spot-tag 'ball)))
      (ars:camera-track (lens) designator)
      (is (equal (list nil sprinter (lens) designator) (approach-it))))))

(test manual-3-5.goto-designator-follows-what-moves
  "3.5: the robot always moves towards the designator, also if that moves."
  (with-sprinter (:clean t)
    (let ((designator (follow-ball 12.5 5.5)) (ball (ars:find-thing 'ball)))
      (ars:schedule (:ball :timer 10) (ars:move-thing ball 13.5 7.5))
      (ars:schedule (:ball-again :timer 12) (ars:move-thing ball 14.5 9.5))
      (is (equal (list nil sprinter (lens) designator) (approach-it)))
      (is-true (sprinter-in-cell-p 14.5 9.5)))))

(test manual-3-5.goto-designator-goes-to-places
  "3.5: a thing (object or place)."
  (with-sprinter (:clean t)
    (place-sprinter 8.5 9.5 .3)
    (let ((door (third (reply 'ars:camera-get-place-designator (lens) 'ars:doorway))))
      (follow-designator door)
      (is (equal (list nil sprinter (lens) door) (approach-it)))
      (is-true (sprinter-in-cell-p 20 13)))))

(test manual-3-5.goto-designator-is-told-before-the-tracker
  "3.5, readings 87, 112: arriving ends the approach with success and then the track with
:LOST-TRACK."
  (with-sprinter (:clean t)
    (let ((designator (follow-ball 12.5 5.5)))
      (ars:robot-goto-designator sprinter (lens) (recorder :goto))
      (ars:run-ticks 40)
      (is (equal (list (list :track nil (lens) designator)
                       (list :goto nil sprinter (lens) designator)
                       (list :track :lost-track (lens) designator))
                 (reverse *answers*))))))

(test manual-3-5.goto-designator-needs-a-track
  "3.5: :NOT-TRACKING when the camera tracks nothing, after the delay."
  (with-sprinter (:clean t)
    (is (equal (list 5 :not-tracking sprinter (lens) nil)
               (sprint 'ars:robot-goto-designator (lens))))))

(test manual-3-5.goto-designator-fails-when-the-track-is-lost
  "3.5, reading 111: the approach gets :NOT-TRACKING, while the tracking process signals why."
  (loop for (end code) in (list (list (lambda () (ars:destroy-thing (ars:find-thing 'ball)))
                                      :lost-track)
                                (list (lambda () (ars:camera-untrack (lens))) :interrupt)
                                (list (lambda () (ars:camera-turn (lens) 1)) :interrupt)
                                (list (lambda () (ars:grab-resource (lens))) :interrupt))
        do (with-sprinter (:clean t)
             (let ((designator (follow-ball 15.5 5.5)))
               (ars:robot-goto-designator sprinter (lens) (recorder :goto))
               (ars:run-ticks 8)
               (funcall end)
               (ars:run-ticks 2)
               (is (equal (list (list :not-tracking sprinter (lens) designator))
                          (answers-to :goto)))
               (is (equal (list (list nil (lens) designator) (list code (lens) designator))
                          (answers-to :track)))
               (is (< 5.5 (ars:robot-x sprinter) 15))))))

(test manual-3-5.goto-designator-has-nothing-to-do-for-a-local-one
  "3.5, reading 109: a local designator is :GOTO-LOCAL, tested when the approach would start."
  (with-sprinter (:clean t)
    (put 'ball '(5.75 5.25) :tag 'ball)
    (let ((designator (follow-designator (spot-tag 'ball :type :local))))
      (is (equal (list 5 :goto-local sprinter (lens) designator)
                 (sprint 'ars:robot-goto-designator (lens))))
      (is-true (sprinter-at-p 5.5 5.5)))))

(test manual-3-5.goto-designator-signals-errors-of-movement
  "3.5: :NOT-MOVING at speed 0, :ROBOT-BLOCKED by what stands in between, which need not hide what
is behind it."
  (with-sprinter (:clean t)
    (let ((designator (follow-ball 15.5 5.5)))
      (ars:move-thing (ars:find-thing 'barrel) 10.5 5.5)
      (is (equal (list :robot-blocked sprinter (lens) designator) (approach-it)))
      (is-true (sprinter-at-p 10 5.5 1d-5))
      (sprint 'ars:robot-set-speed 0)
      (is (equal (list :not-moving sprinter (lens) designator) (approach-it))))))

(test manual-3-5.goto-designator-is-interrupted-like-others
  "3.5, reading 85: by another command to the robot; the track goes on."
  (with-sprinter (:clean t)
    (let ((designator (follow-ball 15.5 5.5)))
      (ars:robot-goto-designator sprinter (lens) (recorder :goto))
      (ars:run-ticks 8)
      (sprint 'ars:robot-stop)
      (is (equal (list (list :interrupt sprinter (lens) designator)) (answers-to :goto)))
      (is (eq designator (ars:camera-tracks (lens)))))))

(test manual-3-5.goto-designator-chases-what-is-not-there
  "3.5, reading 110: a false designator leads the robot about, and it never arrives: the track is
lost before that, or the way is blocked."
  (let ((moved 0))
    (loop for seed from 1 to 30
          do (with-sprinter (:seed seed :parameters '((ars:false-thing-prob* 1)
                                                      (ars:prob-lose-false-track* .02)))
               (place-sprinter 10.5 20.5 -1)
               (follow-designator (spot-tag 'nothing))
               (destructuring-bind ((tick code robot camera designator))
                   (call-times 1000 'ars:robot-goto-designator sprinter (lens))
                 (declare (ignore tick designator))
                 (is (equal (list sprinter (lens)) (list robot camera)))
                 (is (member code '(:not-tracking :robot-blocked)) "seed ~D" seed))
               (unless (sprinter-at-p 10.5 20.5 .5) (incf moved))))
    (is (< 10 moved))))
