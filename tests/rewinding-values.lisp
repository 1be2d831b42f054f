;;;; rewinding-values.lisp -- what fluents, arguments of plans and dice are, once a run is rewound.

(in-package :ars-magna.tests)
(in-suite rewinding)

;;; Fluents.

(test rewind.undoes-fluents-that-are-first-set-after-a-rewind
  (let ((door (rpl:create-fluent 'door :shut)))
    (with-rover (:seed 1 :keep t)
      (run:run-ticks 5)
      (run:rewind 2)
      (run:run-ticks 5)
      (rpl:set-value door :open)
      (run:run-ticks 2)
      (run:rewind 4)
      (is (eq :shut (rpl:fluent-value door))))))

(test rewind.undoes-fluents-that-are-set-in-forks
  (let ((door (rpl:create-fluent 'door :shut)))
    (with-rover (:seed 1)
      (run:with-fork ()
        (run:keep-forks)
        (run:run-ticks 5)
        (rpl:set-value door :open)
        (run:rewind 2)
        (is (eq :shut (rpl:fluent-value door))))
      (is (eq :shut (rpl:fluent-value door))))))
