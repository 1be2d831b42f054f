;;;; rpl-agents.lisp -- several agents in one plan runner: turns, budgets, endings, forks.

(in-package :ars-magna.tests)

(def-suite* rpl-agents :in ars-magna)

(defmacro with-agents ((runner &rest agents) &body body)
  "Run BODY with a new RUNNER and variables bound to its new AGENTS, its messages kept apart."
  `(with-runner (,runner :on-end #'identity)
     (destructuring-bind ,agents (add-agents ,(length agents) ,runner)
       (declare (ignorable ,@agents))
       ,@body)))

(defmacro begin-on ((agent) &body body)
  "Start a plan of AGENT with BODY, and return its task."
  `(rpl:start-plan ,agent (rpl:interp-lambda () ,@body)))

(defun react-at (tick runner)
  (rpl:advance-timers runner tick)
  (rpl:react-to-all runner))

;;; Agents and their tasks.

(test agents.a-runner-makes-one-when-it-needs-one
  (let ((runner (rpl:make-plan-runner :client :me)))
    (is (null (rpl:runner-agents runner)))
    (let ((agent (rpl:runner-agent runner)))
      (is (eq :me (rpl:agent-client agent)))
      (is (eq agent (rpl:runner-agent runner)))
      (is (eq agent (rpl:task-agent (begin-on (runner) 1)))))))

