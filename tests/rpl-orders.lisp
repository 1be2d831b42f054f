;;;; rpl-orders.lisp -- orders between tasks, deadlines, k of n, task variables, tasks by place.

(in-package :ars-magna.tests)
(in-suite rpl)

;;; Orders.

(test partial-order.its-value-is-that-of-the-last-step
  (is (eq :b (plan-value (rpl:partial-order ((:tag a (rpl:wait-time 2) :a) (:tag b :b))
                           (:order a b)))))
  (is (null (plan-value (rpl:partial-order ())))))

(test partial-order.chain
  (is (equal '((:c 1) (:b 3) (:a 6))
             (with-log (note)
               (plan-value
                 (rpl:partial-order ((:tag a (rpl:wait-time 3) (note :a))
                                     (:tag b (rpl:wait-time 2) (note :b))
                                     (:tag c (rpl:wait-time 1) (note :c)))
                   (:order c b) (:order b a)))))))

(test partial-order.tags-within-steps-and-around
  (is (equal '((:a 2) (:inner 2) (:outer 4) (:b 4))
             (with-log (note)
               (plan-value
                 (rpl:par (rpl:partial-order ((:tag a (rpl:wait-time 2) (note :a))
                                              (rpl:seq (:tag inner (note :inner))
                                                       (rpl:wait-time 5))
                                              (:tag b (note :b)))
                            (:order a inner) (:order outer b))
                          (:tag outer (rpl:wait-time 4) (note :outer)))))))
  (is (equal '((:step 3) (:sibling 3))
             (with-log (note)
               (plan-value
                 (rpl:par (rpl:partial-order ((:tag step (rpl:wait-time 3) (note :step)))
                            (:order step sibling))
                          (:tag sibling (note :sibling))))))))

(test partial-order.tasks-and-fluents-as-values
  (let ((f (fluent)))
    (is (equal '((:pulsed 2) (:a 2) (:b 5))
               (with-log (note)
                 (plan-value
                   (let ((other nil))
                     (rpl:par (:tag first (rpl:wait-time 5))
                              (rpl:seq (setf other first)
                                       (rpl:partial-order ((:tag a (note :a)) (:tag b (note :b)))
                                         (:order f a) (:order (identity other) b)))
                              (rpl:seq (rpl:wait-time 2) (note :pulsed) (rpl:pulse f))))))))
    (is (null (fluents::fluent-first-watcher f)))))

(test partial-order.a-pulse-before-the-start-counts
  (let ((f (fluent)))
    (is (equal '((:inner 3))
               (with-log (note)
                 (plan-value
                   (rpl:partial-order ((rpl:seq (rpl:wait-time 3) (:tag inner (note :inner)))
                                       (rpl:seq (rpl:wait-time 1) (rpl:pulse f)))
                     (:order f inner))))))))

(test partial-order.however-the-earlier-ends
  (is (equal '((:b 1) (:d 2))
             (with-log (note)
               (plan-value
                 (rpl:partial-order ((:tag a (rpl:wait-time 9))
                                     (:tag b (note :b) (rpl:wait-time 1))
                                     (rpl:try-all (:tag c (rpl:wait-time 1) (rpl:fail))
                                                  (rpl:seq (rpl:wait-time 1)
                                                           (rpl:evaporate a)
                                                           (rpl:wait-time 1)))
                                     (:tag d (note :d)))
                   (:order a b) (:order b d) (:order c d)))))))

(test partial-order.the-later-one-is-only-created-until-then
  (is (equal '((:created 0) (:running 2))
             (with-log (note)
               (plan-value
                 (rpl:partial-order ((:tag a (rpl:wait-time 2))
                                     (:tag b (rpl:wait-time 1))
                                     (rpl:seq (note (rpl:fluent-value (rpl:task-status b)))
                                              (rpl:wait-for (eq (rpl:task-status b) :running))
                                              (note (rpl:fluent-value (rpl:task-status b)))))
                   (:order a b)))))))

(test partial-order.orders-are-lifted-when-it-ends
  (is (equal '((:sibling 1) (:given-up 1))
             (with-log (note)
               (plan-value
                 (rpl:par (rpl:seq (rpl:handle-failure ((t () (return)))
                                     (rpl:partial-order ((:tag a (rpl:wait-time 9))
                                                         (rpl:seq (rpl:wait-time 1) (rpl:fail)))
                                       (:order a sibling)))
                                   (note :given-up))
                          (:tag sibling (note :sibling))))))))

