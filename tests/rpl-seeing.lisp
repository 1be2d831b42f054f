;;;; rpl-seeing.lisp -- seeing plans run: trees, stacks, variables, describe, trace queries, why.

(in-package :ars-magna.tests)
(in-suite rpl)

(define-condition unprintable () ())
(defstruct grumpy)
(defmethod print-object ((grumpy grumpy) stream)
  (declare (ignore stream))
  (error "I will not be printed."))

(rpl:def-interp-proc seen-worker (number door valve)
  "Wait for DOOR with VALVE."
  (let ((twice (* 2 number)))
    (rpl:with-valve (valve)
      (rpl:wait-for door)
      (rpl:wait-time twice))))

(rpl:def-interp-proc seen-boss ()
  (let ((door (rpl:create-fluent 'door)) (arm (rpl:make-valve 'arm)) (count 7))
    (rpl:par
      (:tag one (seen-worker 1 door arm))
      (:tag two (seen-worker 2 door arm))
      (rpl:seq (rpl:wait-time 3)
               (rpl:with-task-blocked one
                 (rpl:wait-time 1)
                 (incf count)
                 (rpl:set-value door :open)
                 (rpl:wait-time 1)))
      (rpl:pursue (rpl:wait-time 2)
                  (rpl:evap-protect (rpl:wait-time 50) (rpl:wait-time 20)))
      (rpl:handle-failure ((:slip () (return nil)))
        (rpl:wait-time 1)
        (rpl:fail :class :slip)))))

