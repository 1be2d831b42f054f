;;;; rpl-engine.lisp -- the plan runner: reactions, posts, time, traces, reports.

(in-package :ars-magna.tests)
(in-suite rpl)

(defmacro with-runner ((runner &rest options) &body body)
  "Run BODY with a new plan RUNNER, its messages kept apart."
  `(let ((base:*message-queue* (base:make-message-queue))
         (,runner (rpl:make-plan-runner ,@options)))
     ,@body))

;;; The engine by hand.

(test react.runs-until-nothing-is-ready
  (with-runner (runner)
    (let* ((f (fluent))
           (task (rpl:start-plan runner (rpl:interp-lambda (x)
                                          (rpl:wait-for f)
                                          (list x (rpl:plan-time)))
                                 :argument)))
      (is (eq :ready (rpl:task-state task)))
      (is (not (rpl:runner-idle-p runner)))
      (is (eq :idle (rpl:react-to-all runner)))
      (is (eq :waiting (rpl:task-state task)))
      (is (rpl:runner-idle-p runner))
      (is (equal (list task) (rpl:plan-runner-tasks runner)))
      (rpl:post-entry runner `((:set ,f :go)))
      (is (not (rpl:runner-idle-p runner)))
      (is (rpl:apply-next-batch runner))
      (is (not (rpl:apply-next-batch runner)))
      (rpl:react-to-all runner)
      (is (eq :succeeded (rpl:task-state task)))
      (is (equal '(:argument 0) (rpl:task-result task)))
      (is (null (rpl:plan-runner-tasks runner))))))

(test react.a-command-and-a-wait-cannot-miss-the-pulse
  "Posts are applied between reactions, when the task has reached its wait."
  (with-runner (runner)
    (let* ((moved (fluent)) (heard 0)
           (command (lambda () (rpl:post-entry runner `((:pulse ,moved))))))
      (rpl:start-plan runner (rpl:interp-lambda ()
                               (rpl:n-times 300
                                 (funcall command)
                                 (rpl:wait-for moved)
                                 (incf heard))))
      (loop do (rpl:react-to-all runner) while (rpl:apply-next-batch runner))
      (is (= 300 heard)))))

(test advance-timers.wakes-those-due-in-order
  (with-runner (runner)
    (let ((order '()))
      (rpl:start-plan runner (rpl:interp-lambda ()
                               (rpl:par-loop (ticks '(5 2 9 2 5))
                                 (rpl:wait-time ticks)
                                 (push (list ticks (rpl:plan-time)) order))))
      (rpl:react-to-all runner)
      (is (= 2 (rpl:next-wake-time runner)))
      (rpl:advance-timers runner 6)
      (rpl:react-to-all runner)
      (is (equal '((2 6) (2 6) (5 6) (5 6)) (reverse order)))
      (is (= 9 (rpl:next-wake-time runner)))
      (rpl:advance-timers runner 9)
      (rpl:react-to-all runner)
      (is (null (rpl:next-wake-time runner)))
      (is (equal '(9 9) (first order))))))

(test wait-time.in-seconds
  (is (= 50 (rpl:run-plan-alone (rpl:interp-lambda ()
                                  (rpl:wait-time 5 :unit :seconds)
                                  (rpl:plan-time))
                                :runner (rpl:make-plan-runner :ticks-per-second 10)))))

(test timers.cancelled-ones-leave-at-once
  (with-runner (runner)
    (let ((f (fluent)))
      (rpl:start-plan runner (rpl:interp-lambda ()
                               (rpl:n-times 50
                                 (rpl:par (rpl:wait-for f :timeout 1000)
                                          (rpl:pulse f)
                                          (rpl:pursue (rpl:wait-time 500) nil)))
                               (rpl:wait-time 7)))
      (rpl:react-to-all runner)
      (is (= 7 (rpl:next-wake-time runner))))))

(test timers.heap-agrees-with-sorting
  (let ((dice (base:make-dice 3)) (timers (tasks::make-timers)) (live '()) (called '()))
    (dotimes (i 500)
      (push (tasks::set-timer timers (base:roll-index 100 dice)
                            (lambda (timer) (push timer called)) i)
            live)
      (when (base:chance .4 dice)
        (let ((victim (base:roll-element live dice)))
          (setf live (remove victim live))
          (tasks::cancel-timer victim timers))))
    (tasks::run-timers timers 60)
    (is (equal (mapcar #'tasks::timer-client
                       (stable-sort (remove-if (lambda (timer) (> (tasks::timer-due timer) 60))
                                               (reverse live))
                                    #'< :key #'tasks::timer-due))
               (mapcar #'tasks::timer-client (reverse called))))))

;;; Posting from threads.

(test post.from-many-threads-loses-nothing
  (with-runner (runner)
    (let* ((posts 500)
           (fluents (loop repeat 4 collect (fluent)))
           (heard (make-list 4 :initial-element 0))
           (posted (base:make-semaphore "posted"))
           (threads (loop for f in fluents
                          collect (let ((f f))
                                    (base:start-thread
                                     (lambda ()
                                       (dotimes (i posts)
                                         (rpl:post-entry runner `((:set ,f ,(1+ i))))
                                         (base:signal-semaphore posted)))
                                     "poster")))))
      (rpl:start-plan runner (rpl:interp-lambda ()
                               (rpl:par-loop (index '(0 1 2 3))
                                 (let ((f (nth index fluents)))
                                   (loop until (= posts (nth index heard))
                                         (rpl:wait-for (> f (nth index heard)))
                                         (setf (nth index heard) (rpl:fluent-value f)))))))
      (mapc (lambda (f) (rpl:set-value f 0)) fluents)
      (rpl:react-to-all runner)
      (loop repeat (* 4 posts)
            do (base:wait-on-semaphore posted)
               (rpl:apply-next-batch runner)
               (rpl:react-to-all runner))
      (mapc #'base:join-thread threads)
      (is (equal (list posts posts posts posts) heard))
      (is (null (rpl:plan-runner-tasks runner))))))

