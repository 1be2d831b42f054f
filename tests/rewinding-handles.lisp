;;;; rewinding-handles.lisp -- users' references to objects of a rewound run remain usable.

(in-package :ars-magna.tests)
(in-suite rewinding)

(rpl:def-interp-proc count-for-ever (fluent)
  (loop (rpl:wait-time 1)
        (rpl:set-value fluent (1+ (rpl:fluent-value fluent)))))

(defmacro counting-run ((fluent task &rest options) &body body)
  "Run BODY after 20 ticks in which TASK has counted in FLUENT."
  `(with-rover (:seed 1 :keep t ,@options)
     (let* ((,fluent (rpl:create-fluent 'count 0))
            (,task (driver:begin-plan 'count-for-ever ,fluent)))
       (declare (ignorable ,task))
       (run:run-ticks 20)
       ,@body)))

(test rewind.tasks-have-counterparts
  (counting-run (count task)
    (run:rewind 10)
    (is (eq :evaporated (rpl:task-state task)))
    (is (eq (run:counterpart task) (first (driver:plans))))
    (is (eq rover (run:counterpart rover)))
    (run:rewind 5)
    (is (eq (run:counterpart task) (first (driver:plans))))
    (run:run-ticks 5)
    (is (= 9 (rpl:fluent-value (run:counterpart count))))
    (run:rewind (tick-of-run))
    (is (null (run:counterpart task))))
  (with-rover ()
    (is-trouble ("a run that was rewound") (run:counterpart rover))))

(test rewind.keeps-a-trace-that-was-wanted-then
  "A trace that *TRACE-PLANS*, bound around the start of plans, asked for is kept again."
  (with-rover (:seed 1 :keep t)
    (let ((driver:*trace-plans* t))
      (driver:begin-plan 'count-for-ever (rpl:create-fluent 'count 0)))
    (run:run-ticks 20)
    (flet ((events () (length (rpl:trace-of (first (driver:plans))))))
      (let ((before (events)))
        (run:rewind 10)
        (is (< 1 (events) before))
        (run:run-ticks 10)
        (is (= before (events)))))))

(test rewind.tasks-can-be-spoken-to
  "SUSPEND, WAKE-UP, EVAPORATE and END-PLAN mean what a task has become."
  (counting-run (count task)
    (run:rewind 10)
    (flet ((count-after (ticks)
             (run:run-ticks ticks)
             (rpl:fluent-value (run:counterpart count))))
      (is (= 9 (count-after 0)))
      (is (eq (run:counterpart task) (rpl:suspend task)))
      (is (= 10 (count-after 5)))
      (rpl:wake-up task)
      (is (< 10 (count-after 5))))
    (run:rewind 3)
    (driver:end-plan task)
    (is (null (driver:plans)))
    (run:rewind 5)
    (is (= 1 (length (driver:plans))))
    (rpl:evaporate task)
    (run:run-ticks 1)
    (is (null (driver:plans)))))

(defmacro is-stale (task)
  "Check that no word to TASK is taken for one to another task."
  `(progn (is (null (run:counterpart ,task)))
          (is-trouble ("was rewound" "(plans)") (driver:end-plan ,task))
          (is-trouble ("count-for-ever") (rpl:suspend ,task))
          (is (= 1 (length (driver:plans))) "nobody else has ended")))

(test rewind.tasks-that-have-not-begun-are-no-others
  "Not even if one of the same number has begun since."
  (counting-run (count task)
    (let ((late (driver:begin-plan 'count-for-ever (rpl:create-fluent 'late 0))))
      (run:run-ticks 5)
      (run:rewind 10)
      (is (= 1 (length (driver:plans))))
      (is-stale late)
      (driver:end-plan task)
      (let ((other (driver:begin-plan 'count-for-ever (rpl:create-fluent 'other 0))))
        (is (= (rpl:task-serial late) (rpl:task-serial other)))
        (run:run-ticks 5)
        (is-stale late)
        (is (null (driver:end-plan task)) "it is over: nothing happens")
        (run:rewind 2)
        (is-stale late)
        (is (eq (run:counterpart other) (first (driver:plans))))
        (driver:end-plan other)
        (is (null (driver:plans)))))))

(test rewind.tasks-of-plans-begun-anew-are-no-others
  (counting-run (count task)
    (run:rewind 10)
    (driver:rpl-init-robot rover)
    (let ((other (driver:begin-plan 'count-for-ever (rpl:create-fluent 'other 0))))
      (run:run-ticks 5)
      (is (null (run:counterpart task)))
      (is (null (driver:end-plan task)) "it is over: nothing happens")
      (run:rewind 2)
      (is (null (run:counterpart task)))
      (is (eq (run:counterpart other) (first (driver:plans)))))))

(test rewind.tasks-of-plans-that-were-begun-anew-are-found-again
  "Also where RPL-INIT-ROBOT is done again, and where the run goes back to before it."
  (counting-run (count task)
    (driver:rpl-init-robot rover)
    (let ((other (driver:begin-plan 'count-for-ever (rpl:create-fluent 'other 0))))
      (run:run-ticks 10)
      (run:rewind 3)
      (is (eq (run:counterpart other) (first (driver:plans))))
      (is (null (run:counterpart task)))
      (run:rewind 12)
      (is-stale other)
      (is (eq (run:counterpart task) (first (driver:plans)))))))

