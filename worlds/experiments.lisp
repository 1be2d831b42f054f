;;;; experiments.lisp -- the shipped experiments: questions about plans, and how they are answered.

;;; Good for a first look at experiments, and as patterns for yours. At the shell:
;;;
;;;   ./cli/ars-magna experiment fetching-against-motion-noise --trials 200 --out out/ --plot
;;;
;;; Success is judged by the truth, which no plan knows.

(in-package :ars-worlds)
(in-readtable :nisp)

(defexperiment fetching-against-motion-noise
  "How often does FETCH-THING bring the globe home, the more the wheels err?

All else is without noise, so what fails is dead reckoning. Up to a fifth of the speed, twice the
default, doorways and walls put it right again. Beyond, more and more robots
are lost; some of these believe that they are home: BELIEVED is larger than the rate of success."
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

Either alone is bearable for a while: half of all looks may miss, or one push may come in a hundred
ticks. What is pushed loses its designator, and what is overlooked is not found anew: together they
are worse than the two apart."
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
of that depends on how well one sees?"
  (:robots robbie)
  (:vary (way 'search-by-chance 'search-nearest 'search-watchfully)
         (miss-thing-prob* 0 .2 .4 .6))
  (:trials 200)
  (:limit 2000)
  (:run (hide-thing 'vase '((:size 1) (:weight 1) (:color violet) (:substance glass)))
        (run-plan way '((:color violet) (:substance glass)) watson-lookouts*))
  (:success (beside-p robbie (find-thing 'vase)))
  (:measure (driven (or (first (remove-if-not #'realp (trial-values))) :none))))
