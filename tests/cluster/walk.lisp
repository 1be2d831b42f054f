;;;; walk.lisp -- an experiment of short trials, for tests/cluster/run.

(defun how-far () (+ 4 (random 2)))

(defexperiment walk-against-noise
  "Does DOT get across half of its room, the more its wheels err?"
  (:robots ars-worlds:dot)
  (:vary (motion-noise* 0 0.05 0.2))
  (:trials 4000) (:limit 60)
  (:run (robot-go-forward ars-worlds:dot (how-far))
        (run-ticks 40)
        (if (= 13 (random 1000)) (error "An error, on purpose") t))
  (:success (> (robot-x ars-worlds:dot) 7.5))
  (:measure (x (robot-x ars-worlds:dot))
            (in-words (format nil "at ~,1F, or so" (robot-x ars-worlds:dot)))))
