;;;; rpl-examples.lisp -- plans that the literature of RPL and its kin shows, without a robot.

(in-package :ars-magna.tests)
(in-suite rpl)

;;; Stacking: "C on the table, A on B, B on C" (Beetz, Moesenlechner, Tenorth 2010), ordered
;;; S1 < S3 < S2, in a world of blocks: a list of (block on).

(defvar *blocks* '() "What each block is on.")

(defun block-on (block) (second (assoc block *blocks*)))

(defun clear-block-p (block) (or (eq block 'table) (not (find block *blocks* :key #'second))))

(rpl:def-goal (belief (stacked ?block ?base)) (eq base (block-on block)))

(rpl:def-goal (achieve (stacked ?block ?base))
  (if (not (and (clear-block-p block) (clear-block-p base)))
      (rpl:fail :class :not-clear :block block :base base))
  (rpl:wait-time 2)
  (setf *blocks* (cons (list block base) (remove block *blocks* :key #'first)))
  (tell (list block base)))

(defmacro with-blocks (&body body)
  "Run BODY with C on A, and A and B on the table; return what was told."
  `(let ((*blocks* '((a table) (b table) (c a))))
     (tale ,@body)))

(test examples.stacking-in-order
  (is (equal '(((c table) 2) ((b c) 4) ((a b) 6))
             (with-blocks
               (plan-value
                 (rpl:plan ((:tag s1 (rpl:achieve '(stacked c table)))
                            (:tag s2 (rpl:achieve '(stacked a b)))
                            (:tag s3 (rpl:achieve '(stacked b c))))
                           ((:order s1 s3) (:order s3 s2))))))))

(test examples.stacking-without-order-fails
  (is (null (with-blocks
              (is (eq :not-clear
                      (rpl:failure-class
                       (plan-failure-of
                         (rpl:par (rpl:achieve '(stacked a b))
                                  (rpl:achieve '(stacked b c)))))))))))

;;; "Relocalise if need be while delivering", and a door that is found by laser or by camera.

(test examples.relocalising-while-delivering
  (let ((uncertainty (fluent 0)))
    (is (equal '((:relocalised 4) (:relocalised 8) (:relocalised 12) (:relocalised 16)
                 (:delivered 17))
               (with-log (note)
                 (plan-value
                   (rpl:with-tags
                     (rpl:with-policy (rpl:whenever (> uncertainty 3)
                                        (rpl:with-task-blocked deliver
                                          (rpl:wait-time 2)
                                          (rpl:set-value uncertainty 0))
                                        (note :relocalised))
                       (:tag deliver
                         (rpl:n-times 9
                           (rpl:wait-time 1)
                           (rpl:set-value uncertainty (+ 2 (rpl:fluent-value uncertainty))))
                         (note :delivered))))))))))

(test examples.a-door-by-laser-or-camera
  (flet ((door (laser camera)
           (plan-outcome
             (rpl:try-all (rpl:seq (rpl:wait-time 3) (or laser (rpl:fail :class :no-laser)))
                          (rpl:seq (rpl:wait-time 5) (or camera (rpl:fail :class :no-camera)))))))
    (is (eq :by-laser (door :by-laser :by-camera)))
    (is (eq :by-camera (door nil :by-camera)))
    (is (= 2 (length (rpl:composite-failures (door nil nil)))))))

;;; Rittweiler's thesis: what a pursuit returns, and in which order things happen.

(test examples.pursue-returns-the-value-of-the-first
  (is (equal '((:a 0) (:b 0) (:c 0) (:d 1))
             (with-log (note)
               (is (eq :value (plan-value
                                (rpl:pursue (rpl:seq (note :a) (rpl:wait-time 1) (note :d) :value)
                                            (rpl:seq (note :b) (rpl:wait-for (fluent)))
                                            (rpl:par (rpl:seq (note :c) (rpl:wait-time 9))
                                                     (rpl:wait-for (fluent)))))))))))

;;; CRAM's tests: what happens to those who are kept from running.

(test examples.a-failure-in-a-suspended-part-counts-after-waking
  (is (equal '((:woken 6) (:failed 6))
             (with-log (note)
               (plan-value
                 (rpl:handle-failure ((:late () (note :failed) (return)))
                   (rpl:par (:tag worker (rpl:par (rpl:seq (rpl:wait-time 2)
                                                           (rpl:fail :class :late))
                                                  (rpl:wait-time 20)))
                            (rpl:seq (rpl:wait-time 1)
                                     (rpl:with-task-blocked worker (rpl:wait-time 5))
                                     (note :woken)
                                     (rpl:wait-time 20)))))))))

(test examples.a-fluent-set-meanwhile-counts-after-waking
  (let ((f (fluent)))
    (is (equal '((:woken 4) (:heard 4))
               (with-log (note)
                 (plan-value
                   (rpl:par (:tag worker (rpl:wait-for f) (note :heard))
                            (rpl:seq (rpl:wait-time 1)
                                     (rpl:with-task-blocked worker
                                       (rpl:set-value f t)
                                       (rpl:set-value f nil)
                                       (rpl:wait-time 3)
                                       (note :woken))))))))))

(test examples.a-suspended-part-does-not-hold-the-whole
  (is (equal '((:blocked 1) (:cleaned 3) (:whole 3))
             (with-log (note)
               (plan-value
                 (rpl:with-tags
                   (rpl:par (rpl:seq (rpl:pursue (:tag slow (rpl:evap-protect (rpl:wait-time 9)
                                                              (note :cleaned)))
                                                 (rpl:wait-time 3))
                                     (note :whole))
                            (rpl:seq (rpl:wait-time 1)
                                     (note :blocked)
                                     (rpl:with-task-blocked slow (rpl:wait-time 5))))))))))

(test examples.winner-and-loser-woken-together
  "Where a failure and a success wake at once, the one who came first decides (ours)."
  (let ((f (fluent)))
    (flet ((outcome (first second)
             (nth-value 1 (plan-outcome
                            (rpl:par (rpl:pursue (:tag one (rpl:wait-for f) (rpl:call-plan first))
                                                 (:tag two (rpl:wait-for f)
                                                   (rpl:call-plan second)))
                                     (rpl:seq (rpl:wait-time 1)
                                              (rpl:with-task-blocked one
                                                (rpl:with-task-blocked two
                                                  (rpl:pulse f)))))))))
      (is (eq :succeeded (outcome (rpl:interp-lambda () 1) (rpl:interp-lambda () (rpl:fail)))))
      (is (eq :failed (outcome (rpl:interp-lambda () (rpl:fail)) (rpl:interp-lambda () 1)))))))

(test examples.chain-and-join-of-orders
  (is (equal '((:a 1) (:b 2) (:c 3))
             (with-log (note)
               (plan-value (rpl:partial-order ((:tag c (rpl:wait-time 1) (note :c))
                                               (:tag b (rpl:wait-time 1) (note :b))
                                               (:tag a (rpl:wait-time 1) (note :a)))
                             (:order a b) (:order b c))))))
  (is (equal '((:b 1) (:a 4) (:joined 5))
             (with-log (note)
               (plan-value (rpl:partial-order ((:tag joined (rpl:wait-time 1) (note :joined))
                                               (:tag a (rpl:wait-time 4) (note :a))
                                               (:tag b (rpl:wait-time 1) (note :b)))
                             (:order a joined) (:order b joined)))))))

(test examples.a-ring-of-orders-is-refused
  (signals base:malformed-definition
    (rpl:make-plan '(rpl:partial-order ((:tag a 1) (:tag b 2) (:tag c 3))
                     (:order a b) (:order b c) (:order c a)))))

;;; CRAM's projection clock.

(test examples.parallel-waits-overlap
  (is (equal '((:five 5) (:ten 10) (:both 10))
             (with-log (note)
               (plan-value (rpl:par (rpl:seq (rpl:wait-time 5) (note :five))
                                    (rpl:seq (rpl:wait-time 10) (note :ten)))
                           (note :both))))))

;;; Plan transformation (Niedzwiecki): what is fetched and delivered one by one is fetched and
;;; delivered together, by replacing two pieces of code, once.

(rpl:def-interp-proc move-thing-to (what where)
  (rpl:wait-time 1)
  (tell (list what where)))

(rpl:def-interp-proc carry-two (first second)
  (:tag fetch-1 (move-thing-to :fetch first))
  (:tag deliver-1 (move-thing-to :deliver first))
  (:tag fetch-2 (move-thing-to :fetch second))
  (:tag deliver-2 (move-thing-to :deliver second)))

(defun use-both-hands (plan)
  "Let PLAN fetch two things before it delivers one. True unless it does so already."
  (let ((places (list (list plan 'deliver-1) (list plan 'fetch-2))))
    (unless (some (lambda (path) (nth-value 1 (rpl:task-code path))) places)
      (let ((codes (mapcar #'rpl:task-code places)))
        (mapc #'rpl:replace-task-code places (reverse codes))
        t))))

(test examples.fetching-both-before-delivering
  (flet ((errands () (mapcar #'first (tale (plan-value (carry-two :cup :pen))))))
    (is (equal '((:fetch :cup) (:deliver :cup) (:fetch :pen) (:deliver :pen)) (errands)))
    (unwind-protect
         (progn
           (is-true (use-both-hands 'carry-two))
           (is (equal '((:fetch :cup) (:fetch :pen) (:deliver :cup) (:deliver :pen)) (errands)))
           (is (not (use-both-hands 'carry-two)))
           (is (equal '((:fetch :cup) (:fetch :pen) (:deliver :cup) (:deliver :pen)) (errands))))
      (dolist (tag '(deliver-1 fetch-2)) (rpl:restore-task-code (list 'carry-two tag))))
    (is (equal '((:fetch :cup) (:deliver :cup) (:fetch :pen) (:deliver :pen)) (errands)))))
