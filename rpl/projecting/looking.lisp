;;;; looking.lisp -- repeating a rollout to look at it; a projection as a picture.

(in-package :ars-magna.rpl-projecting)

(defun call-with-rollout (function rollout &key print)
  (check-argument with-rollout rollout (rollout-p rollout)
                  "a rollout, as PROJECTION-ROLLOUTS returns")
  (roll-out (rollout-scene rollout) (rollout-trial rollout) (rollout-seed rollout)
            :print print
            :then (lambda (again)
                    (declare (ignore again))
                    (let ((*rolling-out* nil)) (funcall function)))))

(addition with-rollout)
(define-user-macro with-rollout ((rollout &key print) &body body)
  "Repeat ROLLOUT from its start. At its end, run BODY inside the repeated run, as in WITH-FORK,
with the robots, things and messages of that run. Drop what plans write before BODY, unless PRINT is
true. Return the values of BODY. Signals WRONG-ARGUMENT."
  `(call-with-rollout (lambda () ,@body) ,rollout :print ,print))

;;;; As a bundle of ways over the map

(defun snapshot-of-start (projection)
  "Return a snapshot of the world in which the rollouts of PROJECTION began. For rollouts in a
believed world, return a snapshot of that world after a rollout."
  (let* ((rollout (first (projection-rollouts projection)))
         (scene (rollout-scene rollout)))
    (if (rollout-start-moment scene)
        (take-snapshot (simulation-world (rollout-start-moment scene)))
        (roll-out scene (rollout-trial rollout) (rollout-seed rollout)
                  :then (lambda (again)
                          (declare (ignore again))
                          (take-snapshot *world*))))))

(defun picture-subtitle (projection)
  (multiple-value-bind (low high) (projection-interval projection)
    (format nil "~D of ~D rollouts succeeded within ~D ticks: ~,2F to ~,2F. The ways of robots in ~
                 all rollouts, with a marker at the end of each way."
            (projection-successes projection) (length (projection-rollouts projection))
            (projection-horizon projection) low high)))

(addition save-projection-picture)
(define-with-keywords save-projection-picture
    (projection file &rest options &key part title layers in-color scale)
  "Save in FILE, replacing it, a map with the ways that robots went in the rollouts of PROJECTION.
Colours show how each rollout ended, and markers show where the robot then was. PART (left top right
bottom), in cells, selects a part of the map, by default all. TITLE replaces the plan in the title.
FILE and the other arguments are those of SAVE-PICTURE. Return the file's truename. Signals
WRONG-ARGUMENT; and MISUSE if the program that PNG needs is missing."
  (declare (ignore part title layers in-color scale))
  (check-argument save-projection-picture projection
                  (and (projection-p projection) (projection-rollouts projection) t)
                  "a projection with rollouts, as PROJECT returns")
  (picture-kind 'save-projection-picture file)
  (apply #'save-picture-of-ways 'save-projection-picture "rollout" file
         (snapshot-of-start projection)
         (lambda ()
           (mapcan (lambda (rollout) (copy-list (rollout-ways rollout)))
                   (projection-rollouts projection)))
         (projection-text projection) (picture-subtitle projection) options))