(test agents.parts-belong-to-the-agent-of-the-whole
  (with-agents (runner a b)
    (let* ((seen '())
           (look (lambda () (push (rpl:task-agent (rpl:current-task)) seen))))
      (begin-on (b) (rpl:par (funcall look) (rpl:with-policy (rpl:wait-time 9) (funcall look))))
      (rpl:react-to-all runner)
      (is (equal (list b b) seen))
      (is (null (rpl:agent-tasks a))))))

(test agents.one-with-tasks-cannot-be-removed
  (with-agents (runner a b)
    (let ((task (begin-on (b) (rpl:wait-time 9))))
      (signals base:misuse (rpl:remove-agent b))
      (is (equal (list task) (rpl:agent-tasks b)))
      (rpl:end-tasks-at-once runner (rpl:agent-tasks b))
      (rpl:remove-agent b)
      (is (equal (list a) (rpl:runner-agents runner))))))

;;; The order of turns.

(defclass backward-client () ())

(defmethod tasks:agents-in-order ((client backward-client) agents)
  (reverse agents))

(defun order-of-turns (client)
  "Return what three agents of a runner for CLIENT do, in order: twice each, at two ticks."
  (let* ((runner (rpl:make-plan-runner :client client)) (log '()))
    (dolist (agent (add-agents 3 runner))
      (dolist (name '(:first :second))
        (rpl:start-plan agent
                        (rpl:interp-lambda (agent name)
                          (rpl:n-times 2
                            (push (list (rpl:agent-client agent) name) log)
                            (rpl:wait-time 1)))
                        agent name)))
    (dotimes (tick 2) (react-at tick runner))
    (reverse log)))

(test turns.are-taken-in-the-order-of-the-client
  (let ((turn-0 '((0 :first) (0 :second))) (turn-1 '((1 :first) (1 :second)))
        (turn-2 '((2 :first) (2 :second))))
    (let ((order (append turn-0 turn-1 turn-2)))
      (is (equal (subseq (order-of-turns nil) 0 6) order)))
    (let ((order (append turn-2 turn-1 turn-0)))
      (is (equal (subseq (order-of-turns (make-instance 'backward-client)) 0 6) order)))))

(test turns.what-another-agent-makes-ready-runs-in-the-same-reaction
  (with-agents (runner a b)
    (let* ((ping (fluent)) (pong (fluent)) (valve (rpl:make-valve 'door)) (log '()))
      (begin-on (a) (rpl:wait-for ping) (push :a log) (rpl:pulse pong)
                    (rpl:with-valve (valve) (push :door log)))
      (begin-on (b) (rpl:with-valve (valve)
                      (rpl:pulse ping) (rpl:wait-for pong) (push :b log)))
      (is (eq :idle (rpl:react-to-all runner)))
      (is (equal '(:a :b :door) (reverse log)))
      (is (null (rpl:plan-runner-tasks runner))))))

(test turns.posts-wait-until-no-agent-has-a-ready-task
  "A command and the wait for its pulse may be far apart: another agent has a turn between them."
  (with-agents (runner a b)
    (let ((moved (fluent)) (go (fluent)) (heard nil))
      (begin-on (b) (rpl:post-entry runner `((:pulse ,moved)))
                    (rpl:pulse go)
                    (rpl:wait-for moved)
                    (setf heard t))
      (begin-on (a) (rpl:wait-for go) (rpl:n-times 30000 nil))
      (rpl:react-to-all runner)
      (is-true heard))))

(test turns.an-agent-that-joins-in-a-reaction-takes-part
  (with-agents (runner a)
    (let ((done nil))
      (begin-on (a) (begin-on ((first (add-agents 1 runner))) (setf done t)))
      (is (eq :idle (rpl:react-to-all runner)))
      (is-true done))))

(test turns.a-pulse-waits-until-its-receiver-of-another-agent-is-at-rest
  (with-agents (runner a b)
    (let* ((f (fluent)) (heard nil) (receiver nil))
      (begin-on (a) (rpl:notify-at-rest receiver (lambda () (rpl:pulse f))))
      (setf receiver (begin-on (b) (rpl:n-times 100 nil) (rpl:wait-for f) (setf heard t)))
      (rpl:react-to-all runner)
      (is-true heard)
      (is (eq :succeeded (rpl:task-state receiver))))))

;;; Nobody waits for another.

(test fairness.a-loop-of-one-agent-delays-no-other
  (with-agents (runner a b c)
    (let ((rpl:*runaway-limit* 20000) (ticks '()) (f (fluent)) (heard '()))
      (begin-on (a) (loop (itself 1)))
      (begin-on (b) (rpl:n-times 5 (push (rpl:plan-time) ticks) (rpl:wait-time 1)))
      (begin-on (c) (loop (rpl:wait-for f) (push (rpl:plan-time) heard)))
      (dotimes (tick 5)
        (is (eq :budget (react-at tick runner)))
        (rpl:post-entry runner `((:pulse ,f)))
        (rpl:react-to-all runner))
      (is (equal '(0 1 2 3 4) (reverse ticks)))
      (is (equal '(0 1 2 3 4) (reverse heard)))
      (is (= 1 (length (base:take-messages)))))))

(test fairness.a-budget-that-is-used-up-delays-no-other
  (with-agents (runner a b)
    (rpl:set-charges a t 10)
    (rpl:set-charges b t 1000)
    (let ((slow (begin-on (a) (rpl:n-times 100 nil) (rpl:plan-time)))
          (fast (begin-on (b) (rpl:n-times 100 nil) (rpl:plan-time))))
      (loop for tick from 0 until (rpl:task-over-p slow) do (react-at tick runner))
      (is (= 0 (rpl:task-result fast)))
      (is (= 10 (rpl:task-result slow))))))

(test fairness.posts-for-an-agent-that-is-out-wait-in-order
  (with-agents (runner a b)
    (let ((log '()))
      (flet ((post (name &optional agent)
               (rpl:post-entry runner
                               (lambda () (push (list name (rpl:plan-runner-tick runner)) log))
                               agent)))
        (rpl:set-charges a t 10)
        (begin-on (a) (rpl:charge-ticks 3) (rpl:wait-time 0))
        (rpl:react-to-all runner)
        (post :a1 a) (post :all) (post :b b) (post :a2 a)
        (is (eq :budget (rpl:react-to-all runner)))
        (is (equal '((:all 0) (:b 0)) (reverse log)))
        (is (not (rpl:runner-idle-p runner)))
        (rpl:remove-agent b)
        (post :alone)
        (loop for tick from 1 to 3 do (react-at tick runner))
        (is (equal '((:a1 3) (:a2 3) (:alone 3)) (reverse (butlast log 2))))))))

(test fairness.thinking-alone-stops-the-plans-of-one-agent
  (with-agents (runner a b)
    (dolist (agent (list a b)) (rpl:set-charges agent t nil))
    (let* ((f (fluent)) (others '())
           (stopped (begin-on (a) (rpl:wait-for f) (rpl:plan-time)))
           (thinker (begin-on (a) (rpl:think 5 :alone t) (rpl:plan-time))))
      (begin-on (b) (rpl:wait-time 1) (rpl:pulse f)
                    (rpl:n-times 3 (push (rpl:plan-time) others) (rpl:wait-time 1)))
      (loop for tick from 0 to 6 do (react-at tick runner))
      (is (= 5 (rpl:task-result thinker)))
      (is (= 5 (rpl:task-result stopped)))
      (is (equal '(1 2 3) (reverse others))))))

(test fairness.a-receiver-that-is-stopped-does-not-keep-the-sender
  (with-agents (runner a b)
    (rpl:set-charges b t nil)
    (let* ((told nil) (receiver (begin-on (b) (rpl:charge-ticks 50) (rpl:wait-time 0) 1)))
      (begin-on (a) (rpl:wait-time 1)
                    (rpl:notify-at-rest receiver (lambda () (setf told (rpl:plan-time)))))
      (react-at 0 runner)
      (react-at 1 runner)
      (is (= 1 told)))))

(test charges.are-those-of-the-agent-that-calls
  (with-agents (runner a b)
    (dolist (agent (list a b)) (rpl:set-charges agent t 100))
    (let ((tasks (loop for agent in (list a b) for steps in '(0 1000)
                       collect (rpl:start-plan agent
                                               (rpl:interp-lambda (steps)
                                                 (rpl:charge-steps steps)
                                                 (rpl:wait-time 0)
                                                 (rpl:plan-time))
                                               steps))))
      (loop for tick from 0 to 12 do (react-at tick runner))
      (is (equal '(0 10) (mapcar #'rpl:task-result tasks)))
      (rpl:charge-ticks 4 b)
      (is (not (tasks::agent-stopped-p a)))
      (is-true (tasks::agent-stopped-p b)))))

;;; Each agent by itself does what it would do alone.

(defun run-side-by-side (plans)
  "Run random PLANS, each with an agent of its own. Return lists (time outcome) of their ends."
  (let* ((ends '())
         (runner (rpl:make-plan-runner
                  :on-end (lambda (task) (push (cons task (rpl:plan-runner-tick)) ends))))
         (tasks (loop for agent in (add-agents (length plans) runner)
                      for plan in plans
                      collect (rpl:start-plan agent (rpl:make-plan (plan-text plan))))))
    (rpl:react-to-all runner)
    (loop while (rpl:next-wake-time runner)
          do (react-at (rpl:next-wake-time runner) runner))
    (loop for task in tasks
          collect (list (cdr (assoc task ends))
                        (ecase (rpl:task-state task) (:succeeded :ok) (:failed :fail))))))

(test agents.random-plans-side-by-side-end-when-and-how-the-model-says
  (let ((dice (base:make-dice 38 "plans of agents")))
    (is (loop repeat 150
              always (let ((plans (loop repeat 3 collect (random-plan 3 nil dice))))
                       (equal (loop for plan in plans
                                    collect (multiple-value-list (ending plan 0)))
                              (run-side-by-side plans)))))))

(test agents.random-plans-that-share-fluents-and-valves-leave-nothing-when-killed
  (is (null (trouble-with-kills 60 10 38 3))))

;;; Ending the plans of one agent.

(test ending.the-tasks-of-one-agent-lets-no-other-run
  (with-agents (runner a b)
    (let* ((log '()) (f (fluent))
           (kept (begin-on (a) (rpl:wait-for f) (push :woken log)))
           (ended (loop repeat 2
                        collect (begin-on (b)
                                  (rpl:evap-protect (rpl:wait-time 9)
                                                    (rpl:seq (push :cleaned log)
                                                             (rpl:pulse f)
                                                             (rpl:wait-time 1)
                                                             (push :never log)))))))
      (rpl:react-to-all runner)
      (rpl:post-entry runner (lambda () (push :posted log)))
      (rpl:end-tasks-at-once runner ended)
      (is (equal '(:cleaned :cleaned) log))
      (is (equal (list kept) (rpl:plan-runner-tasks runner)))
      (is (equal '(:evaporated :evaporated) (mapcar #'rpl:task-state ended)))
      (is (= 2 (length (base:take-messages))))
      (rpl:react-to-all runner)
      (is (equal '(:woken :posted) (reverse (butlast log 2)))))))

(test ending.works-for-an-agent-that-is-out
  (with-agents (runner a b)
    (rpl:set-charges b t 10)
    (let ((cleaned nil) (valve (rpl:make-valve 'door)) (other nil))
      (begin-on (b) (rpl:evap-protect (rpl:with-valve (valve) (rpl:think 50 :alone t))
                                      (setf cleaned t)))
      (begin-on (a) (rpl:wait-time 1) (rpl:with-valve (valve) (setf other t)))
      (react-at 0 runner)
      (react-at 1 runner)
      (is-false other)
      (rpl:end-tasks-at-once runner (rpl:agent-tasks b))
      (is-true cleaned)
      (rpl:react-to-all runner)
      (is-true other))))

(test close-runner.ends-the-tasks-of-all-agents
  (with-agents (runner a b)
    (rpl:set-charges a t 10)
    (begin-on (a) (rpl:think 50 :alone t))
    (begin-on (b) (rpl:evap-protect (rpl:wait-time 9) (rpl:wait-time 9)))
    (rpl:react-to-all runner)
    (rpl:close-runner runner)
    (is (null (rpl:plan-runner-tasks runner)))
    (is (null (rpl:next-wake-time runner)))
    (is (zerop (rpl:runner-blocks runner)))))

;;; Trouble.

(test left.by-a-throw-all-agents-are-repaired
  (with-agents (runner a b c)
    (let* ((f (fluent)) (ends '())
           (note (lambda (name) (push name ends))))
      (begin-on (a) (rpl:wait-for f) (funcall note :a))
      (let ((thrower (begin-on (b) (rpl:pulse f) (throw :out nil))))
        (begin-on (c) (rpl:with-tags
                        (rpl:par (:tag part (rpl:wait-time 1) (funcall note :part))
                                 (rpl:with-task-blocked part (rpl:wait-time 3)))))
        (catch :out (rpl:react-to-all runner))
        (loop for tick from 0 to 5 do (react-at tick runner))
        (is (eq :evaporated (rpl:task-state thrower)))
        (is (equal '(:a :part) (reverse ends)))
        (is (null (rpl:plan-runner-tasks runner)))
        (is (zerop (rpl:runner-blocks runner)))))))

(test ending.a-task-of-another-agent-takes-effect-at-once
  (with-agents (runner a b)
    (let* ((cleaned nil)
           (task (begin-on (b) (rpl:evap-protect (rpl:wait-time 9)
                                                 (setf cleaned (rpl:plan-time))))))
      (begin-on (a) (rpl:wait-time 1) (rpl:evaporate task))
      (react-at 0 runner)
      (react-at 1 runner)
      (is (= 1 cleaned))
      (is (eq :evaporated (rpl:task-state task))))))

(test deadlock.is-reported-for-all-agents
  (with-agents (runner a b)
    (let ((v (rpl:make-valve 'v)) (w (rpl:make-valve 'w)))
      (begin-on (a) (rpl:with-valve (v) (rpl:wait-time 1) (rpl:with-valve (w) 1)))
      (begin-on (b) (rpl:with-valve (w) (rpl:wait-time 1) (rpl:with-valve (v) 1)))
      (react-at 0 runner)
      (react-at 1 runner)
      (is-true (tasks:plan-deadlocked-p runner))
      (let ((texts (mapcar #'base:message-text (base:take-messages))))
        (is (= 1 (length texts)))
        (is (search "Deadlock at tick 1" (first texts)))))))

;;; Dice, digests, forks.

(test dice.each-agent-rolls-its-own
  (flet ((choices (agents)
           (let ((runner (rpl:make-plan-runner)) (log '()))
             (loop for number below agents
                   do (rpl:start-plan
                       (rpl:add-agent runner (rpl:make-agent :dice (base:make-dice number)))
                       (rpl:interp-lambda (number)
                         (rpl:n-times 20
                           (rpl:try-one (push (list number 1) log) (push (list number 2) log))
                           (rpl:wait-time 1)))
                       number))
             (dotimes (tick 20) (react-at tick runner))
             (remove 0 (reverse log) :key #'first :test-not #'=))))
    (is (equal (choices 1) (choices 3)))
    (is (= 20 (length (choices 1))))))

(defun digest-of-runner (runner)
  (let ((digest (base:make-digest)))
    (tasks:digest-runner runner digest)
    (base:digest-value digest)))

(test digests.have-the-charges-and-dice-of-each-agent
  (with-agents (runner a b)
    (let ((digests (list (digest-of-runner runner))))
      (flet ((note () (pushnew (digest-of-runner runner) digests)))
        (rpl:set-charges b t 100)
        (rpl:charge-ticks 4 b) (note)
        (rpl:charge-steps 5 b) (note)
        (tasks:reseed-agent b 7) (note)
        (tasks:reseed-agent a 7) (note))
      (is (= 5 (length digests))))))

(rpl:def-interp-proc share-a-fluent (f other)
  "Take turns with another plan, by chance, until tick 20."
  (loop until (>= (rpl:plan-time) 20)
    (rpl:try-one (rpl:wait-time 1) (rpl:wait-time 2) (rpl:wait-for f :timeout 3))
    (rpl:set-value other (rpl:plan-time))
    (rpl:pulse other)))

(test forks.copy-all-agents
  (is (null (run:with-simulation (ars-worlds:robbie :seed 1)
              (driver:rpl-init-robot ars-worlds:robbie)
              (let* ((runner (driver:rpl-runner)) (f (fluent nil 'f)) (g (fluent nil 'g))
                     (agent (rpl:make-agent :client (rpl:runner-client runner)
                                            :dice (base:make-dice 3))))
                (rpl:start-plan runner 'share-a-fluent f g)
                (rpl:start-plan (rpl:add-agent runner agent) 'share-a-fluent g f)
                (run:run-ticks 5)
                (fork-trouble time:*simulation* 20))))))
