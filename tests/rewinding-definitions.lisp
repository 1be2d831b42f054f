;;;; rewinding-definitions.lisp -- rewinds over a redefinition of plans, kickers and attributes.

(in-package :ars-magna.tests)
(in-suite rewinding)

(defun define-snooze (ticks)
  (eval `(rpl:def-interp-proc snooze () (rpl:wait-time ,ticks))))

(defun define-nudge (distance)
  (eval `(world:defkicker nudge-for-rewind (thing) () (world:kick-thing thing ,distance 0 nil))))

(defun texts-of-redefinitions ()
  (remove-if-not (lambda (text) (search "Redefined since" text)) (message-texts)))

(defmacro rewinding-far (&body body)
  "Run BODY with own definitions, in which a run keeps only its first fork."
  `(let ((run::*fork-time-share* 1/1000000))
     (base:with-own-definitions () ,@body)))

(test rewind.warns-that-plans-were-redefined
  "The plan is repeated with its new definition, and has ended at a tick at which it was going on."
  (rewinding-far
    (define-snooze 10)
    (with-rover (:seed 1 :keep t)
      (driver:begin-plan 'snooze)
      (run:run-ticks 6)
      (define-snooze 2)
      (run:run-ticks 3)
      (run:rewind 4)
      (is (null (driver:plans)))
      (let ((texts (texts-of-redefinitions)))
        (is (= 1 (length texts)))
        (is-true (has-words-p (first texts) "Redefined since tick 0: plan procedure snooze."
                              "from tick 0 to tick 5" "state at tick 5 may differ"
                              "in progress at tick 0 keep the old definition"
                              "the new one from its beginning")
                 "~A" texts)))))

(defun define-job-for-rewind (ticks)
  (eval `(ars-rap:define-rap (index (job-for-rewind ?what))
           (method (primitive (rpl:wait-time ,ticks))))))

(test rewind.warns-that-raps-were-redefined
  (rewinding-far
    (define-job-for-rewind 10)
    (with-rover (:seed 1 :keep t)
      (ars-rap:install-goal '(job-for-rewind 1))
      (driver:begin-plan 'ars-rap:work-on-agenda)
      (run:run-ticks 5)
      (define-job-for-rewind 2)
      (run:rewind 1)
      (is (eq :achieved (getf (first (ars-rap:agenda-goals)) :state)))
      (is-true (has-words-p (first (texts-of-redefinitions))
                            "plan procedure job-for-rewind" "state at tick 4 may differ")))))

(test rewind.warns-of-a-redefinition-once
  "The rewound run has gone by the new definition from the tick of the kept fork on."
  (rewinding-far
    (define-snooze 10)
    (with-rover (:seed 1 :keep t)
      (driver:begin-plan 'snooze)
      (run:run-ticks 6)
      (define-snooze 2)
      (run:rewind 4)
      (is (= 1 (length (texts-of-redefinitions))))
      (run:run-ticks 6)
      (run:rewind 5)
      (is (null (texts-of-redefinitions)))
      (define-snooze 4)
      (run:rewind 1)
      (is (= 1 (length (texts-of-redefinitions)))))))

(test rewind.does-not-warn-of-definitions-with-the-same-form
  (rewinding-far
    (define-snooze 10)
    (with-rover (:seed 1 :keep t)
      (driver:begin-plan 'snooze)
      (run:run-ticks 6)
      (define-snooze 10)
      (eval '(rpl:def-interp-proc doze () (rpl:wait-time 1)))
      (run:rewind 4)
      (is (= 1 (length (driver:plans))))
      (is (null (texts-of-redefinitions))))))

(test rewind.warns-if-a-plan-was-redefined-and-its-old-definition-restored
  (rewinding-far
    (define-snooze 10)
    (with-rover (:seed 1 :keep t)
      (define-snooze 2)
      (driver:begin-plan 'snooze)
      (run:run-ticks 6)
      (define-snooze 10)
      (run:rewind 2)
      (is (= 1 (length (driver:plans))))
      (is (= 1 (length (texts-of-redefinitions)))))))

(test rewind.to-a-kept-fork-says-that-plans-in-progress-keep-the-old-definition
  (keeping-often
    (base:with-own-definitions ()
      (define-snooze 10)
      (with-rover (:seed 1 :keep t)
        (driver:begin-plan 'snooze)
        (run:run-ticks 6)
        (define-snooze 2)
        (run:run-ticks 2)
        (run:rewind 4)
        (is-true (has-words-p (first (texts-of-redefinitions))
                              "Redefined since tick 4" "state at tick 4 is as it was"
                              "in progress at tick 4 keep the old definition"))
        (run:run-ticks 5)
        (is (= 1 (length (driver:plans))))
        (run:run-ticks 2)
        (is (null (driver:plans)))))))

(test rewind.does-not-warn-if-no-plan-goes-on-at-a-kept-fork
  (keeping-often
    (base:with-own-definitions ()
      (define-snooze 2)
      (with-rover (:seed 1 :keep t)
        (driver:begin-plan 'snooze)
        (run:run-ticks 6)
        (define-snooze 3)
        (run:rewind 1)
        (is (null (texts-of-redefinitions)))))))

(test rewind.warns-of-redefined-kickers-that-things-have
  (rewinding-far
    (define-nudge .1)
    (flet ((warned-p (kicked-p)
             (with-rover (:seed 1 :keep t)
               (when kicked-p
                 (world:set-kicker (first (world:world-thing-list world:*world*))
                                   'nudge-for-rewind))
               (run:run-ticks 6)
               (define-nudge (/ (1+ (random 1000)) 10000))
               (run:rewind 4)
               (texts-of-redefinitions))))
      (let ((texts (warned-p t)))
        (is-true (has-words-p (first texts) "Redefined since tick 0: kicker nudge-for-rewind."
                              "state at tick 2 may differ"))
        (is (null (search "Calls of plans" (first texts)))))
      (is (null (warned-p nil))))))

(test rewind.of-a-fork-warns-that-plans-were-redefined
  (rewinding-far
    (define-snooze 10)
    (with-rover (:seed 1)
      (driver:begin-plan 'snooze)
      (run:run-ticks 1)
      (run:with-fork ()
        (run:keep-forks)
        (run:run-ticks 5)
        (define-snooze 2)
        (run:rewind 3)
        (is (= 1 (length (driver:plans))))
        (is-true (has-words-p (first (texts-of-redefinitions)) "Redefined since tick 1"
                              "state at tick 3 may differ"))))))

(test rewind.at-the-prompt-warns-that-plans-were-redefined
  (rewinding-far
    (flet ((snooze (ticks) (format nil "(def-interp-proc snooze () (wait-time ~D))" ticks)))
      (is-true (has-words-p (joined (type-batch (snooze 10) "(keep-forks)" "(begin-plan 'snooze)"
                                                "step 5" (snooze 2) "rewind 2"))
                            "Redefined since tick 0: plan procedure snooze."
                            "state at tick 3 may differ"))
      (is-true (has-words-p (let ((run:*forks-to-keep* t))
                              (joined (type-live (list "pause" (snooze 10) "plan snooze" "step 5"
                                                       (snooze 2) "rewind 2" "quit"))))
                            "plan procedure snooze."
                            "state at tick 3 may differ")))))