(test rewind.forks-stand-for-what-they-became
  (with-rover (:seed 1)
    (run:run-ticks 3)
    (let ((fork (run:fork-simulation)))
      (run:call-in-fork fork (lambda ()
                               (run:keep-forks)
                               (run:run-ticks 10)
                               (run:rewind 6)))
      (is (= 7 (run:call-in-fork fork #'tick-of-run)))
      (is (= 9 (run:call-in-fork fork (lambda () (run:run-ticks 2)))))
      (is (not (eq rover (run:counterpart rover fork))))
      (run:release-fork fork)
      (is-trouble ("released") (run:call-in-fork fork (lambda () (run:run-ticks 1)))))))

(test rewind.words-in-a-fork-are-for-its-own-tasks
  (counting-run (count task)
    (run:with-fork ()
      (rpl:suspend task)
      (run:run-ticks 10)
      (is (= 20 (rpl:fluent-value count))))
    (run:run-ticks 10)
    (is (= 29 (rpl:fluent-value count)))))

(test rewind.commands-of-plans-from-outside-are-heard-again
  (counting-run (count task)
    (driver:rpl-robot-turn 1)
    (run:run-ticks 3)
    (run:rewind 1)
    (run:run-ticks 20)
    (is (< 0.9 (rpl:fluent-value driver:robot-angle-diff*) 1.1))))

(test rewind.nothing-leads-back
  "Of many runs that were rewound none can be reached but the first and the last; garbage collectors
that look at the stack may leave some."
  (counting-run (count task)
    (keeping-often
      (let ((runs '()))
        (loop repeat 20
              do (push (sb-ext:make-weak-pointer time:*simulation*) runs)
                 (run:run-ticks 3)
                 (run:rewind 3))
        (sb-ext:gc :full t)
        (is (> 5 (count-if #'sb-ext:weak-pointer-value runs)))))))

;;; Texts.

(test rewind.says-what-to-do-instead
  (with-rover (:keep t)
    (run:run-ticks 3)
    (is-trouble ("at most 3") (run:rewind (expt 10 30))))
  (keeping-often
    (live-rover (:rate 500)
      (let ((text nil))
        (command:robot-turn rover 0.1 (lambda (&rest ignored)
                                        (declare (ignore ignored))
                                        (setf text (trouble-of (lambda () (run:rewind 1))))))
        (awaiting text)
        (is-true (has-words-p text "this thread passes the ticks" "REPL") "~A" text)))))

(test rewind.is-misuse-in-the-thread-of-any-clock
  "Else two clocks may wait for one another."
  (let ((other (run:fresh-simulation '(fitter))) (text nil))
    (run:start-clock other :rate 500)
    (unwind-protect
         (live-rover (:rate 500)
           (command:robot-turn rover 0.1
                               (lambda (&rest ignored)
                                 (declare (ignore ignored))
                                 (setf text (trouble-of (lambda () (run:rewind 1 other))))))
           (awaiting text)
           (is-true (has-words-p text "passes the ticks of arena"
                                 "Rewind workbench at the prompt")
                    "~A" text))
      (run:stop-clock other))))

;;; Kept forks of runs whose plans never rest.

(rpl:def-interp-proc never-rest ()
  (let ((sum 0))
    (loop (setf sum (mod (1+ sum) 7)))))

(test keep-forks.get-theirs-from-plans-that-never-rest
  (keeping-often
    (live-rover (:rate 100 :thinking :real)
      (driver:rpl-init-robot rover)
      (command:robot-turn rover 900)
      (driver:begin-plan 'never-rest)
      (awaiting (< 1 (length (kept-ticks))))
      (is (< 1 (length (kept-ticks))))
      (driver:end-plan :all)
      (awaiting (null (driver:plans))))))

;;; Programs that are told of it.

(test rewind.goes-on-wherever-a-continuation-throws
  (run:with-simulation (ars-worlds:dot :seed 1 :keep t)
    (command:robot-turn ars-worlds:dot 2 (lambda (&rest results)
                                           (declare (ignore results))
                                           (throw 'elsewhere :thrown)))
    (run:run-ticks 4)
    (is (eq :thrown (catch 'elsewhere (run:rewind 2))))
    (run:run-ticks 1)
    (is (= 3 (run:simulation-tick)))))

(test rewind.tells-of-errors-in-continuations
  (run:with-simulation (ars-worlds:dot :seed 1 :keep t)
    (command:robot-turn ars-worlds:dot 2 (lambda (&rest results)
                                           (declare (ignore results))
                                           (error "of my own")))
    (run:run-ticks 4)
    (run:rewind 2)
    (is (= 1 (count :error (base:take-messages) :key #'base:message-kind)))))

;;; A live run's plans react in their thread, perhaps after a fork of that tick has been kept.

(rpl:def-interp-proc turn-when-told (fluent)
  (rpl:wait-for fluent)
  (driver:rpl-robot-turn 1)
  (rpl:wait-for driver:robot-stopped*))

(test rewind.lets-plans-react-that-had-not-reacted-when-the-fork-was-kept
  (with-rover (:seed 1 :keep t :thinking :real)
    (let ((told (rpl:create-fluent 'told)) (digests '()))
      (driver:begin-plan 'turn-when-told told)
      (run:run-ticks 3)
      (rpl:set-value told t)
      (run::keep-fork time:*simulation* (run::simulation-past time:*simulation*))
      ;; The plans' thread would do this now.
      (let ((interface (driver::usable-interface)))
        (driver::with-plans (interface) (driver::react-fully interface)))
      (loop repeat 5 do (run:run-ticks 1) (push (run:state-digest) digests))
      (base:take-messages)
      (run:rewind 1)
      (is (= (second digests) (run:state-digest)))
      (is (null (base:take-messages))))))
