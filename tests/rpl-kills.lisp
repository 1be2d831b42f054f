;;;; rpl-kills.lisp -- random plans killed at random moments in random ways leave nothing behind.

(in-package :ars-magna.tests)
(in-suite rpl)

;;; A plan here has the parameters f g h (fluents) and v w (valves). Its cleanups end by themselves
;;; within some ticks, so all of it must have ended some time after it has been killed.

(defun random-cleanup (depth dice)
  "Return a random form that ends within some ticks."
  (flet ((part () (random-cleanup (1- depth) dice))
         (span () (base:roll-index 5 dice))
         (fluent () (base:roll-element '(f g h) dice)))
    (if (plusp depth)
        (ecase (base:roll-index 9 dice)
          (0 `(rpl:par ,(part) ,(part)))
          (1 `(rpl:pursue ,(part) ,(part)))
          (2 `(rpl:seq ,(part) ,(part)))
          (3 `(rpl:evap-protect ,(part) ,(part)))
          (4 `(rpl:handle-failure ((t () ,(part) (return))) ,(part)))
          (5 `(rpl:with-tags (rpl:par (:tag sub ,(part))
                                      (rpl:with-task-blocked sub ,(part)))))
          (6 `(rpl:with-policy (rpl:whenever ,(fluent) (rpl:pulse ,(fluent))) ,(part)))
          (7 `(rpl:n-times ,(span) ,(part)))
          (8 `(block nil ,(part) (return) ,(part))))
        (ecase (base:roll-index 8 dice)
          ((0 1) `(rpl:wait-time ,(span)))
          (2 `(rpl:wait-for ,(fluent) :timeout ,(span)))
          (3 `(rpl:pulse ,(fluent)))
          (4 `(rpl:set-value ,(fluent) (not (rpl:fluent-value ,(fluent)))))
          (5 '(rpl:fail :class :in-cleanup))
          (6 '(car 3))
          (7 '(abort))))))

(defun random-body (depth dice)
  "Return a random form, which need not end."
  (flet ((part () (random-body (1- depth) dice))
         (cleanup () (random-cleanup 2 dice))
         (span () (base:roll-index 6 dice))
         (fluent () (base:roll-element '(f g h) dice))
         (valve () (base:roll-element '(v w) dice)))
    (if (plusp depth)
        (ecase (base:roll-index 19 dice)
          (0 `(rpl:par ,(part) ,(part) ,(part)))
          (1 `(rpl:pursue ,(part) ,(part)))
          (2 `(rpl:try-all ,(part) ,(part)))
          (3 `(rpl:with-policy (rpl:whenever ,(fluent) ,(part)) ,(part)))
          (4 `(rpl:with-valve (,(valve)) ,(part) ,(part)))
          (5 `(rpl:handle-failure ((t () ,(part) (return))) ,(part)))
          ((6 7 8) `(rpl:evap-protect ,(part) ,(cleanup)))
          (9 `(rpl:n-times ,(span) ,(part)))
          (10 `(rpl:par-loop (item '(1 2 3)) ,(part)))
          (11 `(rpl:with-tags (rpl:par (:tag part ,(part))
                                       (rpl:seq (rpl:wait-time ,(span))
                                                (rpl:with-task-blocked part ,(part))))))
          (12 `(rpl:with-tags (rpl:par (:tag part ,(part))
                                       (rpl:seq (rpl:wait-time ,(span)) (rpl:evaporate part)
                                                ,(part)))))
          (13 `(rpl:with-tags
                 (rpl:par (:tag part (rpl:evap-protect ,(part) ,(cleanup)))
                          (rpl:with-task-blocked part
                            (rpl:evap-protect
                             ,(part)
                             (rpl:wait-for (rpl:fl-funcall #'member (rpl:task-status part)
                                                           '(:evaporated :succeeded :failed))
                                           :timeout 40))))))
          (14 `(block nil (rpl:par ,(part) (rpl:seq (rpl:wait-time ,(span)) (return)))))
          (15 `(rpl:try-in-order ,(part) ,(part)))
          (16 `(rpl:seq (rpl:wait-for (and ,(fluent) (not ,(fluent))) :timeout ,(span)) ,(part)))
          (17 `(rpl:partial-order ((:tag one ,(part)) (:tag two ,(part))) (:order one two)))
          (18 `(labels ((again (n) (when (plusp n) (rpl:seq ,(part) (again (1- n))))))
                 (again ,(span)))))
        (ecase (base:roll-index 9 dice)
          (0 `(rpl:pulse ,(fluent)))
          (1 `(rpl:set-value ,(fluent) (not (rpl:fluent-value ,(fluent)))))
          ((2 3) `(rpl:wait-for ,(fluent)))
          ((4 5) `(rpl:wait-time ,(span)))
          (6 '(rpl:fail))
          (7 '(car 3))
          (8 '(throw :out nil))))))

(defun plan-with-parameters (form)
  (base:evaluate-form `(rpl:interp-lambda (f g h v w) (list f g h v w) ,form)))

;;; Doing it harm.

(defun all-parts (task)
  (cons task (mapcan #'all-parts (rpl:task-children task))))

(defun harm (runner fluents dice)
  "Do something to the plans of RUNNER from outside."
  (let ((parts (mapcan #'all-parts (rpl:plan-runner-tasks runner))))
    (ecase (base:roll-index 8 dice)
      ((0 1 2))
      (3 (rpl:set-value (base:roll-element fluents dice) (base:chance .5 dice)))
      (4 (rpl:pulse (base:roll-element fluents dice)))
      (5 (rpl:post-entry runner `((:pulse ,(base:roll-element fluents dice)))))
      ((6 7) (when (and parts (base:chance .3 dice))
               (rpl:stop-plan runner (base:roll-element parts dice)))))))

(defun let-time-pass (runner tick)
  (catch :out
    (rpl:advance-timers runner tick)
    (rpl:react-to-all runner))
  (rpl:react-to-all runner))

(defun run-and-kill (plan dice &optional (agents 1))
  "Run PLAN, with each of AGENTS agents of a runner, harm it and kill it at random. Return what is
left of it, NIL if nothing is."
  (let* ((fluents (list (fluent nil 'f) (fluent nil 'g) (fluent nil 'h)))
         (valves (list (rpl:make-valve 'v) (rpl:make-valve 'w)))
         (base:*message-queue* (base:make-message-queue))
         (rpl:*runaway-limit* 2000)
         (base:*echo-output* (make-broadcast-stream))
         (runner (rpl:make-plan-runner :on-end #'identity))
         (end (base:roll-index 15 dice))
         (close (base:chance .2 dice)))
    (dolist (agent (if (= 1 agents) (list runner) (add-agents agents runner)))
      (apply #'rpl:start-plan agent plan (append fluents valves)))
    (loop for tick from 0 to end
          do (let-time-pass runner tick)
             (harm runner fluents dice))
    (if close (rpl:close-runner runner) (rpl:stop-plan runner))
    (loop for tick from (1+ end) repeat (if close 0 400)
          while (rpl:plan-runner-tasks runner)
          do (let-time-pass runner tick))
    (rpl:react-to-all runner)
    (remove nil (list (rpl:plan-runner-tasks runner)
                      (rpl:next-wake-time runner)
                      (find-if #'fluents::fluent-first-watcher fluents)
                      (find-if #'fluents::fluent-first-link fluents)
                      (find-if #'rpl:valve-owner valves)
                      (find-if #'constructs::valve-requests valves)
                      (plusp (rpl:runner-blocks runner))
                      (and (not (rpl:runner-idle-p runner)) :ready)))))

(defun add-agents (count runner)
  "Return a list of COUNT new agents of RUNNER, whose clients are the numbers from 0."
  (loop for client below count
        collect (rpl:add-agent runner (rpl:make-agent :client client))))

(defun trouble-with-kills (plans kills seed &optional (agents 1))
  "Return a list of (form seed left) for what was left of random PLANS, each killed KILLS times."
  (let ((dice (base:make-dice seed "kills")) (troubles '()))
    (dotimes (i plans troubles)
      (let* ((form (random-body 4 dice))
             (plan (plan-with-parameters form)))
        (dotimes (kill kills)
          (let* ((seed (base:roll-index 1000000 dice))
                 (left (run-and-kill plan (base:make-dice seed "one kill") agents)))
            (when left (push (list form seed left) troubles))))))))

(test kills.whatever-is-killed-ends-and-leaves-nothing
  (is (null (trouble-with-kills 150 10 1992))))
