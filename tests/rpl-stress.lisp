;;;; rpl-stress.lisp -- random plans: when they end, by a model, and what they leave behind.

(in-package :ars-magna.tests)
(in-suite rpl)

;;; The model. A plan here is a list: (wait span), (fail span), (leave span), (seq plan...), (par
;;; plan...), (pursue plan...), (try-all plan...), (try plan...), (protect plan span), (handle plan
;;; span), (police policy plan), (deadline plan span), (some count plan...), (again plan) or (around
;;; plan), which (leave span) leaves. OUTCOME is :ok, :fail
;;; or :leave. Spans are so chosen that no two things happen at one instant.

(defun child-ends (plans start)
  (loop for plan in plans collect (multiple-value-list (ending plan start))))

(defun decision (kind ends)
  "Return when, and how, a construct of KIND is decided whose children's (time outcome) are ENDS."
  (let* ((deciding (ecase kind
                     (par (remove :ok ends :key #'second))
                     (pursue ends)
                     (try-all (remove :fail ends :key #'second))
                     (police (if (eq :ok (second (first ends))) (rest ends) ends))))
         (first (first (sort (copy-list deciding) #'< :key #'first))))
    (if first
        (values-list first)
        (values (reduce #'max ends :key #'first) (if (eq kind 'par) :ok :fail)))))

(defun nth-of-outcome (n outcome ends)
  "Return the time of the Nth of ENDS, from 0, that are of OUTCOME, or NIL."
  (first (nth n (sort (remove outcome (copy-list ends) :key #'second :test-not #'eq)
                      #'< :key #'first))))

(defun some-decision (count ends)
  "Return when, and how, it is decided whether COUNT of those succeed whose ends are ENDS."
  (let ((candidates (remove nil (list (list (nth-of-outcome (1- count) :ok ends) :ok)
                                      (list (nth-of-outcome (- (length ends) count) :fail ends)
                                            :fail)
                                      (list (nth-of-outcome 0 :leave ends) :leave))
                            :key #'first)))
    (values-list (first (sort candidates #'< :key #'first)))))

(defun killing (plans ends start at)
  "Return when those of PLANS that have not ended at AT are gone if they evaporate then."
  (loop for plan in plans
        for (end) in ends
        maximize (if (> end at) (gone plan start at) at)))

(defun chain (plans start goes-on)
  "Return when and how PLANS end, run one after the other while the outcome is GOES-ON, and the
last one run with its start."
  (loop with time = start and outcome and before
        for plan in plans
        do (setf before time)
           (multiple-value-setq (time outcome) (ending plan time))
        until (not (eq outcome goes-on))
        finally (return (values time outcome))))

(defun ending (plan start)
  "Return when PLAN, started at START, ends, and its outcome."
  (destructuring-bind (kind &rest parts) plan
    (ecase kind
      (wait (values (+ start (first parts)) :ok))
      (fail (values (+ start (first parts)) :fail))
      (leave (values (+ start (first parts)) :leave))
      (seq (chain parts start :ok))
      (try (chain parts start :fail))
      (around (multiple-value-bind (time outcome) (ending (first parts) start)
                (values time (if (eq outcome :leave) :ok outcome))))
      (protect (multiple-value-bind (time outcome) (ending (first parts) start)
                 (values (+ time (second parts)) outcome)))
      (handle (multiple-value-bind (time outcome) (ending (first parts) start)
                (if (eq outcome :fail) (values (+ time (second parts)) :ok) (values time outcome))))
      (again (ending (first parts) start))
      (deadline (destructuring-bind (plan span) parts
                  (multiple-value-bind (time outcome) (ending plan start)
                    (if (< time (+ start span))
                        (values time outcome)
                        (values (gone plan start (+ start span)) :fail)))))
      (some (let ((ends (child-ends (rest parts) start)))
              (multiple-value-bind (time outcome) (some-decision (first parts) ends)
                (values (killing (rest parts) ends start time) outcome))))
      ((par pursue try-all police)
       (let ((ends (child-ends parts start)))
         (multiple-value-bind (time outcome) (decision kind ends)
           (values (killing parts ends start time) outcome)))))))

(defun gone (plan start at)
  "Return when PLAN, started at START, is gone if it evaporates at AT, before its end."
  (destructuring-bind (kind &rest parts) plan
    (ecase kind
      ((wait fail leave) at)
      ((seq try) (loop with time = start
                       for plan in parts
                       for end = (ending plan time)
                       when (> end at) return (gone plan time at)
                       do (setf time end)))
      (around (gone (first parts) start at))
      (protect (let ((end (ending (first parts) start)))
                 (+ (second parts) (if (> end at) (gone (first parts) start at) end))))
      (handle (if (> (ending (first parts) start) at) (gone (first parts) start at) at))
      (again (gone (first parts) start at))
      (deadline (destructuring-bind (plan span) parts
                  (gone plan start (min at (+ start span)))))
      (some (let ((ends (child-ends (rest parts) start)))
              (if (<= (some-decision (first parts) ends) at)
                  (ending plan start)
                  (killing (rest parts) ends start at))))
      ((par pursue try-all police)
       (let ((ends (child-ends parts start)))
         (if (<= (decision kind ends) at)
             (ending plan start)
             (killing parts ends start at)))))))

;;; The same as a real plan.

(defun plan-text (plan)
  (destructuring-bind (kind &rest parts) plan
    (flet ((all () (mapcar #'plan-text parts)))
      (ecase kind
        (wait `(rpl:wait-time ,(first parts)))
        (fail `(rpl:seq (rpl:wait-time ,(first parts)) (rpl:fail)))
        (leave `(rpl:seq (rpl:wait-time ,(first parts)) (return-from around :left)))
        (seq `(rpl:seq ,@(all)))
        (try `(rpl:try-in-order ,@(all)))
        (around `(block around ,@(all)))
        (protect `(rpl:evap-protect ,(plan-text (first parts)) (rpl:wait-time ,(second parts))))
        (handle `(rpl:handle-failure ((t () (rpl:wait-time ,(second parts)) (return)))
                   ,(plan-text (first parts))))
        (par `(rpl:par ,@(all)))
        (pursue `(rpl:pursue ,@(all)))
        (try-all `(rpl:try-all ,@(all)))
        (again `(rpl:retry-after-suspension (rpl:on-suspension nil ,@(all))))
        (deadline `(rpl:with-deadline (,(second parts)) ,(plan-text (first parts))))
        (some `(rpl:par-at-least ,(first parts) ,@(mapcar #'plan-text (rest parts))))
        (police `(rpl:with-policy ,@(all)))))))

(defun random-span (dice) (1+ (base:roll-index (expt 2 40) dice)))

(defun random-plan (depth around dice)
  "Return a random plan of at most DEPTH levels; AROUND says whether it can be left."
  (flet ((part (&optional (around around)) (random-plan (1- depth) around dice))
         (span () (random-span dice)))
    (let ((kind (if (plusp depth)
                    (base:roll-element '(wait fail leave seq par pursue try-all try protect handle
                                         police around seq par protect deadline some again)
                                       dice)
                    (base:roll-element '(wait wait fail leave) dice))))
      (ecase kind
        ((wait fail) (list kind (span)))
        (leave (list (if around 'leave 'wait) (span)))
        ((seq par pursue try-all try)
         (cons kind (loop repeat (1+ (base:roll-index 3 dice)) collect (part))))
        (police (list 'police (part) (part)))
        ((protect handle deadline) (list kind (part) (span)))
        (again (list 'again (part)))
        (some (let ((parts (loop repeat (1+ (base:roll-index 3 dice)) collect (part))))
                (list* 'some (1+ (base:roll-index (length parts) dice)) parts)))
        (around (list 'around (part t)))))))

(defun run-random-plan (plan)
  "Return when and how PLAN really ends, and whether nothing of it is left."
  (let ((runner (rpl:make-plan-runner :on-end #'identity)))
    (multiple-value-bind (value state)
        (rpl:run-plan-alone (rpl:make-plan (plan-text plan)) :runner runner)
      (declare (ignore value))
      (values (rpl:plan-runner-tick runner)
              (ecase state (:succeeded :ok) (:failed :fail) (:deadlock :deadlock))
              (and (null (rpl:next-wake-time runner)) (null (rpl:plan-runner-tasks runner)))))))

(test stress.random-plans-end-when-and-how-the-model-says
  (let ((dice (base:make-dice 1992 "plans")) (wrong '()))
    (dotimes (run 400)
      (let ((plan (random-plan 4 nil dice)))
        (multiple-value-bind (time outcome) (ending plan 0)
          (multiple-value-bind (real-time real-outcome clean) (run-random-plan plan)
            (unless (and (= time real-time) (eq outcome real-outcome) clean)
              (push (list plan time outcome real-time real-outcome clean) wrong))))))
    (is (null wrong))))

;;; Random plans over shared fluents and valves: nothing is left behind when they are stopped, and
;;; each run is the same as the one before.

(defun random-control (part span dice)
  "Return a random form in which one part of a plan keeps another from running, or waits for it."
  (flet ((part () (funcall part)))
    (let ((other (ecase (base:roll-index 5 dice)
                   (0 `(rpl:seq (rpl:suspend part) ,(part) (rpl:wake-up part)))
                   (1 `(rpl:seq (rpl:suspend part) ,(part)))
                   (2 '(rpl:join-task part))
                   (3 `(rpl:with-task-suspended part ,(part)))
                   (4 '(rpl:seq (rpl:suspend (rpl:task-parent part)) (rpl:wake-up part))))))
      (if (base:chance .3 dice)
          `(rpl:partial-order ((:tag part ,(part))
                               (:tag next ,(part) (:tag inner ,(part)))
                               (rpl:seq (rpl:wait-time ,span) ,other))
             (:order ,(base:roll-element '(part f) dice) ,(base:roll-element '(next inner) dice)))
          `(rpl:with-tags (,(base:roll-element '(rpl:par rpl:pursue rpl:try-all) dice)
                           (:tag part ,(part))
                           (rpl:seq (rpl:wait-time ,span) ,other)))))))

(defun random-form (depth dice)
  (flet ((part () (random-form (1- depth) dice))
         (parts () (loop repeat (1+ (base:roll-index 3 dice))
                         collect (random-form (1- depth) dice)))
         (fluent () (base:roll-element '(f g h) dice))
         (span () (base:roll-index 6 dice)))
    (if (plusp depth)
        (ecase (base:roll-index 26 dice)
          (0 `(rpl:par ,@(parts)))
          (1 `(rpl:pursue ,@(parts)))
          (2 `(rpl:try-all ,@(parts)))
          (3 `(rpl:with-policy (rpl:whenever ,(fluent) ,(part)) ,@(parts)))
          (4 `(rpl:with-valve (,(base:roll-element '(v w) dice)) ,@(parts)))
          (5 `(rpl:handle-failure ((t () ,(part) (return))) ,@(parts)))
          (6 `(rpl:evap-protect ,(part) (rpl:wait-time ,(span))))
          (7 `(rpl:n-times ,(span) ,@(parts)))
          (8 `(rpl:seq (rpl:wait-for (and ,(fluent) (not ,(fluent))) :timeout ,(span)) ,(part)))
          (9 `(rpl:par-loop (item '(1 2 3)) ,(part)))
          (10 `(rpl:with-tags (rpl:par (:tag part ,(part))
                                       (rpl:seq (rpl:wait-time ,(span))
                                                (rpl:with-task-blocked part ,(part))))))
          (11 `(rpl:with-tags (rpl:par (:tag part ,(part))
                                       (rpl:seq (rpl:wait-time ,(span)) (rpl:evaporate part)))))
          (12 `(block nil (rpl:par ,@(parts) (rpl:seq (rpl:wait-time ,(span)) (return)))))
          (13 `(rpl:try-in-order ,@(parts)))
          ((14 15 16 17 18) (random-control #'part (span) dice))
          (19 `(rpl:on-suspension (rpl:set-value ,(fluent) ,(span)) ,@(parts)))
          (20 `(rpl:retry-after-suspension ,@(parts)))
          (21 `(rpl:with-valves (v w :priority ,(span)) ,@(parts)))
          (22 `(rpl:with-valve (,(base:roll-element '(v w) dice) :priority ,(span)) ,@(parts)))
          (23 `(rpl:with-deadline (,(span)) ,@(parts)))
          (24 `(rpl:par-at-least 2 ,(part) ,@(parts) ,(part)))
          (25 `(rpl:with-task-variables ((*pace* ,(span))) ,@(parts))))
        (ecase (base:roll-index 7 dice)
          (0 `(rpl:pulse ,(fluent)))
          (1 `(rpl:set-value ,(fluent) (not (rpl:fluent-value ,(fluent)))))
          (2 `(rpl:wait-for ,(fluent)))
          (3 `(rpl:wait-for (or ,(fluent) (eq ,(fluent) ,(fluent)))))
          (4 `(rpl:wait-time ,(span)))
          (5 '(rpl:fail))
          (6 '(car 3))))))

(defun run-and-stop (form at)
  "Run FORM until tick AT, stop it, and return the trace as text and what is left of it."
  (let* ((fluents (list (fluent nil 'f) (fluent nil 'g) (fluent nil 'h)))
         (valves (list (rpl:make-valve 'v) (rpl:make-valve 'w)))
         (runner (rpl:make-plan-runner :trace t :on-end #'identity))
         (base:*message-queue* (base:make-message-queue))
         (rpl:*runaway-limit* 2000)
         (base:*echo-output* (make-broadcast-stream))
         (plan (rpl:make-plan `(destructuring-bind (f g h v w) ',(append fluents valves)
                                 (declare (ignorable f g h v w))
                                 ,form))))
    (rpl:run-plan-alone plan :runner runner :limit at)
    (rpl:stop-plan runner)
    (loop while (rpl:plan-runner-tasks runner)
          do (rpl:apply-next-batch runner)
             (rpl:react-to-all runner)
             (when (rpl:next-wake-time runner)
               (rpl:advance-timers runner (rpl:next-wake-time runner)))
          repeat 10000)
    (values (with-output-to-string (stream) (rpl:write-trace (rpl:plan-trace runner) stream))
            (list (rpl:plan-runner-tasks runner)
                  (rpl:next-wake-time runner)
                  (remove nil (mapcar #'fluents::fluent-first-watcher fluents))
                  (remove nil (mapcar #'fluents::fluent-first-link fluents))
                  (remove nil (mapcar #'rpl:valve-owner valves))
                  (mapcan #'rpl:valve-losers valves)
                  (mapcan #'rpl:valve-requests valves)
                  (some #'tasks::agent-held (rpl:runner-agents runner))
                  (plusp (rpl:runner-blocks runner))))))

(test stress.stopped-plans-leave-nothing-behind-and-repeat-exactly
  (let ((dice (base:make-dice 1992 "stopped plans")) (wrong '()))
    (dotimes (run 400)
      (let ((form (random-form 4 dice)) (at (base:roll-index 15 dice)))
        (multiple-value-bind (trace left) (run-and-stop form at)
          (unless (and (every #'null left) (string= trace (run-and-stop form at)))
            (push (list form at left) wrong)))))
    (is (null wrong))))
