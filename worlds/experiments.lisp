;;;; experiments.lisp -- the shipped experiments on plans.

;;; Run them as they are, or use them as models for yours. From the shell:
;;;
;;;   ./cli/ars-magna experiment fetching-against-motion-noise --trials 200 --out out/ --plot
;;;
;;; Success is measured by the true state of the world, which plans cannot see.

(in-package :ars-worlds)
(in-readtable :nisp)

(defexperiment fetching-against-motion-noise
  "How often does FETCH-THING bring the globe home, the more the wheels err?

All other noise is off, so failures come from dead reckoning. Up to noise of a fifth of the speed,
twice the default, doorways and walls correct the reckoning. With more noise, more robots get lost.
BELIEVED is how often the plan reports success; this rate is larger than the true rate, because some
lost robots end their plan as if they were home."
  (:robots marvin)
  (:clean t)
  (:vary (motion-noise* 0 .2 .4 .6 .8 1))
  (:trials 200)
  (:limit 5000)
  (:run (run-plan 'fetch-thing '((:color blue) (:substance plastic)) '((109 24))))
  (:success (near-p (find-thing 'globe) '(62 38)))
  (:measure (believed (eq :succeeded (second (trial-values))))))

(defexperiment fetching-against-blindness-and-kicks
  "How often does FETCH-THING bring the globe home, the worse the cameras see it and the more often
somebody pushes it about?

A few misses, or a few pushes, do little harm: half of all looks may miss, or there may be a push in
a hundred ticks. A push invalidates the designator of the globe, and a look that misses does not
find it again. So misses and pushes together do more harm than their separate effects."
  (:robots marvin)
  (:vary (miss-thing-prob* .05 .3 .5 .7)
         (pushes 0 .01 .03 .1))
  (:trials 200)
  (:limit 5000)
  (:run (make-restless (find-thing 'globe) pushes)
        (run-plan 'fetch-thing '((:color blue) (:substance plastic)) '((109 24))))
  (:success (near-p (find-thing 'globe) '(62 38))))

(defexperiment three-ways-of-searching
  "What is it worth, in a search, to remember where one has looked, and to look on the way? How much
does that depend on how often a look misses?"
  (:robots robbie)
  (:vary (way 'search-by-chance 'search-nearest 'search-watchfully)
         (miss-thing-prob* 0 .2 .4 .6))
  (:trials 200)
  (:limit 2000)
  (:run (hide-thing 'vase '((:size 1) (:weight 1) (:color violet) (:substance glass)))
        (run-plan way '((:color violet) (:substance glass)) watson-lookouts*))
  (:success (beside-p robbie (find-thing 'vase)))
  (:measure (driven (or (first (remove-if-not #'realp (trial-values))) :none))))

;;; Recognising places. The robot is put down at places of OFFICE, and then near one of them.

(defun thin-out (signature pixels)
  "Return the round SIGNATURE that a camera with only PIXELS all round would have taken."
  (let* ((strip (second signature)) (step (/ (length strip) pixels)))
    (list :round (loop for i from 0 below (length strip) by step collect (elt strip i)))))

(def-interp-proc signature-near (point pixels dice)
  "Put the robot down within half a metre of POINT, with any heading. Return a signature there."
  (place-robot (rpl-robot)
               (+ (first point) (roll-within .5 dice)) (+ (second point) (roll-within .5 dice))
               (roll-between 0 2pi dice))
  (thin-out (take-round-signature '(1)) pixels))

(def-interp-proc revisit-place (places pixels)
  "Learn as many PLACES, at random, by signatures of PIXELS, and recognise one of them. Return the
match. Fails with :WRONG-PLACE if another place matches better."
  (let* ((dice (dice-for 'revisit-place))
         (points (loop repeat places collect (random-clear-point dice)))
         (visited (roll-index places dice)))
    (dotimes (i places)
      (learn-place i (signature-near (elt points i) pixels dice)))
    (multiple-value-bind (name match)
        (recognise-place (signature-near (elt points visited) pixels dice) :threshold 0)
      (if (eql name visited) match (fail :class :wrong-place)))))

(defexperiment recognising-places
  "How often does a robot recognise the place where it is by what its camera sees, the more the
pixels err, the fewer pixels there are, and the more places it knows?

The robot learns PLACES random places of the office, each by one signature of PIXELS all round. Then
it comes back to one of them, up to a metre from where it was, with another heading. MATCH is the
match where it has recognised the place."
  (:robots marvin)
  (:vary (pixel-error-range* 2 10 20)
         (pixels 4 9 18 36)
         (places 10 40))
  (:trials 200)
  (:limit 5000)
  (:run (run-plan 'revisit-place places pixels))
  (:measure (match (or (first (remove-if-not #'realp (trial-values))) :none))))

;;; Finding back. What the robot explores is HALL, whose places look much alike.

(defun distance-of-porter ()
  "Return how far PORTER is from its start in HALL, in metres."
  (vector-length (- (robot-x porter) 20) (- (robot-y porter) 20)))

(def-interp-proc explore-and-return (places threshold)
  "Learn PLACES by THRESHOLD, and return to the first. Return how far that was, in metres."
  (explore-by-views :places places :threshold threshold)
  (let ((far (distance-of-porter)))
    (return-by-views)
    far))

(defexperiment returning-by-views
  "How often does a robot find back by views, the better a view must match that of a known place?

The robot explores HALL, where views change little with distance: 8 metres on, they match by .47,
and at the same place by .69. So with a low threshold the robot takes other places for those it
knows, and the ways that it learns are wrong. With a high one it learns another place in doubt.
Success is to be within 5 metres of the start, FAR how far it had to return."
  (:robots porter)
  (:vary (threshold .55 .65 .75)
         (places 8 12))
  (:trials 100)
  (:limit 20000)
  (:run (run-plan 'explore-and-return places threshold))
  (:success (< (distance-of-porter) 5))
  (:measure (far (or (first (remove-if-not #'realp (trial-values))) :none))))
