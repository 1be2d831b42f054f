;;;; manual-3-5-places.lisp -- moving by places: aligning, corners, walls (manual 3.5, 2.2, C).

(in-package :ars-magna.tests)

(in-suite manual-3-5)

;;; Sensing a place (2.2).

(test manual-3-5.place-is-sensed-in-the-next-tick
  "2.2, reading 106: ROBOT-PLACE has no errors; it returns the type of place that the robot
senses, or NIL, and that is remembered. No type is remembered at first."
  (with-sprinter (:clean t)
    (is (null (ars:robot-last-place sprinter)))
    (loop for (x y type) in '((20.5 13.5 doorway) (20 13 doorway) (32.9 16.1 convex)
                              (1.5 1.5 concave) (38.99 28 concave) (10.5 10.5 nil))
          for (tick code robot place) = (progn (place-sprinter x y 1) (sprint 'ars:robot-place))
          do (is (equal (list 1 nil sprinter) (list tick code robot)))
             (is (string= type place) "at ~A" (list x y))
             (is (eq place (ars:robot-last-place sprinter))))))

(test manual-3-5.place-is-missed-or-imagined
  "Chapter 4, reading 221: where there is a type it may be missed, where there is none any type
may be sensed; so it is for aligning and for corners."
  (with-sprinter (:seed 1 :parameters '((ars:type-false-neg* 1) (ars:type-false-pos* 1)
                                        (ars:robot-align-error-prob* 0)))
    (place-sprinter 20.5 13.5 1)
    (is (null (fourth (sprint 'ars:robot-place))))
    (is (eq :no-place-type (sprint-code 'ars:robot-align-place)))
    (place-sprinter 1.5 1.5 1)
    (is (eq :no-corner (sprint-code 'ars:robot-turn-corner)))
    (place-sprinter 10.5 10.5 1)
    (is (equal '("BEAK" "CONCAVE" "CONVEX" "DOORWAY")
               (sort (remove-duplicates (loop repeat 60
                                              collect (string (fourth (sprint 'ars:robot-place))))
                                        :test #'string=)
                     #'string<)))
    (is (eq :incorrect-place-type (sprint-code 'ars:robot-align-place)))))

;;; Aligning.

(test manual-3-5.align-turns-to-the-nearest-direction
  "3.5, readings 73, 99: of the two canonical directions, those that differ least, whole turns
aside; the angle turned is returned, and the robot stays where it is in its cell."
  (with-sprinter (:clean t)
    (loop for (x y heading turned) in `((20.5 13.5 .4d0 -.4) (20 13 -.4 .4)
                                        (20.13 13.87 ,(- pi .4) .4) (20.5 13.5 ,(+ pi .4) -.4)
                                        (20.5 13.5 ,(+ (* 4 pi) .3) -.3) (20.9 13.1 ,(* 3 pi) 0)
                                        (1.5 1.5 .5 -.5) (1.2 1.8 1 ,(- (/ pi 2) 1))
                                        (1.5 1.5 ,pi ,(/ pi -2)))
          for (nil code robot reading) = (progn (place-sprinter x y heading)
                                                (sprint 'ars:robot-align-place))
          do (is (equal (list nil sprinter) (list code robot)))
             (is (near turned reading 1d-6) "~A" (list x y heading))
             (is (near (+ heading turned) (ars:robot-angle sprinter) 1d-6))
             (is-true (sprinter-at-p x y)))))

(test manual-3-5.align-waits-for-both-delays
  "3.5, reading 79: ROBOT-TURN-DELAY* and ROBOT-ALIGN-DELAY*, 6 ticks together, then the turn's."
  (with-sprinter (:clean t)
    (loop for (heading ticks) in '((.2 1) (1 4))
          do (place-sprinter 20.5 13.5 heading)
             (is (= (+ 6 ticks -1) (first (sprint 'ars:robot-align-place)))))
    (setf ars:robot-align-delay* 0)
    (place-sprinter 20.5 13.5 .2)
    (is (= 2 (first (sprint 'ars:robot-align-place))))))

(test manual-3-5.align-needs-a-place
  "3.5, reading 104: where no type is sensed there is nothing to align with."
  (with-sprinter (:clean t)
    (is (equal (list 6 :no-place-type sprinter nil) (sprint 'ars:robot-align-place)))))

(test manual-3-5.align-judges-what-it-sensed
  "3.5, readings 103, 223: a type that is not there is :INCORRECT-PLACE-TYPE; if the robot is
mistaken about that it aligns, in a cell without directions with its own heading."
  (with-sprinter (:parameters '((ars:type-false-pos* 1) (ars:robot-align-error-prob* 0)))
    (is (equal (list 6 :incorrect-place-type sprinter nil) (sprint 'ars:robot-align-place))))
  (with-sprinter (:parameters '((ars:type-false-pos* 1) (ars:robot-align-error-prob* 1)))
    (place-sprinter 10.5 10.5 .7)
    (is (equal (list 6 nil sprinter 0d0) (sprint 'ars:robot-align-place)))))

;;; Corners.

(test manual-3-5.turn-corner-goes-round-a-convex-one
  "3.5, reading 105: a robot that has driven along one side of a block turns round its corner, to
the left or right, and then faces along the other side."
  (with-sprinter (:clean t)
    (loop for (x y heading to) in `((32.5 16.5 0 ,(/ pi 2)) (32.5 16.5 ,(/ pi -2) ,(- pi))
                                    (26.5 16.5 ,pi ,(/ pi 2)) (26.1 16.9 ,(/ pi -2) 0)
                                    (26 22 ,pi ,(* 3/2 pi)) (26.5 22.5 ,(/ pi 2) 0)
                                    (32.5 22.5 0 ,(/ pi -2)) (32.5 22.5 ,(/ pi 2) ,pi)
                                    (32.5 16.5 .25 ,(/ pi 2)))
          for (nil code robot turned) = (progn (place-sprinter x y heading)
                                               (sprint 'ars:robot-turn-corner))
          do (is (equal (list nil sprinter) (list code robot)))
             (is (near (- to heading) turned 1d-6) "~A" (list x y heading)))))

(test manual-3-5.turn-corner-goes-out-of-a-concave-one
  "3.5, reading 105: a robot that has driven along one wall into a corner turns along the other
wall."
  (with-sprinter (:clean t)
    (loop for (x y heading to) in `((1.5 1.5 ,pi ,(/ pi 2)) (1 1 ,(/ pi -2) 0)
                                    (38.5 28.5 0 ,(/ pi -2)) (38.9 28.9 ,(/ pi 2) ,pi)
                                    (38.5 1.5 ,(/ pi -2) ,(- pi)) (38.5 1.5 .2 ,(/ pi 2)))
          for (nil code nil turned) = (progn (place-sprinter x y heading)
                                             (sprint 'ars:robot-turn-corner))
          do (is (null code))
             (is (near (- to heading) turned 1d-6) "~A" (list x y heading)))))

(test manual-3-5.turn-corner-again-turns-to-the-other-wall
  "3.5, reading 105: a robot that looks out of the corner already does not turn by nothing."
  (with-sprinter (:clean t)
    (loop for (x y heading) in `((1.5 1.5 ,pi) (32.5 16.5 0))
          do (place-sprinter x y heading)
             (loop repeat 4
                   for (nil code nil turned) = (sprint 'ars:robot-turn-corner)
                   do (is (null code))
                      (is (near (/ pi 2) (abs turned) 1d-6))))))

(test manual-3-5.turn-corner-acts-as-turning-does
  "3.5, reading 236: it takes ROBOT-TURN-DELAY* and the ticks of its turn, here 6, and no more."
  (with-sprinter (:clean t)
    (place-sprinter 32.5 16.5 0)
    (is (= (+ 2 6 -1) (first (sprint 'ars:robot-turn-corner))))))

(test manual-3-5.turn-corner-needs-a-corner
  "3.5: in a doorway, or in no place at all, there is :NO-CORNER."
  (with-sprinter (:clean t)
    (loop for (x y) in '((20.5 13.5) (10.5 10.5) (20 13))
          do (place-sprinter x y 0)
             (is (equal (list 2 :no-corner sprinter nil) (sprint 'ars:robot-turn-corner))))))

;;; Along walls (appendix C).

(test manual-3-5.follow-wall-ends-where-the-wall-does
  "C, reading 107: the robot drives along the wall at its side, until that ends or a corner is
reached; both are success."
  (with-sprinter (:clean t)
    (place-sprinter 19.5 3 (/ pi 2))
    (is (equal (list nil sprinter) (rest (sprint 'ars:robot-follow-wall))))
    (is (= 13 (floor (ars:robot-y sprinter))) "beside the doorway")
    (is (near 19.5 (ars:robot-x sprinter) 1d-5))
    (place-sprinter 19.25 5.5 (+ .2 (/ pi -2)))
    (is (equal (list nil sprinter) (rest (sprint 'ars:robot-follow-wall))))
    (is-true (sprinter-at-p 19.25 1 1d-5) "in the corner of the hall, straight along the wall")))

(test manual-3-5.follow-wall-can-be-blocked
  "C, reading 107: by a thing, and by a speed of 0."
  (with-sprinter (:clean t)
    (ars:move-thing (ars:find-thing 'barrel) 19.5 8.5)
    (place-sprinter 19.5 3.5 (/ pi 2))
    (is (equal (list :robot-blocked sprinter) (rest (sprint 'ars:robot-follow-wall))))
    (is-true (sprinter-at-p 19.5 8 1d-5))
    (sprint 'ars:robot-set-speed 0)
    (place-sprinter 19.5 3.5 (/ pi 2))
    (is (eq :not-moving (sprint-code 'ars:robot-follow-wall)))))
