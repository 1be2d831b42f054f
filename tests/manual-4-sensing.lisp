;;;; manual-4-sensing.lisp -- how far and how often cameras err (manual 4, 3.4.2).

(in-package :ars-magna.tests)

(in-suite manual-4)

;;; LOOKOUT, amid a hall without anything in it, looks along x. Camera 0 sees a quarter of all
;;; round, camera 1 hardly more than a line.
(ars:defmap lookout-hall (80 60)
  (rect (0 0) (79 59) bricks 10)
  (wall (0 59) (79 59) stone 40))

(ars:defrobot lookout (lookout-hall (20.5 30.5) 0)
  :cameras (((/ pi 2) 50) (1d-6 1))
  :bins (20))

(defmacro with-lookout ((&rest options) &body body)
  "Run BODY in a headless simulation with a fresh LOOKOUT."
  `(ars:with-simulation (lookout ,@options) ,@body))

(defun glass (&optional (index 0)) (ars:robot-camera lookout index))

(defun look (specification &key (type :non-local) (camera (glass)) all)
  "Return the designator that CAMERA gets by SPECIFICATION, or NIL; with ALL a list."
  (third (if all
             ;; Naming many takes a tick for each further one.
             (quick-answer 8 'ars:camera-get-all-object-designators camera type specification)
             (quick-answer 4 'ars:camera-get-object-designator camera type specification))))

(defun count-looks (trials specification &rest options)
  "Return how many of TRIALS searches get a designator."
  (loop repeat trials count (apply #'look specification options)))

(defparameter *only-truth* '((ars:miss-thing-prob* 0) (ars:false-thing-prob* 0))
  "Settings with which a search for things finds all there is, and nothing else.")

;;; What is seen at all.

(test manual-4.scan-density*-is-the-number-of-rays
  "4, readings 130, 146: evenly spaced in the field of view: one ray looks ahead, two halve the
rest, 50 see all that is near."
  (with-lookout (:clean t)
    (loop for (name x y) in '((ahead 27.5 30.5) (right 27.5 33.5) (left 27.5 27.5))
          do (put name (list x y) :tag name))
    (loop for (rays seen) in '((1 (ahead)) (2 (right left)) (50 (ahead right left)))
          do (setf ars:scan-density* rays)
             (is (equal seen (remove-if-not (lambda (tag) (look `((:tag ,tag))))
                                            '(ahead right left)))
                 "~D rays" rays))))

