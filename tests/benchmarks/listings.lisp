;;;; listings.lisp -- how often the manual's own plans, D.2 to D.9, succeed.

(in-package :ars-magna.benchmarks)

;;; The robot, its room and its ball are those of the tests, which check the true state.

(handler-bind ((warning #'muffle-warning))
  (asdf:load-system "ars-magna/tests"))

(in-package :ars-magna.tests)

(defun say-rate (name clean run)
  "Print how many of 30 seeds RUN, which returns true if it went well, went well with."
  (let ((well (loop for seed from 1 to 30
                    count (with-valet (:seed seed :clean clean) (funcall run)))))
    (ars-magna.benchmarks:say (format nil "~A, ~:[noisy~;clean~], of 30 seeds" name clean)
                              well "times")))

(defmacro rates (name listings &body run)
  `(with-listings ,listings
     (dolist (clean '(t nil))
       (say-rate ,name clean (lambda () ,@run)))))

(let ((driver:*plan-limit* 5000))
  (rates "D.2 finds what is red behind it" ("d2-rpl-scan-for-object")
    (let ((ball (put-ball 2.5 8.5)))
      (eq ball (robot:designator-denotation (scan-by-plan '((:color red)))))))
  (rates "D.4 goes to what is red" ("d2-rpl-scan-for-object" "d4-rpl-go-to-object")
    (let ((ball (put-ball 12.5 12.5)))
      (and (eq :succeeded (nth-value 1 (go-by-plan 60))) (near-thing-p ball))))
  (rates "D.6 stows away what is red" ("d2-rpl-scan-for-object" "d6-rpl-grab-object")
    (let ((ball (put-ball 6.5 8.5)))
      (and (eq :succeeded (grab-by-plan)) (equal (list ball) (contents-of-bin 0)))))
  (rates "D.7 puts down what is red" ("d2-rpl-scan-for-object" "d7-rpl-put-down-object")
    (let ((ball (ball-in-bin)))
      (and (eq :succeeded (put-down-by-plan)) (on-floor-here-p ball))))
  (with-listings ("d8-with-odometric-return")
    (define-outing)
    (dolist (clean '(t nil))
      (say-rate "D.8 comes back within a metre of home" clean
                (lambda ()
                  (> 1 (reduce #'min (distances-after-peak
                                      (nth-value 1 (way-of-outing 10 1)))))))))
  (with-all-listings ()
    (dolist (clean '(t nil))
      (say-rate "D.9 brings what is near" clean
                (lambda ()
                  (robot:set-robot-pose valet 6.1 8.5 0)
                  (let ((ball (put-ball 5.05 8.5)))
                    (and (eq :succeeded (bring-by-plan 60)) (on-floor-here-p ball))))))))
