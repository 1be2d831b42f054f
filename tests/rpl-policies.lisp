;;;; rpl-policies.lisp -- parts of a plan that watch, order, block or exclude each other.

(in-package :ars-magna.tests)
(in-suite rpl)

;;; Whenever and policies.

(test whenever.runs-at-once-if-true-and-then-once-for-each-event
  (let ((f (fluent :initially)))
    (is (equal '((:initially 0) (:change 1) (:change 2) (:again 4))
               (with-log (note)
                 (plan-value
                   (rpl:pursue (rpl:whenever f (note (rpl:fluent-value f)))
                               (rpl:seq (rpl:wait-time 1) (rpl:set-value f :change)
                                        (rpl:wait-time 1) (rpl:pulse f)
                                        (rpl:wait-time 1) (rpl:set-value f nil)
                                        (rpl:wait-time 1) (rpl:set-value f :again)
                                        (rpl:set-value f :again)
                                        (rpl:wait-time 1)))))))))

(test whenever.events-during-its-body-count-as-one
  (let ((f (fluent)))
    (flet ((turns (missed)
             (length (with-log (note)
                       (plan-value
                         (rpl:pursue (rpl:whenever (f :missed missed)
                                       (note :turn)
                                       (rpl:wait-time 10))
                                     (rpl:seq (rpl:wait-time 1)
                                              (rpl:n-times 5 (rpl:pulse f) (rpl:wait-time 1))
                                              (rpl:wait-time 100))))))))
      (is (= 2 (turns :once)))
      (is (= 5 (turns :all))))))

(defun turns-of-network (missed network &rest then)
  "Return the ticks in which (WHENEVER (NETWORK :MISSED MISSED) ...) runs its body. NETWORK is a
function of two fluents. The second is true from tick 1 on; the first is pulsed with each of THEN at
the ticks 2 to 5."
  (let ((bell (fluent)) (on (fluent)))
    (mapcar #'second
            (with-log (note)
              (plan-value
                (rpl:pursue (rpl:whenever ((funcall network bell on) :missed missed)
                              (note :turn))
                            (rpl:seq (rpl:wait-time 1) (rpl:set-value on t)
                                     (rpl:n-times 4
                                       (rpl:wait-time 1)
                                       (dolist (value then) (rpl:pulse bell value)))
                                     (rpl:wait-time 3))))))))

