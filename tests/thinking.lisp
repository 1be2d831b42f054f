;;;; thinking.lisp -- thinking costs time: modes, think, with-charge, budgets of steps.

(in-package :ars-magna.tests)

(def-suite* thinking :in ars-magna)

(defparameter *thinking-modes* '(:free :real :charged (:charged :budget 100)))

(defmacro thinking-plan ((mode) &body body)
  "Run BODY as a plan of FITTER where thinking costs what MODE says. Return its value, or failure."
  `(with-fitter (:thinking ,mode)
     (values (run-as-plan ,@body))))

(defun tick-now () (run:simulation-tick))

(defun wrong-argument-text (function)
  "Return what WRONG-ARGUMENT, signalled by FUNCTION, says; NIL if it is not."
  (handler-case (prog1 nil (funcall function))
    (base:wrong-argument (trouble) (princ-to-string trouble))))

;;; Modes.

(test mode.is-what-was-asked-for
  (dolist (mode *thinking-modes*)
    (with-fitter (:thinking mode)
      (is (equal mode (run:simulation-thinking)))))
  (with-fitter (:thinking '(:charged))
    (is (eq :charged (run:simulation-thinking))))
  (with-fitter ()
    (is (eq :free (run:simulation-thinking)))
    (is (equal '(:charged :budget 7) (run:set-thinking '(:charged :budget 7))))
    (is (equal '(:charged :budget 7) (run:simulation-thinking)))
    (run:set-thinking :free)
    (is (eq :free (run:simulation-thinking)))))

(test mode.wrong-ones-say-what-there-is
  (dolist (mode '(nil t 5 :cheap (:charged 5) (:charged :budget) (:charged :budget 0)
                  (:charged :budget 1.5) (:charged :budget -3) (:charged :budget 5 :more 1)
                  (:free)))
    (is (search ":BUDGET steps"
                (wrong-argument-text (lambda () (with-fitter (:thinking mode))))))
    (with-fitter ()
      (is (search "set-thinking" (wrong-argument-text (lambda () (run:set-thinking mode)))))
      (is (eq :free (run:simulation-thinking))))))

(test mode.stands-in-the-journal
  (with-fitter (:thinking '(:charged :budget 9) :journal t)
    (run:run-ticks 3)
    (run:set-thinking :charged)
    (run:run-ticks 2)
    (let ((journal (run:simulation-journal time:*simulation*)))
      (is (equal '(:charged :budget 9) (getf (run:journal-header journal) :thinking)))
      (is (equal '((3 run:set-thinking :charged)) (run:journal-entries journal)))
      (run:with-replay (journal :until 3)
        (is (equal '(:charged :budget 9) (run:simulation-thinking))))
      (run:with-replay (journal)
        (is (eq :charged (run:simulation-thinking)))))))

(test mode.journals-without-one-are-of-free-runs
  (with-fitter (:journal t)
    (run:run-ticks 2)
    (let ((journal (end-journal time:*simulation*)))
      (remf (run:journal-header journal) :thinking)
      (run:with-replay (journal) (is (eq :free (run:simulation-thinking)))))))

(test mode.forged-ones-are-refused
  (uiop:with-temporary-file (:pathname file)
    (with-fitter (:journal t)
      (run:run-ticks 2)
      (let ((journal (end-journal time:*simulation*)))
        (setf (getf (run:journal-header journal) :thinking) '(:charged :budget 0))
        (signals base:misuse (run:write-journal journal file))
        (base:overwrite-file (lambda (out) (run::write-data-lines (run::journal-data journal) out))
                              file "a forged journal")))
    (signals run:damaged-journal (run:load-journal file))))

(test mode.is-state-where-it-costs-ticks
  (flet ((digest (mode) (with-fitter (:thinking mode) (run:state-digest))))
    (is (= (digest :free) (digest :real)))
    (is (= 3 (length (remove-duplicates (mapcar #'digest '(:free :charged (:charged :budget 5)))))))
    (with-fitter (:thinking '(:charged :budget 5))
      (let ((copy (run:fork-simulation time:*simulation*)))
        (is (equal '(:charged :budget 5) (run:simulation-thinking copy)))
        (run:set-thinking :free copy)
        (is (equal '(:charged :budget 5) (run:simulation-thinking)))))))

;;; THINK in plans.

(test think.takes-ticks-only-where-it-is-charged
  (loop for mode in *thinking-modes*
        for ticks in '(0 0 7 7)
        do (is (= ticks (thinking-plan (mode) (rpl:think 7) (tick-now))))
           (is (= ticks (thinking-plan (mode) (rpl:think (rpl:create-fluent 'long 7)) (tick-now)))))
  (is (= 40 (thinking-plan (:charged) (rpl:think 2 :unit :seconds) (tick-now))))
  (is (= 0 (thinking-plan (:charged) (rpl:think 1/2) (tick-now))))
  (is (= 0 (thinking-plan (:charged) (rpl:think 0) (tick-now)))))

(test think.wrong-spans-fail
  (dolist (mode '(:free :charged))
    (dolist (span (list -1 "x" nil (expt 10 20)))
      (is (search "think: span is"
                  (princ-to-string (thinking-plan (mode) (rpl:think span))))))))

(test think.lets-others-go-on
  (is (equal '(4 6)
             (thinking-plan (:charged)
               (let ((ends '()))
                 (rpl:par (rpl:seq (rpl:think 6) (push (tick-now) ends))
                          (rpl:seq (rpl:wait-time 4) (push (tick-now) ends)))
                 (reverse ends))))))

(test think.alone-keeps-all-others-from-going-on
  (is (equal '((:thinker 6) (:policy 6) (:other 6))
             (thinking-plan (:charged)
               (let ((log '()) (bell (rpl:create-fluent 'bell)))
                 (rpl:with-policy (rpl:whenever bell (push (list :policy (tick-now)) log))
                   (rpl:par (rpl:seq (rpl:wait-time 4) (push (list :other (tick-now)) log))
                            (rpl:seq (rpl:think 6 :alone t)
                                     (push (list :thinker (tick-now)) log)
                                     (rpl:pulse bell)
                                     (rpl:wait-time 1))))
                 (sort (reverse log) #'string< :key (lambda (entry)
                                                      (ecase (first entry)
                                                        (:thinker "1") (:policy "2")
                                                        (:other "3")))))))))

(test think.policies-go-on-unless-it-is-alone
  "A policy that stops the robot hears of a bump while the plan thinks, or after that."
  (flet ((heard-at (alone)
           (thinking-plan (:charged)
             (let ((heard nil))
               (rpl:with-policy (rpl:whenever driver:robot-stopped* (setf heard (tick-now)))
                 (driver:rpl-robot-turn .3)
                 (rpl:think 20 :alone alone)
                 (rpl:wait-time 1))
               heard))))
    (is (< 0 (heard-at nil) 10))
    (is (= 20 (heard-at t)))))

(test think.ends-with-its-task
  "Who thinks alone and is killed lets the others go on at once."
  (is (equal '(3 3)
             (thinking-plan (:charged)
               (let ((ends '()))
                 (rpl:handle-failure ((rpl:deadline-missed () (push (tick-now) ends) (return nil)))
                   (rpl:with-deadline (3) (rpl:think 100 :alone t)))
                 (rpl:seq (push (tick-now) ends))
                 ends))))
  (with-fitter (:thinking :charged)
    (let* ((other (driver:begin-plan (rpl:interp-lambda () (rpl:wait-time 2) (tick-now))))
           (thinker (driver:begin-plan (rpl:interp-lambda () (rpl:think 1000 :alone t)))))
      (run:run-ticks 5)
      (is (eq :waiting (rpl:task-state thinker)))
      (is (not (rpl:task-over-p other)))
      (driver:end-plan thinker)
      (is (eq :evaporated (rpl:task-state thinker)))
      (is (= 5 (rpl:task-result other))))))

(test think.can-be-seen-and-deadlocks-nobody
  (with-fitter (:thinking :charged)
    (let ((task (driver:begin-plan (rpl:interp-lambda () (rpl:think 30)))))
      (run:run-ticks 1)
      (is (equal "tick 31" (rpl:awaited-text (rpl:task-awaiting task))))
      (is (not (run:idle-p)))
      (run:run-ticks 30)
      (is (rpl:task-over-p task))
      (is (run:idle-p)))))

;;; WITH-CHARGE.

(defun count-to (n)
  (rpl:interp-lambda ()
    (let ((count 0))
      (rpl:n-times n (rpl:seq (incf count)))
      count)))

(test charge.comes-when-it-is-due
  (loop for mode in (append *thinking-modes* '((:charged :budget 1)))
        for ticks in '(0 0 9 9 9)
        do (destructuring-bind (value tick)
               (thinking-plan (mode)
                 (let ((value (rpl:with-charge (9) (rpl:call-plan (count-to 2000)))))
                   (list value (tick-now))))
             (is (= 2000 value))
             (is (<= ticks tick (+ ticks (if (equal mode '(:charged :budget 1)) 4 0)))))))

(test charge.covers-what-its-body-waits
  (is (= 9 (thinking-plan (:charged) (rpl:with-charge (9) (rpl:wait-time 4)) (tick-now))))
  (is (= 12 (thinking-plan (:charged) (rpl:with-charge (9) (rpl:wait-time 12)) (tick-now))))
  (is (= 12 (thinking-plan (:free) (rpl:with-charge (9) (rpl:wait-time 12)) (tick-now)))))

(test charge.failures-cost-as-much
  (is (equal '(:no-way 9)
             (thinking-plan (:charged)
               (rpl:handle-failure ((:no-way (failure)
                                      (return (list (rpl:failure-class failure) (tick-now)))))
                 (rpl:with-charge (9) (rpl:wait-time 2) (rpl:fail :class :no-way))))))
  (is (= 9 (thinking-plan (:charged)
             (block out (rpl:with-charge (9) (rpl:wait-time 2) (return-from out nil)))
             (tick-now)))))

(test charge.evaporates-at-once
  (is (= 3 (thinking-plan (:charged)
             (rpl:pursue (rpl:with-charge (9 :alone t) nil)
                         (rpl:wait-time 2))
             (rpl:pursue (rpl:with-charge (9) (rpl:wait-time 5)) (rpl:wait-time 1))
             (- (tick-now) 7)))))

;;; Budgets.

(test budget.lets-the-rest-wait
  "A thousand steps and more take ten times as long with a tenth of the steps a tick."
  (flet ((ticks (budget)
           (thinking-plan ((list :charged :budget budget))
             (rpl:call-plan (count-to 1000))
             (tick-now))))
    (let ((ticks (mapcar #'ticks '(10 100 1000 1000000))))
      (is (<= 95 (first ticks) 105))
      (is (<= 9 (second ticks) 11))
      (is (<= 0 (third ticks) 1))
      (is (= 0 (fourth ticks))))))

(test budget.is-of-the-tick-and-not-of-the-reaction
  "Plans begun one by one between two ticks share what there is for all."
  (with-fitter (:thinking '(:charged :budget 10))
    (let ((tasks (loop repeat 5
                       collect (driver:begin-plan (count-to 20))
                       do (driver:end-plan (driver:begin-plan (count-to 20))))))
      (is (notany #'rpl:task-over-p tasks))
      (is (<= 9 (run:run-until (lambda () (and (every #'rpl:task-over-p tasks) (tick-now)))
                               :limit 50)
              25)))))

(test budget.is-fair-to-all-levels
  "A policy that never waits has no more than its share, a step a tick at the least."
  (dolist (budget '(1 2 10 100))
    (is (eq :done
            (thinking-plan ((list :charged :budget budget))
              (let ((turns 0))
                (rpl:with-policy (loop (incf turns) (itself 1))
                  (rpl:call-plan (count-to 20))
                  (if (> turns 5) :done :unfair))))))))

(test budget.a-command-late-in-it-is-given-in-the-next-tick
  (flet ((given-at (mode)
           (with-fitter (:thinking mode :journal t)
             (run-as-plan (rpl:call-plan (count-to 95))
                          (driver:rpl-robot-place)
                          (rpl:wait-for driver:robot-place-input*))
             (first (find 'command:robot-place
                          (run:journal-entries (run:simulation-journal time:*simulation*))
                          :key #'second)))))
    (is (= 0 (given-at :free)))
    (is (<= 9 (given-at '(:charged :budget 10)) 11))))

(test budget.does-not-warn-of-runaways
  (let ((rpl:*runaway-limit* 1000))
    (dolist (mode '(:free (:charged :budget 5000)))
      (with-fitter (:thinking mode)
        (driver:begin-plan (count-to 20000))
        (run:run-ticks 3)
        (is (eq (eq mode :free) (and (search "without waiting" (displayed)) t)))))))

(test budget.changes-while-a-plan-runs
  (with-fitter (:thinking '(:charged :budget 1))
    (let ((task (driver:begin-plan (count-to 1000))))
      (run:run-ticks 10)
      (is (not (rpl:task-over-p task)))
      (run:set-thinking :free)
      (run:run-ticks 1)
      (is (rpl:task-over-p task)))))

(test budget.kills-are-heard-when-it-is-spent
  (with-fitter (:thinking '(:charged :budget 3))
    (let ((task (driver:begin-plan (count-to 1000))))
      (run:run-ticks 10)
      (driver:end-plan task)
      (is (eq :evaporated (rpl:task-state task))))))

(test budget.the-end-of-a-run-cleans-up-all-the-same
  (let ((cleaned 0))
    (with-fitter (:thinking '(:charged :budget 3))
      (driver:begin-plan (rpl:interp-lambda ()
                           (rpl:evap-protect (rpl:call-plan (count-to 1000))
                             (rpl:n-times 50 (rpl:seq (incf cleaned))))))
      (run:run-ticks 10))
    (is (= 50 cleaned))))

;;; What Lisp code charges for.

(test charging.steps-count-against-the-budget
  (loop for (mode ticks) in '((:free 0) (:charged 0) ((:charged :budget 100) 10))
        do (is (= ticks (thinking-plan (mode)
                          (rpl:charge-steps 1000)
                          (rpl:wait-time 0)
                          (tick-now))))))

(test charging.small-steps-add-up
  (is (= 5 (thinking-plan ('(:charged :budget 100))
             (rpl:n-times 50 (rpl:charge-steps 9))
             (rpl:wait-time 0)
             (tick-now)))))

(test charging.ticks-keep-all-plans-still
  (loop for (mode ticks) in '((:free 0) (:charged 12) ((:charged :budget 100) 12))
        do (is (= ticks (thinking-plan (mode)
                          (rpl:par (rpl:seq (rpl:charge-ticks 12) (itself 1))
                                   (rpl:wait-time 0))
                          (tick-now))))))

(test charging.wrong-amounts-are-refused
  (dolist (steps '(-1 1.5 "x" nil)) (signals base:wrong-argument (rpl:charge-steps steps)))
  (dolist (ticks '(-1 "x" nil)) (signals base:wrong-argument (rpl:charge-ticks ticks))))
