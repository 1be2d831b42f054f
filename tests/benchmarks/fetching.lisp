;;;; fetching.lisp -- how often the shipped plan brings things across the default, noisy office.

(in-package :ars-magna.benchmarks)

;;; Success is the true state: the thing lies on the floor within three metres of the start.

(defparameter *errands*
  '((globe ((:color world:blue) (:substance world:plastic)) ((109 24)))
    (bucket ((:color world:blue) (:substance world:plastic)) ((108.5 66)))
    (glove-box ((:color world:lightgreen) (:substance world:plastic)) ((95 28)))
    (projector ((:color world:violet) (:substance world:metal)) ((86.5 53))))
  "Things in other rooms: their names, what they look like, and where to look from.")

(defun brought-p (thing x y)
  (multiple-value-bind (thing-x thing-y) (world:thing-position thing)
    (and (eq :floor (world:thing-location thing))
         (< (+ (expt (- thing-x x) 2) (expt (- thing-y y) 2)) 9))))

(defun fetch (errand seed)
  "Let MARVIN fetch what ERRAND says. Return true if it did, and the ticks that took."
  (destructuring-bind (name description places) errand
    (run:with-simulation (ars-worlds:marvin :seed seed)
      (let ((thing (world:find-thing name)))
        (ars-magna.rpl-robot:run-plan 'ars-worlds:fetch-thing description places)
        (values (brought-p thing 62 38) (run:simulation-tick))))))

(dolist (errand *errands*)
  (let* ((ticks '())
         (brought (loop for seed from 1 to 100
                        count (multiple-value-bind (brought took) (fetch errand seed)
                                (push took ticks)
                                brought))))
    (say (format nil "~(~A~) fetched, of 100 seeds" (first errand)) brought "times")
    (say (format nil "~(~A~), the median run" (first errand)) (median ticks) "ticks")))