(defun seen-until (limit &key (plan 'seen-boss) (trace t) (tick limit))
  "Return the runner of PLAN, which has run until tick LIMIT, and its top-level task."
  (let ((runner (rpl:make-plan-runner :trace trace)))
    (let ((task (rpl:start-plan runner plan)))
      (loop for now from 0 to tick
            do (rpl:advance-timers runner now)
               (rpl:react-to-all runner))
      (values runner task))))

(defun tree-text (which &optional all)
  (with-output-to-string (out) (rpl:print-tasks which out all)))

(defun described (object)
  (with-output-to-string (out) (describe object out)))

(defun part (task index) (nth index (rpl:task-children task)))

;;; What is under way.

(test tree.says-since-when-and-how-tasks-are
  (multiple-value-bind (runner task) (seen-until 3)
    (let ((text (tree-text runner)))
      (is-true (has-words-p text "1 waiting: seen-boss" "waits for valve arm since tick 0"
                            "waits for tick 4 since tick 3" "waiting, blocked: one"
                            "waiting, evaporating, cleaning up"))
      (is (search "waits for tick 22 since tick 2" text))
      (is (= 0 (rpl:task-since (part task 0))))
      (is (= 3 (rpl:task-since (part task 2)))))))

(test tree.of-all-has-stacks-variables-and-valves
  (multiple-value-bind (runner task) (seen-until 5)
    (let ((text (tree-text runner t)))
      (is-true (has-words-p text "count = 8" "twice = 2" "number = 1" "twice = 4"
                            "in (seen-worker 1 door arm)" "door = #<fluent door = :open>"))
      (is (search "valve arm: of task 2, wanted by 3" text))
      ;; Each task shows what it adds to those around it.
      (is (= 1 (count-of "count = 8" text))))
    (is (equal '((rpl:wait-time twice)
                 (rpl:with-valve (valve) (rpl:wait-for door) (rpl:wait-time twice))
                 (seen-worker 1 door arm))
               (rpl:task-stack (part task 0))))))

(defun count-of (word text)
  (loop for start = (search word text) then (search word text :start2 (1+ start))
        while start count t))

(test task-variables.have-names-and-values
  (let ((task (nth-value 1 (seen-until 5))))
    (is (equal '(twice number door valve) (mapcar #'first (rpl:task-variables (part task 0)))))
    (is (= 4 (second (assoc 'twice (rpl:task-variables (part task 1))))))
    (is (= 8 (second (assoc 'count (rpl:task-variables task)))))
    (is (eq (part task 0) (second (assoc 'one (rpl:task-variables task)))))))

(defun variables-in (form names)
  "Return the values of the variables NAMES where the task of FORM waits."
  (let ((task (nth-value 1 (seen-until 0 :plan (rpl:make-plan form)))))
    (loop for name in names
          collect (second (assoc name (rpl:task-variables task))))))

(test task-variables.of-every-binding-form
  (is (equal '(1 2) (variables-in '(let ((a 1)) (let* ((b 2)) (rpl:wait-time 9))) '(a b))))
  (is (equal '(3 4) (variables-in '(multiple-value-bind (a b) (values 3 4) (rpl:wait-time 9))
                                  '(a b))))
  (is (equal '(x) (variables-in '(dolist (a '(x y)) (rpl:wait-time 9)) '(a))))
  (is (equal '(0) (variables-in '(dotimes (a 3) (rpl:wait-time 9)) '(a))))
  (is (equal '(nil 7) (variables-in '(labels ((f (b) (rpl:wait-time b)))
                                    (let ((a 5)) (f (+ a 2))))
                                  '(a b)))
      "a local plan sees what is around it and its own")
  (is (equal '(1 2) (variables-in '(let ((a 1))
                                    (flet ((f (x) x))
                                      (let ((b (f 2))) (rpl:wait-time b))))
                                  '(a b))))
  (is (equal '(2) (variables-in '(let ((a 1)) (let ((a 2)) (rpl:wait-time a))) '(a)))))

(test values.that-cannot-be-printed-are-shown-all-the-same
  (let* ((form '(let ((a-ring (let ((list (list 1 2))) (setf (cddr list) list)))
                      (a-text (make-string 100000 :initial-element #\x))
                      (a-list (loop for i below 100000 collect i))
                      (a-grump (make-grumpy)))
                 (rpl:wait-time 9)
                 (list a-ring a-text a-list a-grump)))
         (task (nth-value 1 (seen-until 0 :plan (rpl:make-plan form))))
         (text (tree-text task t)))
    (is (< (length text) 2000))
    (is-true (has-words-p text "a-ring = (1 2 1 2" "a-text = \"xxx" "a-list = (0 1 2"
                          "a-grump = an object that cannot be printed"))
    (is (< (length (described task)) 3000))))

;;; DESCRIBE.

(test describe.tells-of-tasks-fluents-valves-and-plans
  (multiple-value-bind (runner task) (seen-until 5)
    (declare (ignore runner))
    (is-true (has-words-p (described task) "State: waiting" "Stack:" "count = 8" "Parts:"
                          "2 waiting"))
    (is-true (has-words-p (described (part task 1)) "Waits for: valve arm, since tick 0"
                          "Path: seen-boss > two" "wanted by 3"))
    (let ((variables (rpl:task-variables task)))
      (is-true (has-words-p (described (second (assoc 'arm variables)))
                            "Owner: #<" "task 2 waiting" "Queue: #<" "task 3"))
      (is-true (has-words-p (described (second (assoc 'door variables)))
                            "Name: door" "Value: :open")))
    (is-true (has-words-p (described (rpl:find-procedure 'seen-worker))
                          "Called as: (seen-worker number door valve)"
                          "Wait for DOOR with VALVE."))))

(test describe.tells-of-networks-and-of-who-waits
  (let* ((f (fluent nil 'f)) (g (fluent nil 'g))
         (runner (rpl:make-plan-runner)))
    (rpl:start-plan runner (rpl:interp-lambda ()
                             (rpl:par (rpl:wait-for f) (rpl:wait-for (and f g)))))
    (rpl:react-to-all runner)
    (is-true (has-words-p (described f) "Waited for by: #<" "task 2"))
    (is-true (has-words-p (described (rpl:fl-funcall #'list f g)) "Computed from: #<fluent f"))
    (is-true (has-words-p (described (rpl:fl-funcall #'+ f 1)) "Value: error"))))

;;; Asking the trace.

(test trace-of.is-of-a-task-and-its-parts
  (multiple-value-bind (runner task) (seen-until 4)
    (let ((entries (rpl:trace-of (part task 2))))
      (is (every (lambda (entry) (= 4 (rpl:trace-entry-task entry))) entries))
      (is (find :set entries :key #'rpl:trace-entry-event))
      (is (< (length entries) (length (rpl:trace-of task))))
      (is (= (length (rpl:trace-of task)) (length (rpl:trace-of nil :runner runner)))))
    (is (equal '(2) (mapcar #'rpl:trace-entry-task (rpl:trace-of task :event :block))))
    (is (every (lambda (entry) (eq 'rpl:wait-time (first (rpl:trace-entry-form entry))))
               (rpl:trace-of task :form 'wait-time)))
    (is (plusp (length (rpl:trace-of task :form 'wait-time :event '(:wait :wake)))))))

(test task-history.is-of-tasks-that-are-over-too
  (multiple-value-bind (runner task) (seen-until 30)
    (is (eq :succeeded (rpl:task-state task)))
    (is (equal '(:start :wait :clean :wait :wake :cleaned :evaporate)
               (mapcar #'rpl:trace-entry-event (rpl:task-history 8 :runner runner))))
    (is (equal '((8 nil (rpl:evap-protect (rpl:wait-time 50) (rpl:wait-time 20)))
                 (5 nil (rpl:pursue (rpl:wait-time 2)
                                    (rpl:evap-protect (rpl:wait-time 50) (rpl:wait-time 20))))
                 (1 seen-boss))
               (loop for (number name form) in (rpl:task-ancestry 8 :runner runner)
                     collect (if name (list number name) (list number name form)))))))

(test task-failures.are-also-those-that-were-handled
  (multiple-value-bind (runner task) (seen-until 4)
    (is (equal '(:slip) (mapcar #'rpl:failure-class (rpl:task-failures task))))
    (is (null (rpl:task-failures (part task 0) :runner runner)))))

(test trace.needed-but-not-kept-is-misuse
  (let ((task (nth-value 1 (seen-until 2 :trace nil))))
    (signals base:misuse (rpl:why task))
    (signals base:misuse (rpl:task-history task)))
  (signals base:misuse (rpl:why 99 :runner (seen-until 2))))

;;; Why.

(defun why-text (task runner)
  (with-output-to-string (out) (rpl:why task :runner runner :stream out)))

(test why.names-fluent-setter-and-tick
  (let* ((runner (seen-until 8))
         (lines (lines-of (why-text 2 runner))))
    (is (equal "Task 1 is the plan seen-boss, started at tick 0 by a program or the REPL."
               (first (last lines))))
    (is (find-if (lambda (line)
                   (and (search "could have gone on at (wait-for door)" line)
                        (search "because door was set to :open by task 4" line)
                        (search "at (set-value door :open)" line)
                        (eql 0 (search "At tick 4" line))))
                 lines)
        "~S" lines)
    (is (find-if (lambda (line) (search "was blocked by task 4" line)) lines))))

(test why.tells-of-parts-and-ends
  (let ((runner (seen-until 30)))
    (is-true (has-words-p (why-text 5 runner) "At tick 22 it succeeded"
                          "it was done with"
                          "because its part 7, (wait-time 2), succeeded"))
    (is-true (has-words-p (why-text 8 runner) "evaporated" "began to clean up" "because task 7"
                          "as a part of task 5"))
    (is-true (has-words-p (why-text 6 runner) "failed at" ":SLIP"))
    (is-true (has-words-p (why-text 3 runner) "valve arm" "by task 2"))))

(test why.tells-of-networks-and-posts
  (let* ((f (fluent nil 'f)) (g (fluent nil 'g))
         (runner (rpl:make-plan-runner :trace t))
         (task (rpl:start-plan runner (rpl:interp-lambda ()
                                        (rpl:wait-for (and f g))
                                        (rpl:wait-for (eq f :never))))))
    (rpl:react-to-all runner)
    (let ((base:*asker* "the postman"))
      (rpl:post-entry runner `((:set ,f t))))
    (rpl:post-entry runner `((:pulse ,g)))
    (loop do (rpl:react-to-all runner) while (rpl:apply-next-batch runner))
    (let ((text (why-text task runner)))
      (is-true (has-words-p text "because g was pulsed by a program")))
    (is (find-if (lambda (entry) (equal "f = t, by the postman" (rpl:trace-entry-detail entry)))
                 (rpl:trace-of nil :event :set :runner runner)))))

(test why.of-long-histories-is-cut
  (let ((runner (seen-until 40 :plan (rpl:make-plan '(rpl:n-times 40 (rpl:wait-time 1))))))
    (is (< (length (lines-of (why-text 1 runner))) 20))
    (is (search "more events happened" (why-text 1 runner)))))