(test partial-order.what-has-started-cannot-come-later
  (is (typep (rpl:lisp-failure-condition
              (plan-failure-of
                (rpl:par (:tag sibling (rpl:wait-time 9))
                         (rpl:partial-order ((:tag a 1)) (:order a sibling)))))
             'base:misuse))
  (is (typep (rpl:lisp-failure-condition
              (plan-failure-of (let ((a 3)) (rpl:partial-order ((:tag b 1)) (:order a b)))))
             'base:wrong-argument)))

(test partial-order.circles-are-refused
  (refuses base:malformed-definition
    (rpl:partial-order ((:tag a 1) (:tag b 2) (:tag c 2)) (:order a b) (:order b c) (:order c a)))
  (refuses base:malformed-definition
    (rpl:partial-order ((:tag a (rpl:seq (:tag inner 1) 2))) (:order a inner)))
  (refuses base:malformed-definition
    (rpl:partial-order ((:tag a (:tag inner 1))) (:order inner a)))
  (refuses base:malformed-definition
    (rpl:partial-order ((:tag a (:tag b 1)) (:tag c (:tag d 1))) (:order a d) (:order c b)))
  (refuses base:malformed-definition
    (rpl:par (rpl:partial-order (1) (:order a b) (:order b a)) (:tag a 1) (:tag b 2)))
  (refuses base:malformed-definition (rpl:partial-order ((:tag a 1)) (:order a nobody)))
  (is (eq :ok (plan-value (rpl:partial-order ((:tag a (:tag b 1)) (:tag c (:tag d 1)) :ok)
                            (:order b d))))))

(test partial-order.circles-at-run-time-are-told
  "At once, if it is known who waits for whom, and else when nothing goes on any more."
  (flet ((texts-of (plan)
           (let ((base:*message-queue* (base:make-message-queue)))
             (rpl:run-plan-alone plan)
             (mapcar #'base:message-text (base:take-messages)))))
    (is (equal (list (format nil "Deadlock at tick 1: p waits for the end of q; q waits for the ~
                                  end of p. These tasks can go on only if one of them is ~
                                  ended, for example by a deadline."))
               (texts-of (rpl:interp-lambda ()
                           (rpl:pursue
                            (rpl:partial-order ((:tag p (rpl:wait-time 1) (rpl:join-task q))
                                                (:tag q 1))
                              (:order p q))
                            (rpl:wait-time 9))))))
    (let ((texts (texts-of (rpl:interp-lambda ()
                             (rpl:partial-order
                                 ((:tag p (rpl:wait-for (eq (rpl:task-status q) :succeeded)))
                                  (:tag q 1))
                               (:order p q))))))
      (is (= 1 (length texts)))
      (is (search "waits for the end of p" (first texts))))))

;;; Deadlines.

(test with-deadline.in-time-and-too-late
  (is (eq :done (plan-value (rpl:with-deadline (5) (rpl:wait-time 4) :done))))
  (is (equal '((:cleaned 7) (:late 7))
             (with-log (note)
               (plan-value
                 (rpl:handle-failure ((rpl:deadline-missed (failure)
                                        (note (and (= 5 (rpl:deadline-missed-ticks failure)) :late))
                                        (return)))
                   (rpl:with-deadline (5)
                     (rpl:handle-failure ((t () (note :inside) (return)))
                       (rpl:evap-protect (rpl:wait-time 9)
                         (rpl:seq (rpl:wait-time 2) (note :cleaned))))))))))
  (is (string= "Not done within 1 tick"
               (princ-to-string (plan-failure-of (rpl:with-deadline (1) (rpl:wait-time 2)))))))

(test with-deadline.ends-with-its-body
  (with-runner (runner)
    (rpl:start-plan runner (rpl:interp-lambda ()
                             (block nil (rpl:with-deadline (100) (return)))
                             (rpl:handle-failure ((t () (return)))
                               (rpl:with-deadline (100) (rpl:fail)))
                             (rpl:pursue (rpl:with-deadline (100) (rpl:wait-time 200))
                                         (rpl:seq 1))
                             (rpl:with-deadline (2 :unit :seconds) (rpl:wait-time 7))))
    (rpl:react-to-all runner)
    (is (= 7 (rpl:next-wake-time runner)))
    (rpl:advance-timers runner 7)
    (rpl:react-to-all runner)
    (is (null (rpl:next-wake-time runner))))
  (is (= 40 (plan-value (rpl:handle-failure ((t () (return (rpl:plan-time))))
                          (rpl:with-deadline (2 :unit :seconds) (rpl:wait-time 100))))))
  (is (eq :at-once (plan-value (rpl:with-deadline (0) :at-once))))
  (signals-failure base:wrong-argument (rpl:with-deadline ("soon") 1)))

;;; Some of several.

(test par-at-least.needs-so-many
  (is (equal '((:c :a) 3)
             (plan-value (list (rpl:par-at-least 2 (rpl:seq (rpl:wait-time 3) :a)
                                                 (rpl:seq (rpl:wait-time 9) :b)
                                                 (rpl:seq (rpl:wait-time 1) :c)
                                                 (rpl:seq (rpl:wait-time 2) (rpl:fail)))
                               (rpl:plan-time)))))
  (is (null (plan-value (rpl:par-at-least 0 (rpl:fail)))))
  (is (equal '(1 2) (plan-value (rpl:par-at-least (rpl:seq (rpl:wait-time 1) 2) 1 2)))))

(test par-at-least.fails-when-too-many-have-failed
  (is (equal '((:x :y) 4)
             (plan-value
               (rpl:handle-failure ((rpl:composite-failure (all)
                                      (return (list (mapcar #'rpl:failure-class
                                                            (rpl:composite-failures all))
                                                    (rpl:plan-time)))))
                 (rpl:par-at-least 2 (rpl:seq (rpl:wait-time 4) (rpl:fail :class :y))
                                   (rpl:seq (rpl:wait-time 1) (rpl:fail :class :x))
                                   (rpl:wait-time 9))))))
  (is (eq :left (plan-value (block nil (rpl:par-at-least 1 (rpl:wait-time 1) (return :left))))))
  (signals-failure base:wrong-argument (rpl:par-at-least 3 1 2)))

;;; Task variables.

(rpl:define-task-variable *pace* 1 "How fast.")
(rpl:define-task-variable *mood* :calm)

(defun pace () *pace*)

(test task-variables.bound-for-a-task-and-what-it-starts
  (is (string= "How fast." (documentation '*pace* 'variable)))
  (is (equal '(1 (2 2 3) 2 1)
             (plan-value
               (list (pace)
                     (rpl:with-task-variables ((*pace* (1+ *pace*)) (*mood* :busy))
                       (let ((seen (list (pace))))
                         (rpl:par (rpl:seq (rpl:wait-time 2) (push (pace) seen))
                                  (rpl:with-task-variables ((*pace* 3))
                                    (rpl:wait-time 1)
                                    (push (pace) seen)))
                         (reverse (sort seen #'>))))
                     (rpl:handle-failure ((t () (return (1+ *pace*))))
                       (rpl:with-task-variables ((*mood* 1) (*pace* (rpl:seq (rpl:wait-time 1) 7)))
                         (rpl:wait-time *pace*)
                         (rpl:fail)))
                     *pace*))))
  (is (= 1 *pace*)))

(test task-variables.what-a-task-sets-is-its-own
  (is (equal '(5 6 7 5)
             (plan-value
               (let ((seen '()))
                 (setf *pace* 5)
                 (push *pace* seen)
                 (rpl:par (rpl:seq (setq *pace* 6) (rpl:wait-time 1) (push (pace) seen))
                          (rpl:seq (incf *pace* 2) (rpl:wait-time 2)
                                   (rpl:par (push (pace) seen))))
                 (push (pace) seen)
                 (reverse seen)))))
  (is (= 1 *pace*))
  (unwind-protect (progn (setf *pace* 4)
                         (is (= 4 (plan-value (rpl:seq (rpl:wait-time 1) (pace))))))
    (setf *pace* 1)))

(test task-variables.on-suspension-sees-those-of-its-task
  (is (equal '((2 1))
             (with-log (note)
               (plan-value
                 (rpl:pursue (:tag worker
                               (rpl:with-task-variables ((*pace* 2))
                                 (rpl:on-suspension (note (pace))
                                   (rpl:with-task-variables ((*pace* 3)) (rpl:wait-time 9)))))
                             (rpl:with-task-variables ((*pace* 4))
                               (rpl:wait-time 1)
                               (rpl:with-task-blocked worker 1))))))))

(test task-variables.mistakes
  (refuses base:malformed-definition (rpl:with-task-variables ((speed 1)) 1))
  (refuses base:malformed-definition (let ((*pace* 2)) (rpl:wait-time 1)))
  (refuses base:malformed-definition (rpl:seq (let ((*pace* 2)) (pace)) (rpl:wait-time 1)))
  (refuses base:malformed-definition (dolist (*pace* '(1 2)) (rpl:wait-time 1)))
  (signals base:malformed-definition
    (macroexpand-1 '(rpl:define-task-variable *print-base* 3)))
  (signals base:malformed-definition (macroexpand-1 '(rpl:define-task-variable "speed" 3))))

;;; Tasks by place, and what they run.

(rpl:def-interp-proc errand (task-of)
  (rpl:par (rpl:wait-time 5)
           (:tag approach
             (rpl:par-loop (n '(1 2))
               (:tag look (rpl:seq (rpl:wait-time n) (funcall task-of (rpl:current-task))))))))

(test task-place.there-and-back
  (with-runner (runner)
    (let ((tasks '()))
      (flet ((note (task) (push task tasks)))
        (rpl:start-plan runner 'errand #'note)
        (rpl:start-plan runner (rpl:interp-lambda () (rpl:par 1 (rpl:wait-time 9))))
        (rpl:react-to-all runner)
        (labels ((all (task) (cons task (mapcan #'all (rpl:task-children task)))))
          (let ((all (mapcan #'all (rpl:plan-runner-tasks runner))))
            (is (= 7 (length all)))
            (dolist (task all)
              (let ((place (rpl:task-place task)))
                (is (eq task (rpl:find-task (read-from-string (prin1-to-string place)) runner)))
                (is (eq task (rpl:find-task (rpl:task-serial task) runner)))))))
        (let ((approach (rpl:find-task '(errand (:tag approach)) runner)))
          (is (eq 'approach (rpl:task-name approach)))
          (is (equal '(errand (:tag approach)) (rpl:task-place approach)))
          (is (equal '(errand (:tag approach) (:tag look 1))
                     (rpl:task-place (rpl:find-task '((:tag look 1)) approach))))
          (is (eq (first (rpl:plan-runner-tasks runner)) (rpl:task-top approach)))
          (is (eql 0 (search '(rpl:par-loop) (rpl:task-source approach)))))
        (is (null (rpl:find-task '(errand (:tag nobody)) runner)))
        (is (null (rpl:find-task 4711 runner)))
        (rpl:advance-timers runner 1)
        (rpl:react-to-all runner)
        (is (equal '(errand (:tag approach) (:tag look 0)) (rpl:task-place (first tasks))))))))

(test task-source.of-a-plan-is-its-text
  (with-runner (runner)
    (is (equal '(rpl:def-interp-proc errand (task-of))
               (subseq (rpl:task-source (rpl:start-plan runner 'errand #'list)) 0 3)))
    (is (equal '(rpl:wait-time 1)
               (rpl:task-source (rpl:start-plan runner (rpl:make-plan '(rpl:wait-time 1))))))))

(test plans-as-data.are-for-users
  (dolist (name '("MAKE-PLAN" "CALL-PLAN" "TASK-CHILDREN" "TASK-PARENT" "TASK-FORM" "FIND-PROCEDURE"
                  "FIND-TASK" "TASK-PLACE" "TASK-TOP" "TASK-SOURCE" "PROCEDURE-SOURCE" "SUSPEND"
                  "WAKE-UP" "JOIN-TASK" "VALVE-OWNER" "VALVE-REQUESTS" "VALVE-LOSERS"))
    (let ((symbol (find-symbol name :ars-user)))
      (is (fboundp symbol) "~A" name)
      (is (search "An addition to the manual." (documentation symbol 'function)) "~A" name))))

(test procedure-source.is-the-text
  (is (equal '(rpl:def-interp-proc errand (task-of))
             (subseq (rpl:procedure-source (rpl:find-procedure 'errand)) 0 3)))
  (is (equal '(rpl:interp-lambda (x) (rpl:wait-time x))
             (rpl:procedure-source (rpl:interp-lambda (x) (rpl:wait-time x)))))
  (is (equal '(rpl:interp-lambda () (rpl:seq 1 2))
             (rpl:procedure-source (rpl:make-plan '(rpl:seq 1 2))))))
