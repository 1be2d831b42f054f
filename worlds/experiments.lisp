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