(test manual-4.miss-thing-prob*-overlooks-things
  "4, reading 129: an object simply is not seen with that chance, even if it would match; for each
search, and each object, anew."
  (with-lookout (:seed 1 :parameters '((ars:false-thing-prob* 0)))
    (put 'ball '(25.5 30.5) :tag 'ball)
    (is (frequent-p (count-looks 1500 '((:tag ball))) 1500 .95))
    (put 'cube '(25.5 32.5) :tag 'cube)
    (setf ars:miss-thing-prob* .3d0)
    (let ((found (loop repeat 1500 collect (length (look '() :all t)))))
      (is (frequent-p (count 2 found) 1500 .49))
      (is (frequent-p (count 0 found) 1500 .09)))))

(test manual-4.miss-place-prob*-overlooks-places
  "4: a place simply is not seen with that chance."
  (with-sprinter (:seed 2)
    (place-sprinter 10.5 13.5 0)
    (is (frequent-p (loop repeat 2000
                          for door = (third (quick-answer 4 'ars:camera-get-place-designator
                                                          (lens) 'ars:doorway))
                          count (and door (ars:designator-denotation door)))
                    ;; Of the false ones, of which the doorway's :CONFUSION makes .05, one of two is
                    ;; chosen where the real one is found too.
                    2000 (* .9 (- 1 (/ .05 2)))))))

(test manual-4.false-thing-prob*-finds-what-is-not-there
  "4, reading 135: our parameter for false designators of things."
  (with-lookout (:seed 3)
    (is (frequent-p (count-looks 3000 '((:tag ball))) 3000 .01))
    (is (frequent-p (count-looks 3000 '((:tag ball)) :type :local) 3000 .01))))

(test manual-4.prob-stop*-says-how-far-false-designators-are
  "4, reading 136: the ray is walked cell by cell until a test of that chance succeeds, through
walls, or the edge of the map is reached."
  (with-lookout (:seed 4 :parameters '((ars:false-thing-prob* 1)))
    (flet ((distances (count)
             (loop repeat count collect (ars:designator-distance (look '() :camera (glass 1))))))
      (let* ((sample (distances 2000))
             (near (loop for metre from 1 to 20
                         collect (count-if (lambda (d) (near d metre 1d-5)) sample)))
             (far (- 2000 (reduce #'+ near))))
        (is (< (chi-square (append near (list far))
                           (append (loop for metre from 1 to 20
                                         collect (* 2000 .07 (expt .93 (1- metre))))
                                   (list (* 2000 (expt .93 20)))))
               45.3)
            "20 degrees of freedom, .001")
        (is (frequent-p (count-if (lambda (d) (near d 59.5 1d-3)) sample) 2000 (expt .93 59))))
      (setf ars:prob-stop* 1)
      (is (every (lambda (d) (near d 1 1d-5)) (distances 20)))
      (setf ars:prob-stop* 0)
      (is (every (lambda (d) (near d 59.5 1d-3)) (distances 20))))))

(test manual-4.false-designators-are-anywhere-in-the-field-of-view
  "4: a random angle in the field of view is chosen."
  (with-lookout (:seed 5 :parameters '((ars:false-thing-prob* 1) (ars:camera-angle-max-error* 0)))
    (is (uniform-p (loop repeat 1500 collect (ars:designator-angle (look '())))
                   (/ pi -4) (/ pi 4)))))

;;; How wrongly.

(test manual-4.camera-angle-max-error*-is-uniform
  "4, readings 138, 144: of the angles of designators, and of the angle that a camera reports for
its turn; it really turns by the angle given."
  (loop for error in '(nil .1d0)
        for most = (or error .02d0)
        do (with-lookout (:seed 6 :parameters *only-truth*)
             (when error (setf ars:camera-angle-max-error* error))
             (let ((ball (put 'ball '(30.5 30.5))))
               (is (uniform-p (loop repeat 500
                                    collect (ars:designator-angle (look '()))
                                    ;; What moves loses its designators.
                                    do (ars:move-thing ball 30.5 30.5))
                              (- most) most)))
             (let ((reported (loop repeat 500
                                   collect (third (quick-answer 1 'ars:camera-turn
                                                                (glass 1) 1/4)))))
               (is (uniform-p (mapcar (lambda (angle) (- angle .25d0)) reported) (- most) most))
               (is (near 125 (ars:camera-angle (glass 1))))))))

(defun pixels-read (trials)
  "Return the pixels of TRIALS views of LOOKOUT's camera 0, which faces a wall of 10."
  (ars:place-robot lookout 3.5 30.5 pi)
  (loop repeat trials append (third (quick-answer 1 'ars:camera-view (glass)))))

(test manual-4.pixel-error-range*-is-uniform
  "4, reading 147: to either side of the substance's parameter."
  (with-lookout (:seed 7 :parameters '((ars:pixel-outlier-prob* 0)))
    (is (uniform-p (pixels-read 80) 8 12))
    (setf ars:pixel-error-range* .5d0)
    (is (uniform-p (pixels-read 80) 9.5 10.5))
    (setf ars:pixel-error-range* 0)
    (is (every (lambda (pixel) (= 10 pixel)) (pixels-read 10)))))

(test manual-4.pixel-outlier-prob*-is-uniform-over-the-range-of-the-map
  "4, reading 147: with that chance a pixel is anything from the least to the greatest parameter."
  (with-lookout (:seed 8 :parameters '((ars:pixel-error-range* 0)))
    (is (frequent-p (count 10 (pixels-read 200) :test #'/=) 10000 .01))
    (setf ars:pixel-outlier-prob* 1)
    (is (uniform-p (pixels-read 80) 10 40))))

(defun read-by-lookout (demand)
  "Return what a search by camera 1 for DEMAND, of one attribute, reads of that."
  (second (assoc (first (first demand)) (ars:designator-data (look demand :camera (glass 1))))))

(test manual-4.discrete-noise-factor*-is-f-d
  "4, 3.4.2, reading 115: a discrete attribute is read right with p / max(1, f d (1-p)); a wrong
reading is any value of the domain, the right one too."
  (ars:defattribute :stripes (plain dotted lined barred) :success .75)
  (loop for (factor distance right) in '((nil 30 .75) (.5d0 4 .75) (.5d0 24 .25) (1 32 .09375)
                                         (0 50 .75))
        do (with-lookout (:seed 9 :parameters *only-truth*)
             (when factor (setf ars:discrete-noise-factor* factor))
             (put 'ball (list (+ 20.5 distance) 30.5) :stripes 'lined)
             (let ((readings (loop repeat 800
                                   collect (read-by-lookout '((:stripes (plain dotted lined
                                                                          barred)))))))
               (is (< (chi-square (loop for value in '(plain dotted lined barred)
                                        collect (count value readings :test #'string=))
                                  (loop for chance in (list 0 0 right 0)
                                        collect (* 800 (+ chance (/ (- 1 right) 4)))))
                      16.3)
                   "~A" (list factor distance))))))

(test manual-4.continuous-noise-factor*-is-f-c
  "4, 3.4.2, reading 116: a numeric attribute is read with the standard deviation max(s, m s d /
(d + f)), normally distributed, so within its base close by and not above m s."
  (ars:defattribute :heft numeric :base .5 :max-mult 4)
  (loop for (factor distance deviation) in `((nil 10 ,(/ 20 10.05)) (10 10 1) (10 1.5 .5)
                                             (30 50 1.25) (0 25 2))
        do (with-lookout (:seed 10 :parameters *only-truth*)
             (when factor (setf ars:continuous-noise-factor* factor))
             (put 'ball (list (+ 20.5 distance) 30.5) :heft 20)
             (let ((readings (loop repeat 800
                                   collect (read-by-lookout '((:heft 20 1000))))))
               (is (< (abs (- (mean-of readings) 20)) (/ (* 3.3 deviation) (sqrt 800))))
               (is (same-distribution-p readings
                                        (lambda (x)
                                          (normal-probability (/ (- x 20) deviation))))
                   "~A" (list factor distance))))))

(test manual-4.standard-match-threshold*-is-theta
  "4, 3.4.2, reading 125: how far from a specified number, or the ends of a range, a reading
matches if the specification does not say."
  (with-lookout (:clean t)
    (put 'ball '(25.5 30.5) :size 4.25)
    (flet ((match (&rest sizes)
             (remove-if-not (lambda (size) (look `((:size ,size)))) sizes)))
      (is (equal '(4 4.25 4.75 (2 3.75) (4.75 9))
                 (match 3.7 4 4.25 4.75 4.8 '(2 3.75) '(2 3.7) '(4.75 9) '(4.8 9))))
      (setf ars:standard-match-threshold* 2)
      (is (equal '(2.25 6.25 (1 2.25)) (match 2.2 2.25 6.25 6.3 '(1 2.25) '(1 2.2))))
      (setf ars:standard-match-threshold* 0)
      (is (equal '(4.25) (match 4.2 4.25 4.3))))))

;;; Tracks.

(defun track-length (designator)
  "Let camera 0 track DESIGNATOR. Return for how many ticks it does; it may lose it in the first."
  (let ((start nil) (end nil))
    (ars:camera-track (glass) designator
                      (lambda (err camera designator)
                        (declare (ignore camera designator))
                        (if err
                            (setf end (ars:simulation-tick))
                            (setf start (ars:simulation-tick)))))
    (ars:run-until (lambda () end) :limit 5000)
    (1+ (- end start))))

(test manual-4.prob-lose-track*-loses-tracks-at-random
  "4, reading 220: on any given tick with that chance, so that a track lasts 100 ticks on
average."
  (with-lookout (:seed 11 :parameters *only-truth*)
    (put 'ball '(30.5 30.5))
    (let ((lengths (loop repeat 400 collect (track-length (look '())))))
      (is (< (abs (- (mean-of lengths) 100)) (* 3.3 (/ 100 (sqrt 400)))))
      (is (frequent-p (count-if (lambda (length) (<= length 69)) lengths) 400
                      (- 1 (expt .99 69)))))))

(test manual-4.prob-lose-false-track*-loses-false-ones-sooner
  "4: with the chance .4 on any given tick, since a false designator is not real."
  (with-lookout (:seed 12 :parameters '((ars:false-thing-prob* 1)))
    (let ((lengths (loop repeat 600 collect (track-length (look '())))))
      (is (< (abs (- (mean-of lengths) 5/2)) (* 3.3 (/ (sqrt .6) .4 (sqrt 600)))))
      (is (frequent-p (count 1 lengths) 600 .4)))))

(test manual-4.false-designators-drift
  "4, readings 21, 143: while tracked, uniformly, by up to FALSE-DESIG-DRIFT-DIST* in distance and
FALSE-DESIG-DRIFT-ANG* in angle a tick."
  (with-lookout (:seed 13 :parameters '((ars:false-thing-prob* 1) (ars:prob-lose-false-track* 0)
                                        (ars:camera-angle-max-error* 0)))
    (ars:place-robot lookout 40.5 30.5 0)
    (let ((distances '()) (angles '()))
      (loop repeat 300
            do (let ((designator (look '() :camera (glass 1))))
                 (ars:camera-track (glass) designator)
                 (ars:run-ticks 4)
                 (loop repeat 3
                       for distance = (ars:designator-distance designator)
                       for angle = (ars:designator-angle designator)
                       do (ars:run-ticks 1)
                          ;; No nearer than 0, and no farther than the map.
                          (when (< 1 distance 28)
                            (push (- (ars:designator-distance designator) distance) distances)
                            (push (- (ars:designator-angle designator) angle) angles)))
                 (quick-answer 1 'ars:camera-untrack (glass))))
      (is (< 500 (length distances)))
      (is (uniform-p distances -1 1))
      (is (uniform-p angles -.2 .2)))))