(test post.keeps-the-order-of-posting
  (with-runner (runner)
    (let ((f (fluent)) (seen '()))
      (dotimes (i 10) (rpl:post-entry runner `((:set ,f ,i))))
      (loop while (rpl:apply-next-batch runner) do (push (rpl:fluent-value f) seen))
      (is (equal '(0 1 2 3 4 5 6 7 8 9) (reverse seen))))))

(test post.trouble-in-it-becomes-a-message
  (with-runner (runner)
    (rpl:post-entry runner '((:set 3 4)))
    (rpl:post-entry runner (lambda () (error "oops")))
    (is (rpl:apply-next-batch runner))
    (is (rpl:apply-next-batch runner))
    (is (= 2 (length (base:take-messages))))))

(test stop-plan.evaporates-from-outside
  (with-runner (runner)
    (let* ((cleaned nil)
           (task (rpl:start-plan runner (rpl:interp-lambda ()
                                          (rpl:evap-protect (rpl:par (rpl:wait-time 9)
                                                                     (rpl:wait-time 7))
                                                            (setf cleaned t))))))
      (rpl:react-to-all runner)
      (rpl:stop-plan runner)
      (rpl:apply-next-batch runner)
      (rpl:react-to-all runner)
      (is (eq :evaporated (rpl:task-state task)))
      (is (not (null cleaned)))
      (is (null (rpl:next-wake-time runner))))))

;;; Budgets, runaways, slow code.

(test react.a-budget-lets-time-pass-while-a-plan-thinks
  (let ((runner (rpl:make-plan-runner :budget 100)))
    (multiple-value-bind (ticks state)
        (rpl:run-plan-alone (rpl:interp-lambda ()
                              (let ((n 0)) (loop until (= n 1000) (incf n)))
                              (rpl:plan-time))
                            :runner runner)
      (is (eq :succeeded state))
      (is (<= 10 ticks 40)))))

(test react.a-plan-that-never-waits-is-reported-once-and-time-passes
  (let ((rpl:*runaway-limit* 1000))
    (let ((texts (reported
                   (is (eq :limit
                           (nth-value 1 (rpl:run-plan-alone (rpl:interp-lambda () (loop (itself 3)))
                                                            :limit 5)))))))
      (is (= 1 (length texts)))
      (is (search "without waiting" (first texts)))
      (is (search "(itself 3)" (first texts))))))

(test react.slow-lisp-code-is-named
  (let* ((now 0)
         (clock (lambda () (incf now 1/100)))
         (texts (reported
                  (rpl:run-plan-alone (rpl:interp-lambda ()
                                        (itself 1)
                                        (incf now 3)
                                        (itself 2))
                                      :runner (rpl:make-plan-runner :clock clock)))))
    (is (= 1 (length texts)))
    (is (search "(incf now 3)" (first texts)))))

(test task.a-leaf-error-in-the-debugger-when-asked
  (let ((base:*break-on-user-error* t) (entered nil))
    (let ((sb-ext:*invoke-debugger-hook*
            (lambda (condition hook)
              (declare (ignore hook))
              (setf entered (type-of condition))
              (throw 'seen nil))))
      (catch 'seen
        (plan-outcome (itself 1) (error 'division-by-zero))))
    (is (eq 'division-by-zero entered))))

;;; Reports.

(test deadlock.is-reported-with-tasks-forms-and-fluents
  (let ((text (first (reported
                       (rpl:run-plan-alone
                        (rpl:interp-lambda ()
                          (let ((f (fluent nil 'robot-stopped*)) (g (fluent nil 'arrived*)))
                            (rpl:par (rpl:wait-for (and f g))
                                     (rpl:seq (rpl:wait-time 2)
                                              (rpl:whenever g (rpl:fail)))))))))))
    (is (search "Deadlock at tick 2" text))
    (is (search "waits for (and robot-stopped* arrived*)" text))
    (is (search "waits for arrived*" text))
    (is (search "(par" text))))

(test plan-deadlocked-p.not-while-something-may-still-come
  (let ((busy t))
    (with-runner (runner :busy-p (lambda () busy))
      (let ((f (fluent)))
        (is (not (rpl:plan-deadlocked-p runner)))
        (rpl:start-plan runner (rpl:interp-lambda () (rpl:wait-for f :timeout 5) (rpl:wait-for f)))
        (is (not (rpl:plan-deadlocked-p runner)))
        (rpl:react-to-all runner)
        (is (not (rpl:plan-deadlocked-p runner)))
        (rpl:advance-timers runner 5)
        (rpl:react-to-all runner)
        (is (not (rpl:plan-deadlocked-p runner)))
        (setf busy nil)
        (is (not (not (rpl:plan-deadlocked-p runner))))))))

(test print-tasks.shows-the-tree
  (with-runner (runner)
    (let ((f (fluent nil 'door-open)))
      (rpl:start-plan runner (rpl:interp-lambda ()
                               (rpl:par (:tag door-watch (rpl:wait-for f))
                                        (rpl:wait-time 4))))
      (rpl:react-to-all runner)
      (let ((lines (with-output-to-string (stream) (rpl:print-tasks runner stream))))
        (is (= 3 (count #\Newline lines)))
        (is (search "  2 waiting: door-watch (wait-for f) waits for door-open" lines))
        (is (search "  3 waiting: (wait-time 4) waits for tick 4" lines))
        (let ((task (first (rpl:task-children (first (rpl:plan-runner-tasks runner))))))
          (is (eq 'door-watch (rpl:task-name task)))
          (is (= 2 (rpl:task-serial task)))
          (is (equal "door-open" (rpl:task-awaits task)))
          (is (equal '(rpl:wait-for f) (rpl:task-form task))))))))

;;; Traces.

(rpl:def-interp-proc traced-plan ()
  (let ((f (rpl:create-fluent 'f)))
    (rpl:handle-failure ((t () (return)))
      (rpl:par (rpl:wait-for f)
               (rpl:pursue (rpl:wait-time 9) (rpl:wait-time 2))
               (rpl:seq (rpl:wait-time 3) (rpl:fail :class :enough))))))

(defun trace-of (plan)
  (let ((runner (rpl:make-plan-runner :trace t)))
    (rpl:run-plan-alone plan :runner runner)
    (rpl:plan-trace runner)))

(test trace.says-what-happened-when
  (let ((trace (trace-of 'traced-plan)))
    (is (equal '((0 :start 1) (0 :start 2) (0 :start 3) (0 :start 4) (0 :wait 1)
                 (0 :wait 2) (0 :start 5) (0 :start 6) (0 :wait 3) (0 :wait 4) (0 :wait 5)
                 (0 :wait 6) (2 :wake 6) (2 :succeed 6) (2 :evaporate 5) (2 :succeed 3)
                 (3 :wake 4) (3 :failure 4) (3 :fail 4) (3 :evaporate 2) (3 :succeed 1))
               (map 'list (lambda (entry)
                            (list (rpl:trace-entry-tick entry) (rpl:trace-entry-event entry)
                                  (rpl:trace-entry-task entry)))
                    trace)))
    (is (find "f" trace :key #'rpl:trace-entry-detail :test #'equal))))

(test trace.is-the-same-on-every-replay
  (flet ((text ()
           (with-output-to-string (stream) (rpl:write-trace (trace-of 'traced-plan) stream))))
    (is (string= (text) (text)))))

(test trace.is-written-to-a-file
  (uiop:with-temporary-file (:pathname path)
    (rpl:write-trace (trace-of 'traced-plan) path)
    (is (= 21 (length (uiop:read-file-lines path))))))
