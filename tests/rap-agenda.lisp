;;;; rap-agenda.lisp -- the agenda: tasks of goals, deadlines, priorities, robots.

(in-package :ars-magna.tests.rap)

(in-suite ars-magna.tests::rap)

(defrobot rapper-2 (rap-floor (4 14) 0))

(defvar *rap-signal* (create-fluent 'rap-signal))
(define-rap (index (rap-attend)) (method (primitive (wait-for *rap-signal*))))
(define-rap (index (rap-quick ?what)) (method (primitive (note-rap what))))
(define-rap (index (rap-clean-up ?what))
  (method (primitive (evap-protect (wait-time 100) (seq (wait-time 2) (note-rap what))))))
(define-rap (index (rap-whose))
  (method (primitive (wait-time 1) (note-rap (robot-name (rpl-robot))))))

(defun goal-states () (mapcar (lambda (goal) (getf goal :state)) (agenda-goals)))
(defun goal-notes () (mapcar (lambda (goal) (getf goal :note)) (agenda-goals)))
(defun plans-text () (with-output-to-string (stream) (print-plans stream)))

;;; Tasks.

(test rap-agenda.each-goal-is-a-task-that-is-named-after-it
  (in-rap-run
    (loop for i from 1 to 5 do (install-goal (list 'rap-work i 10) (- i)))
    (begin-plan 'work-on-agenda :at-once 2)
    (run-ticks 1)
    (let ((text (plans-text)))
      (is (search "goal 1 (rap-work 1 10)" text) "~A" text)
      (is (search "goal 2 (rap-work 2 10)" text))
      (is (not (search "goal 3" text)))
      (is (= 1 (count :more-goals (mapcar #'task-name (task-children (first (plans))))
                      :test #'string=)))
      (is (= 3 (length (task-children (first (plans)))))))))

(test rap-agenda.a-deadlock-names-the-goals
  (in-rap-run
    (install-goal '(rap-attend))
    (is (eq :deadlock (nth-value 1 (run-plan 'work-on-agenda))))
    (is (search "goal 1 (rap-attend)"
                (with-output-to-string (*standard-output*) (error-display))))
    (is (equal '("Its plan was ended.") (goal-notes)))))

(test rap-agenda.goals-take-turns-by-priority-and-deadline
  (is (equal '((1 e) (2 b) (3 d) (4 c) (5 a))
             (rap-notes
               (loop for (what . order) in '((a 0) (b 1 20) (c 1) (d 1 30) (e 2))
                     do (apply #'install-goal `(rap-work ,what 1) order))
               (is (= 5 (run-plan 'work-on-agenda :at-once 1)))))))

;;; Resources.

(define-rap (index (rap-deep-use ?what ?ticks))
  (method (task-net (work (rap-use ?what ?ticks)))))

(test rap-agenda.goals-that-begin-together-request-resources-in-their-order
  "However deep in the plan of a goal the request is."
  (dolist (order '((2) (1 50) (2 50)))
    (is (equal '((3 b) (6 a))
               (rap-notes
                 (install-goal '(rap-use a 3) 1)
                 (apply #'install-goal '(rap-deep-use b 3) order)
                 (is (= 2 (process-goal-agenda))))))))

;;; Limits.

(test rap-agenda.unimportant-goals-do-not-block-an-urgent-one
  (in-rap-run
    (dotimes (i 20) (install-goal '(rap-work a 60) -5))
    (install-goal '(rap-work b 1) 100 5)
    (is (= 21 (process-goal-agenda)))
    (is (= 60 (simulation-tick)))
    (is (typep (failure-of-run 'work-on-agenda :at-once 0) 'lisp-failure))))

(test rap-agenda.the-last-100-goals-that-have-ended-stay
  (in-rap-run
    (install-goal '(rap-attend) 1)
    (begin-plan 'work-on-agenda)
    (dotimes (i 6)
      (dotimes (j 20)
        (install-goal (if (zerop i) '(rap-try ball) (list 'rap-quick j))))
      (run-ticks 2))
    (set-value *rap-signal* t)
    (run-ticks 2)
    (set-value *rap-signal* nil)
    (is (equal (cons 1 (loop for number from 23 to 121 collect number))
               (mapcar (lambda (goal) (getf goal :number)) (agenda-goals))))
    (is (every (lambda (state) (eq :achieved state)) (goal-states)))))

(test rap-agenda.ended-goals-with-long-data-leave-room-for-others
  (in-rap-run
    (dotimes (i 30) (install-goal (list 'rap-quick (make-string 250))))
    (is (= 30 (process-goal-agenda)))
    (dotimes (i 30) (install-goal (list 'rap-quick (make-string 250))))
    (is (= 30 (process-goal-agenda)))
    (is (= 38 (length main-agenda*)))))

(test rap-agenda.a-full-agenda-refuses-goals
  (in-rap-run
    (let ((ars-rap::*open-goals-limits* '(3 8000)))
      (dotimes (i 3) (install-goal '(rap-quick a)))
      (signals misuse (install-goal '(rap-quick a)))
      (is (= 3 (process-goal-agenda)))
      (is (= 4 (install-goal '(rap-quick a)))))
    (signals misuse (install-goal (list 'rap-quick (make-string 8000))))))

(test rap-agenda.goals-with-other-than-plain-data-are-refused
  (in-rap-run
    (handler-case (install-goal (list 'rap-quick #'car))
      (wrong-argument (condition)
        (is (search "install-goal: goal is" (princ-to-string condition)) "~A" condition)))
    (is (null main-agenda*))))

;;; Deadlines.

(test rap-agenda.a-goal-may-be-achieved-at-its-deadline
  (in-rap-run
    (install-goal '(rap-work a 5) 0 5)
    (install-goal '(rap-work b 6) 0 5)
    (install-goal '(rap-use c 4) 1)
    (install-goal '(rap-use d 4) 0 7)
    (is (= 2 (process-goal-agenda)))
    (is (equal '(:achieved :failed :achieved :failed) (goal-states)))
    (is (equal '("" "Not achieved by tick 5." "" "Not achieved by tick 7.") (goal-notes)))
    (is (= 8 (simulation-tick)))))

(test rap-agenda.goals-fail-at-their-deadline-before-their-turn
  (is (equal '((10 a))
             (rap-notes
               (install-goal '(rap-work a 9) 1)
               (install-goal '(rap-work b 1) 0 3)
               (begin-plan 'work-on-agenda :at-once 1)
               (run-ticks 3)
               (is (equal '(:active :waiting) (goal-states)))
               (run-ticks 1)
               (is (equal '(:active :failed) (goal-states)))
               (run-ticks 9)))))

(test rap-agenda.a-goal-whose-deadline-is-over-is-not-begun
  (is (equal '()
             (rap-notes
               (run-ticks 5)
               (install-goal '(rap-quick a) 0 4)
               (is (= 0 (process-goal-agenda)))
               (is (not (execute-goal '(rap-quick b) 0 -1)))
               (is (equal '("Not achieved by tick 4." "Not achieved by tick -1.")
                          (goal-notes)))
               (is (= 5 (simulation-tick)))))))

;;; Changes of goals that are worked on.

(test rap-agenda.removing-a-goal-ends-its-task
  (is (equal '((5 a) (13 b))
             (rap-notes
               (install-goal '(rap-clean-up a))
               (install-goal '(rap-work b 12))
               (begin-plan 'work-on-agenda)
               (run-ticks 2)
               (is (remove-goal 1))
               (run-ticks 1)
               (is (equal '(:active) (goal-states)))
               (run-ticks 20)
               (is (equal '(:achieved) (goal-states)))
               (is (null (plans)))))))

(test rap-agenda.resetting-the-agenda-ends-all-tasks
  (is (equal '()
             (rap-notes
               (install-goal '(rap-use a 9))
               (install-goal '(rap-use b 9))
               (begin-plan 'work-on-agenda)
               (run-ticks 2)
               (reset-agenda)
               (run-ticks 20)
               (is (null main-agenda*))
               (is (null (plans)))))))

(define-rap (index (rap-two-steps ?what))
  (method (task-net (sequence (wait (rap-work waited 3)) (use (rap-use ?what 2))))))

(test rap-agenda.priorities-of-goals-can-be-changed
  (flet ((order (number)
           (mapcar #'second (rap-notes
                              (install-goal '(rap-use a 5) 5)
                              (install-goal '(rap-two-steps b) 1)
                              (install-goal '(rap-two-steps c) 2)
                              (begin-plan 'work-on-agenda)
                              (run-ticks 1)
                              (when number (is (set-goal-priority number 3)))
                              (run-ticks 30)))))
    (is (equal '(waited waited a c b) (order nil)))
    (is (equal '(waited waited a b c) (order 2))))
  (is (equal '(c a b)
             (mapcar #'second (rap-notes
                                (loop for what in '(a b c)
                                      do (install-goal (list 'rap-work what 1)))
                                (set-goal-priority 3 1)
                                (run-plan 'work-on-agenda :at-once 1)))))
  (in-rap-run
    (is (not (set-goal-priority 1 2)))
    (signals wrong-argument (set-goal-priority 1 :high))))

(test rap-agenda.a-goal-that-lost-a-resource-is-shown-as-suspended
  (in-rap-run
    (install-goal '(rap-use slow 9) 1)
    (begin-plan 'work-on-agenda)
    (run-ticks 2)
    (install-goal '(rap-use urgent 3) 9)
    (run-ticks 2)
    (is (equal '(:suspended :active) (goal-states)))
    (is (null (agenda-goals '(:waiting))))
    (is (search "suspended" (with-output-to-string (stream) (dump-agenda :stream stream))))
    (run-ticks 3)
    (is (equal '(:active :achieved) (goal-states)))))

;;; Several plans and robots.

(test rap-agenda.a-second-plan-for-the-same-robot-is-refused
  (in-rap-run
    (install-goal '(rap-work a 5))
    (begin-plan 'work-on-agenda)
    (run-ticks 1)
    (is (search "already works on the agenda"
                (princ-to-string (failure-of-run 'work-on-agenda))))
    (is (execute-goal '(rap-work b 1)))
    (run-ticks 9)
    (install-goal '(rap-work c 1))
    (is (= 1 (process-goal-agenda)))))

(test rap-agenda.each-robot-works-on-its-goals
  (let ((*rap-notes* '()))
    (with-simulation ((rapper rapper-2) :seed 1)
      (install-goal '(rap-whose) 3 nil rapper-2)
      (install-goal '(rap-whose) 2 nil 'rapper)
      (install-goal '(rap-whose) 1)
      (signals unknown-name (install-goal '(rap-whose) 1 nil 'nobody))
      (is (= 2 (run-plan 'work-on-agenda :robot rapper)))
      (is (equal '(rapper rapper) (mapcar #'second *rap-notes*)))
      (is (equal '(:waiting :achieved :achieved) (goal-states)))
      (install-goal '(rap-use x 4) 0 nil rapper)
      (install-goal '(rap-use y 4) 0 nil rapper-2)
      (begin-plan 'work-on-agenda :robot rapper)
      (is (= 2 (run-plan 'work-on-agenda :robot rapper-2)))
      (is (equal '((5 x) (5 y)) (sort (subseq *rap-notes* 0 2) #'string< :key #'second))))))

;;; Copies.

(test rap-agenda.goals-of-a-run-that-was-saved-without-its-plans-wait-again
  (ars-magna.tests::with-temporary-file (file)
    (in-rap-run
      (install-goal '(rap-work a 40))
      (begin-plan 'work-on-agenda)
      (run-ticks 10)
      (handler-bind ((error (lambda (condition)
                              (invoke-restart (find-restart 'save-without condition)))))
        (save-simulation file)))
    (let ((*rap-notes* '()))
      (with-loaded-simulation (file)
        (is (equal '(:active) (goal-states)))
        (is (= 1 (process-goal-agenda)))
        (is (equal '((50 a)) *rap-notes*))))))

(test rap-agenda.changes-of-goals-are-exact-in-forks-and-rewinds
  (with-simulation ((rapper rapper-2) :seed 1 :keep t)
    (let ((*rap-notes* '()))
      (flet ((outcome () (list main-memory* (agenda-goals) (state-digest)))
             (go-on ()
               (install-goal '(rap-use urgent 3) 9 nil rapper)
               (run-ticks 2)
               (remove-goal 2)
               (set-goal-priority 1 4)
               (run-ticks 20)))
        (install-goal '(rap-use slow 6) 1 40)
        (install-goal '(rap-clean-up b) 0)
        (install-goal '(rap-use y 30) 0 20 rapper-2)
        (begin-plan 'work-on-agenda :robot rapper)
        (begin-plan 'work-on-agenda :robot rapper-2)
        (run-ticks 3)
        (let* ((goals (mapcar #'first main-agenda*))
               (states (list (goal-states) (state-digest)))
               (ahead (with-fork () (go-on) (list (goal-states) (mapcar #'first main-memory*)))))
          (is (equal states (list (goal-states) (state-digest))))
          (go-on)
          (is (equal ahead (list (goal-states) (mapcar #'first main-memory*))))
          (let ((end (outcome)))
            (run-ticks 5)
            (rewind 5)
            (is (equal (rest (rest end)) (rest (rest (outcome))))))
          (rewind 22)
          (is (equal states (list (goal-states) (state-digest))))
          (go-on)
          (is (equal ahead (list (goal-states) (mapcar #'first main-memory*))))
          (is (equal '(1 2 3) goals)))))))

;;; Threads.

(test rap-agenda.threads-and-plans-lose-no-goal
  (in-live-rap-run
    (let ((run (current-simulation)))
      (install-goal '(rap-attend))
      (begin-plan 'work-on-agenda)
      (mapc #'ars-magna.base:join-thread
            (loop for thread below 3
                  collect (let ((thread thread))
                            (ars-magna.base:start-thread
                             (lambda ()
                               (dotimes (n 6)
                                 (asking (run)
                                   (set-goal-priority
                                    (install-goal (list 'rap-work (list thread n) 1)) n))))
                             "installing"))))
      (set-value *rap-signal* t)
      (await-idle)
      (set-value *rap-signal* nil)
      (is (= 18 (length (memory-query '?n '(done ?n)))))
      (is (null (agenda-goals '(:waiting :active)))))))
