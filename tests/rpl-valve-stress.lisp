;;;; rpl-valve-stress.lisp -- random plans with valves: a task that has lost one does not run.

(in-package :ars-magna.tests)
(in-suite rpl)

;;; A plan here is a form with the variables V and W (valves) and LOOK, a function that checks
;;; whether the task that calls it may run.

(defun random-valve-parts (depth dice)
  (loop repeat (1+ (base:roll-index 3 dice)) collect (random-valve-form (1- depth) dice)))

(defun random-valve-leaf (dice)
  (if (base:chance 1/8 dice)
      '(rpl:fail)
      `(rpl:n-times ,(1+ (base:roll-index 4 dice)) (rpl:wait-time 1) (funcall look))))

(defun random-valve-form (depth dice)
  "Return a random form of at most DEPTH levels."
  (flet ((below (count) (base:roll-index count dice))
         (valve () (base:roll-element '(v v w) dice)))
    (let ((parts (and (plusp depth) (random-valve-parts depth dice))))
      (if (null parts)
          (random-valve-leaf dice)
          (ecase (below 14)
            ((0 1) `(rpl:par ,@parts))
            (2 `(rpl:seq (rpl:wait-time ,(below 4)) ,@parts))
            (3 `(rpl:pursue ,@parts))
            ((4 5 6 7) `(rpl:with-valve (,(valve) :priority ,(below 4)) ,@parts (funcall look)))
            (8 `(rpl:with-valves (,(valve) ,(valve) :priority ,(below 4)) ,@parts (funcall look)))
            ((9 10 11) `(rpl:retry-after-suspension ,@parts (funcall look)))
            (12 (base:roll-element `((rpl:on-suspension nil ,@parts)
                                     (rpl:with-deadline (,(1+ (below 6))) ,@parts)
                                     (rpl:try-in-order ,@parts))
                                   dice))
            (13 `(rpl:evap-protect (rpl:seq ,@parts) (rpl:wait-time ,(below 3)))))))))

(defun random-valve-plan (depth dice)
  "Return a random plan of four branches that begin one after the other, with DEPTH levels each."
  `(rpl:par ,@(loop for start below 4
                    collect `(rpl:seq (rpl:wait-time ,start)
                                      (rpl:try-in-order ,(random-valve-form depth dice) nil)))))

(defun lost-to-another-p (valve task)
  "True if TASK, or what it is part of, claims VALVE, which is another's now."
  (some (lambda (claim)
          (and (rpl::part-of-p task (constructs::claim-task claim))
               (not (member claim (constructs::owner-claims valve)))))
        (constructs::valve-claims valve)))

(defun runs-wrongly-p (valves task)
  "True if TASK runs, and cleans nothing up, while somebody else has one of VALVES that it had."
  (and (not (tasks::evaporating-p task))
       (some (lambda (valve) (lost-to-another-p valve task)) valves)))

(defun run-valve-plan (form)
  "Run FORM. Return how often a task ran wrongly, and what is left."
  (let* ((wrong 0)
         (valves (mapcar #'rpl:make-valve '(v w)))
         (runner (rpl:make-plan-runner :on-end #'identity))
         (base:*message-queue* (base:make-message-queue))
         (base:*echo-output* (make-broadcast-stream))
         (look (lambda () (when (runs-wrongly-p valves (rpl:current-task)) (incf wrong)))))
    (rpl:run-plan-alone (rpl:make-plan `(destructuring-bind (look v w) ',(cons look valves)
                                          (declare (ignorable look v w))
                                          ,form))
                        :runner runner :limit 60)
    (values wrong
            (append (remove nil (mapcar #'rpl:valve-owner valves))
                    (mapcan #'rpl:valve-losers valves)
                    (mapcan #'rpl:valve-requests valves)
                    (rpl:plan-runner-tasks runner)
                    (some #'tasks::agent-held (rpl:runner-agents runner))
                    (and (plusp (rpl:runner-blocks runner)) '(:blocks))))))

(test stress.who-has-lost-a-valve-does-not-run
  (let ((dice (base:make-dice 1992 "valves")) (bad '()))
    (loop for depth in '(3 4)
          do (loop repeat 100
                   do (let ((form (random-valve-plan depth dice)))
                        (multiple-value-bind (wrong left) (run-valve-plan form)
                          (unless (and (zerop wrong) (null left))
                            (push (list form wrong left) bad))))))
    (is (null bad))))