(test whenever.hears-pulses-in-a-network-that-is-true
  (let ((either (lambda (bell on) (ars-magna.rpl.lifted:or on bell)))
        (deep (lambda (bell on)
                (ars-magna.rpl.lifted:not
                 (ars-magna.rpl.lifted:not
                  (ars-magna.rpl.lifted:or (ars-magna.rpl.lifted:eq bell 9) on)))))
        (both (lambda (bell on) (ars-magna.rpl.lifted:and on (ars-magna.rpl.lifted:not bell)))))
    (dolist (network (list either deep))
      (is (equal '(1 2 3 4 5) (turns-of-network :once network t)))
      (is (equal '(1 2 3 4 5) (turns-of-network :all network t)))
      (is (equal '(1 2 2 3 3 4 4 5 5) (turns-of-network :all network 1 2))))
    (is (equal '(1 2 3 4 5) (turns-of-network :all both t)))))

(test whenever.hears-a-pulse-once-that-changes-what-is-true
  (is (equal '(1 2 3 4 5)
             (turns-of-network :all (lambda (bell on) (ars-magna.rpl.lifted:or bell on)) 7))))

(test whenever.hears-no-pulse-in-a-network-that-is-false
  (is (equal '(1)
             (turns-of-network :all (lambda (bell on) (ars-magna.rpl.lifted:and
                                                       on (ars-magna.rpl.lifted:not
                                                           (ars-magna.rpl.lifted:eq bell 5))))))))

(test whenever.a-pulse-computes-what-it-does-not-change-once
  (let* ((count 0) (bell (fluent)) (base (rpl:fl-funcall (constantly t) bell))
         (above (rpl:fl-funcall (lambda (value) (incf count) value) base)))
    (plan-value (rpl:pursue (rpl:whenever above nil)
                            (rpl:seq (rpl:wait-time 1)
                                     (rpl:n-times 5 (rpl:pulse bell) (rpl:wait-time 1)))))
    (is (= 1 count))))

(test whenever.a-body-that-leaves-it-true-does-not-spin
  (let ((f (fluent t)))
    (is (= 1 (length (with-log (note)
                       (plan-value (rpl:pursue (rpl:whenever f (note :turn))
                                               (rpl:wait-time 10)))))))))

(test whenever.ends-by-return-and-by-failure
  (let ((f (fluent)))
    (is (eq :enough (plan-value (rpl:par (rpl:seq (rpl:wait-time 1) (rpl:pulse f))
                                         (rpl:whenever f (return :enough))))))
    (plan-failure-of (rpl:par (rpl:seq (rpl:wait-time 1) (rpl:pulse f))
                              (rpl:whenever f (rpl:fail))))
    (is (null (fluents::fluent-first-watcher f)))))

(test with-policy.starts-before-the-body-and-precedes-it
  (let ((trouble (fluent :left-over)) (steps '()))
    (is (eq :policy
            (rpl:failure-class
             (plan-failure-of
               (rpl:with-policy (rpl:seq (rpl:set-value trouble nil)
                                         (rpl:whenever trouble (rpl:fail :class :policy)))
                 (push :one steps)
                 (rpl:set-value trouble :lost-track)
                 (push :two steps))))))
    (is (equal '(:one) steps))))

(test with-policy.gets-its-chance-inside-branches-and-lets-too
  (let ((trouble (fluent)) (steps '()))
    (plan-failure-of
      (rpl:with-policy (rpl:whenever trouble (rpl:fail))
        (let ((x 1))
          (when (= x 1)
            (push :one steps)
            (rpl:set-value trouble t)
            (push :two steps)))))
    (is (equal '(:one) steps))))

(test with-policy.ends-with-its-body
  (let ((f (fluent)))
    (is (eq :body (plan-value (rpl:with-policy (rpl:whenever f (rpl:fail))
                                (rpl:wait-time 2)
                                :body))))
    (is (null (fluents::fluent-first-watcher f)))
    (is (eq :body (plan-value (rpl:with-policy (rpl:wait-time 1) (rpl:wait-time 2) :body))))
    (is (eq :in-body (rpl:failure-class
                      (plan-failure-of (rpl:with-policy (rpl:whenever f (rpl:fail))
                                         (rpl:fail :class :in-body))))))))

(test with-policy.policies-above-policies
  (let ((f (fluent)))
    (is (equal '((:above 1) (:policy 1) (:body 1))
               (with-log (note)
                 (plan-value
                   (rpl:with-policy (rpl:with-policy (rpl:whenever f (note :above))
                                      (rpl:whenever f (note :policy)))
                     (rpl:wait-time 1)
                     (rpl:pulse f)
                     (note :body))))))))

;;; Order constraints, tags, blocking.

(test partial-order.keeps-its-order
  (is (equal '((:c 0) (:a 3) (:b 4))
             (with-log (note)
               (plan-value
                 (rpl:partial-order ((:tag b (rpl:wait-time 1) (note :b))
                                     (:tag a (rpl:wait-time 3) (note :a))
                                     (:tag c (note :c)))
                   (:order a b))))))
  (is (equal '((:a 0) (:b 0) (:c 0))
             (with-log (note)
               (plan-value
                 (rpl:plan ((:tag c (note :c)) (:tag b (note :b)) (:tag a (note :a)))
                           ((:order a b :because "it must") (:order b c))))))))

(test partial-order.a-failure-keeps-the-rest-from-starting
  (is (null (with-log (note)
              (plan-failure-of
                (rpl:partial-order ((:tag a (rpl:fail)) (:tag b (note :b))) (:order a b)))))))

(test with-tags.tags-add-no-parallelism
  (is (equal '((:a 1) (:b 2))
             (with-log (note)
               (plan-value (rpl:with-tags (rpl:seq (:tag a (rpl:wait-time 1) (note :a))
                                                   (:tag b (rpl:wait-time 1) (note :b)))))))))

(test task-status.is-a-fluent
  (is (equal '((:running 0) (:succeeded 2))
             (with-log (note)
               (plan-value
                 (rpl:par (:tag worker (rpl:wait-time 2))
                          (rpl:seq (rpl:wait-for (eq (rpl:task-status worker) :running))
                                   (note :running)
                                   (rpl:wait-for (eq (rpl:task-status worker) :succeeded))
                                   (note :succeeded))))))))

(test with-tags.a-second-run-is-another-task
  (let ((tasks '()))
    (plan-value (dotimes (i 2)
                  (:tag again (rpl:wait-time 1))
                  (push again tasks)))
    (is (= 2 (length (remove-duplicates tasks))))
    (is (every #'rpl:task-over-p tasks))))

(test with-task-blocked.waits-still-count
  "A blocked task runs when it is blocked no longer, with all that it consists of."
  (let ((knob (fluent)))
    (is (equal '((:blocked 1) (:unblocked 6) (:a 6) (:b 6))
               (with-log (note)
                 (plan-value
                   (rpl:par (:tag waiters
                              (rpl:par (rpl:seq (rpl:wait-for knob) (note :a))
                                       (rpl:par (rpl:seq (rpl:wait-for knob) (note :b)))))
                            (rpl:seq (rpl:wait-time 1)
                                     (rpl:with-task-blocked waiters
                                       (note :blocked)
                                       (rpl:pulse knob)
                                       (rpl:wait-time 5)
                                       (note :unblocked))))))))))

(test with-task-blocked.ends-however-its-body-ends
  (is (equal '((:worker 3))
             (with-log (note)
               (plan-value
                 (rpl:par (:tag worker (rpl:wait-time 1) (note :worker))
                          (rpl:handle-failure ((t (failure) (return)))
                            (rpl:with-task-blocked worker
                              (rpl:wait-time 3)
                              (rpl:fail)))))))))

(test with-task-blocked.an-evaporating-task-cleans-up
  (is (equal '((:cleaned 2))
             (with-log (note)
               (plan-value
                 (rpl:par (:tag worker (rpl:evap-protect (rpl:wait-time 1) (note :cleaned)))
                          (rpl:with-task-blocked worker
                            (rpl:wait-time 2)
                            (rpl:evaporate worker)
                            (rpl:wait-time 3))))))))

(test with-task-blocked.refuses-to-block-itself
  (is (typep (rpl:lisp-failure-condition
              (plan-failure-of (:tag myself (rpl:with-task-blocked myself (rpl:wait-time 1)))))
             'base:misuse)))

(test evaporate.from-another-branch
  (is (equal '((:rest 2))
             (with-log (note)
               (plan-value (rpl:par (:tag worker (rpl:wait-time 10) (note :worker))
                                    (rpl:seq (rpl:wait-time 2) (rpl:evaporate worker)
                                             (note :rest))))))))

(test evaporate.oneself
  (is (equal '((:before 0))
             (with-log (note)
               (is (eq :other
                       (plan-value
                         (rpl:par (:tag worker (note :before) (rpl:evaporate worker) (note :after))
                                  :other))))))))

(test evaporate.oneself-cleans-up
  "A task that ends itself cleans up before it is gone, also in the step in which it comes to wait."
  (flet ((log-of (body)
           (with-log (note)
             (plan-value
               (rpl:par (:tag worker
                          (rpl:evap-protect
                              (rpl:seq (rpl:wait-time (progn (funcall body worker) 5))
                                       (note :after))
                            (rpl:seq (rpl:wait-time 2) (note :cleaned)))))
               (note :next)))))
    (is (equal '((:after 5) (:cleaned 7) (:next 7)) (log-of #'identity)))
    (is (equal '((:cleaned 2) (:next 2)) (log-of #'rpl:evaporate)))))

;;; Valves.

(test with-valve.one-at-a-time-first-come-first-served
  (let ((hand (rpl:make-valve 'hand)))
    (is (equal '((1 0) (2 3) (3 6))
               (with-log (note)
                 (plan-value (rpl:par-loop (n '(1 2 3))
                               (rpl:with-valve (hand)
                                 (note n)
                                 (rpl:wait-time 3)))))))
    (is (null (rpl:valve-owner hand)))))

(test with-valve.policies-come-first
  (let ((hand (rpl:make-valve 'hand)))
    (is (equal '((:first 0) (:policy 5) (:second 5))
               (with-log (note)
                 (plan-value
                   (rpl:par (rpl:with-valve (hand) (note :first) (rpl:wait-time 5))
                            (rpl:seq (rpl:wait-time 1)
                                     (rpl:with-valve (hand) (note :second)))
                            (rpl:with-policy (rpl:seq (rpl:wait-time 2)
                                                      (rpl:with-valve (hand) (note :policy)))
                              (rpl:wait-time 10)))))))))

(test with-valve.is-given-back-by-failure-and-evaporation
  (let ((hand (rpl:make-valve 'hand)))
    (is (equal '((:third 3))
               (with-log (note)
                 (plan-value
                   (rpl:par (rpl:handle-failure ((t (failure) (return)))
                              (rpl:with-valve (hand) (rpl:wait-time 1) (rpl:fail)))
                            (rpl:pursue (rpl:with-valve (hand) (rpl:wait-time 10))
                                        (rpl:wait-time 3))
                            (rpl:seq (rpl:wait-time 2)
                                     (rpl:with-valve (hand) (note :third))))))))
    (is (null (rpl:valve-owner hand)))))

(test with-valve.a-waiting-task-can-evaporate
  (let ((hand (rpl:make-valve 'hand)))
    (plan-value (rpl:par (rpl:with-valve (hand) (rpl:wait-time 5))
                         (rpl:pursue (rpl:with-valve (hand) (rpl:fail))
                                     (rpl:wait-time 2))))
    (is (null (rpl:valve-requests hand)))))

(test with-valve.parts-of-the-owner-have-it
  (let ((hand (rpl:make-valve 'hand)))
    (is (eq :inner (plan-value (rpl:with-valve (hand)
                                 (rpl:par (rpl:with-valve (hand) :inner))))))))

(test with-valve.a-circle-is-reported-at-once
  (let ((base:*message-queue* (base:make-message-queue))
        (hand (rpl:make-valve 'hand)) (camera (rpl:make-valve 'camera)))
    (is (eq :escaped
            (rpl:run-plan-alone
             (rpl:interp-lambda ()
               (rpl:pursue (rpl:par (rpl:with-valve (hand)
                                      (rpl:wait-time 1)
                                      (rpl:with-valve (camera) 1))
                                    (rpl:with-valve (camera)
                                      (rpl:wait-time 2)
                                      (rpl:with-valve (hand) 1)))
                           (rpl:seq (rpl:wait-time 9) :escaped))))))
    (let ((texts (mapcar #'base:message-text (base:take-messages))))
      (is (= 1 (length texts)))
      (is (search "Deadlock at tick 2" (first texts)))
      (is (search "valve hand" (first texts)))
      (is (search "valve camera" (first texts))))))
