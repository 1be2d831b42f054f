;;;; messages-plans.lisp -- plans that wait for messages: advice, and causes in the trace.

(in-package :ars-magna.tests)

(in-suite messages)

(rpl:def-interp-proc await-message ()
  (rpl:wait-for driver:robot-heard*)
  (driver:rpl-next-message))

(rpl:def-interp-proc await-four-messages ()
  (rpl:n-times 4 (rpl:wait-for driver:robot-heard*)))

(rpl:def-interp-proc send-twice (to)
  (rpl:n-times 2
    (driver:rpl-robot-send to 'news)
    (rpl:wait-for driver:robot-sent*)))

(rpl:def-interp-proc send-twice-by-snipe ()
  (driver:on-robot ('snipe) (send-twice 'heron)))

(defun told-so-far ()
  "Take all messages of the run, and return their texts as one."
  (joined (mapcar #'base:message-text (base:take-messages))))

;;; Waits in vain.

(defparameter *no-message-words* "No message is on its way, and no plan or command in progress can")

(test deadlock.of-a-wait-for-messages-names-begin-plan
  (on-moor ()
    (driver:begin-plan 'await-message :robot 'snipe)
    (driver:run-plan 'await-message :robot 'heron)
    (let ((told (told-so-far)))
      (is-true (has-words-p told "robot-heard* is pulsed when a message arrives at the robot"
                            *no-message-words*
                            "begin this plan by (begin-plan 'await-message :robot heron)"))
      (is-false (has-words-p told "command of the robot ends") "~A" told)
      (is-false (has-words-p told "To wake the plan") "~A" told)
      (is-false (has-words-p told "SET-VALUE") "~A" told))))

(test deadlock.of-a-wait-for-messages-tells-of-the-mailbox
  (on-moor ()
    (send-and-pass snipe heron 'early)
    (driver:run-plan 'await-message :robot 'heron)
    (let ((told (told-so-far)))
      (is-true (has-words-p told *no-message-words* "The mailbox of heron already has 1 message."
                            "(if (null (rpl-messages)) (wait-for robot-heard*))"))
      (is-false (has-words-p told "begin-plan") "~A" told))))

(test deadlock.of-a-wait-for-messages-of-a-lone-robot-says-so
  (run:with-simulation (heron)
    (driver:run-plan 'await-message)
    (is-true (has-words-p (told-so-far) "The run has no other robot that could send one."))))

(test deadlock.of-two-waits-has-advice-on-both
  (on-moor ()
    (driver:run-plan (rpl:interp-lambda ()
                       (rpl:wait-for (or driver:robot-heard* driver:robot-stopped*)))
                     :robot 'heron)
    (is-true (has-words-p (told-so-far) "robot-stopped* changes when a command of the robot ends"
                          "robot-heard* is pulsed when a message arrives" "BEGIN-PLAN"))))

(test stranded.a-plan-that-waits-for-messages-is-not
  (on-moor ()
    (driver:begin-plan 'await-message :robot 'heron)
    (run:run-ticks 3)
    (is (equal "" (told-so-far)))))

(driver:define-fluents robot
  (robot-whim* "Pulsed by whoever likes to."))

(test deadlock.of-a-fluent-of-no-command-names-set-value
  (on-moor ()
    (driver:run-plan (rpl:interp-lambda () (rpl:wait-for robot-whim*)) :robot 'heron)
    (let ((told (told-so-far)))
      (is-true (has-words-p told "Only SET-VALUE and PULSE change robot-whim*"))
      (is-false (has-words-p told "command of the robot ends") "~A" told))))

(test message.on-its-way-is-no-deadlock
  (on-moor (:parameters '((base:radio-delay* 9)))
    (command:robot-send snipe heron 'late)
    (is (eq 'late (driver:run-plan 'await-message :robot 'heron)))))

(world:defkicker ring-bell (thing) (:prob 1/4)
  (command:robot-send (robot:find-robot 'beadle) 'verger (world:thing-size thing)))

(world:defmap abbey (20 20)
  (obj (bell :kickers (ring-bell)) (9 9) ((:size 1))))

(robot:defrobot beadle (abbey (3 3) 0))
(robot:defrobot verger (abbey (3 9) 0))

(test message.of-a-kicker-is-no-deadlock
  (run:with-simulation ((beadle verger))
    (is (eql 1d0 (driver:run-plan 'await-message :robot 'verger)))))

(test prompt.says-how-to-begin-a-plan-that-waits-for-messages
  (let ((told (type-to 'heron "(def-interp-proc attend () (wait-for robot-heard*))" "plan attend"
                       "robot snipe" "(null (begin-plan 'attend :robot heron))"
                       "send heron 1" "step 3" "plans" "end-plan")))
    (is-true (has-words-p (joined told) "attend is in a deadlock and was stopped"
                          *no-message-words*
                          "begin this plan by (begin-plan 'attend :robot heron)"))
    (is (string= "No plan is under way. PLAN lists all plans." (first (last told 2))))
    (is-true (has-words-p (first (last told)) "There is no command END-PLAN. STOP-PLAN ends all"
                          "(end-plan plan)"))))

;;; Causes in the trace.

(defmacro with-plan-traces (() &body body)
  `(let ((driver:*trace-plans* t)) ,@body))

(defun reasons-of-waking (task)
  "Return the sentences of WHY on what woke TASK, the oldest first."
  (reverse (remove-if-not (lambda (line) (search "because robot-heard*" line))
                          (lines-of (with-output-to-string (out) (rpl:why task :stream out))))))

(defun reasons-in-run (listener sender robot &rest arguments)
  "Begin LISTENER on HERON, and SENDER on ROBOT. Return what woke LISTENER."
  (let ((task (driver:begin-plan listener :robot 'heron)))
    (apply #'driver:begin-plan sender (append arguments (list :robot robot)))
    (run:run-ticks 12)
    (reasons-of-waking task)))

(test why.names-the-message-and-the-command-that-sent-it
  (dolist (delay '(1 4))
    (with-plan-traces ()
      (on-moor (:parameters `((base:radio-delay* ,delay)))
        (destructuring-bind (line) (reasons-in-run 'await-message 'send-twice 'snipe 'heron)
          (is-true (has-words-p line (format nil "At tick ~D it" (+ 2 delay))
                                "pulsed by a message of snipe, sent at tick 2 by"
                                "(rpl-robot-send heron news), which task 2 issued at tick 1")))))))

(defun numbers-of-reason (line)
  "Return the beginning of LINE, and the ticks in which a message was sent and its command issued."
  (flet ((number-after (words)
           (parse-integer line :start (+ (search words line) (length words)) :junk-allowed t)))
    (list (subseq line 0 9) (number-after "sent at tick ") (number-after "issued at tick "))))

(test why.tells-messages-of-one-tick-apart
  (with-plan-traces ()
    (on-moor (:parameters '((base:radio-delay* 3)))
      (driver:begin-plan 'send-twice 'heron :robot 'curlew)
      (let ((lines (reasons-in-run 'await-four-messages 'send-twice 'snipe 'heron)))
        (is (equal '(("At tick 5" 2 1) ("At tick 5" 2 1) ("At tick 6" 3 2) ("At tick 6" 3 2))
                   (mapcar #'numbers-of-reason lines)))
        (dolist (pair (list (subseq lines 0 2) (subseq lines 2 4)))
          (is (= 1 (count-if (lambda (line) (search "of snipe, " line)) pair)))
          (is (= 1 (count-if (lambda (line) (search "of curlew, " line)) pair)))
          (dolist (line pair)
            (is-true (has-words-p line
                                  (if (search "snipe" line) "which task 3" "which task 1")))))))))

(test why.names-the-robot-that-sent-and-not-that-of-the-plan
  (with-plan-traces ()
    (on-moor ()
      (is-true (has-words-p (first (reasons-in-run 'await-message 'send-twice-by-snipe 'curlew))
                            "a message of snipe, sent at tick 2 by" "which task 2 issued")))))

(test why.names-no-command-for-messages-of-programs
  (with-plan-traces ()
    (on-moor ()
      (let ((task (driver:begin-plan 'await-four-messages :robot 'heron)))
        (driver:begin-plan 'send-twice 'curlew :robot 'snipe)
        (run:run-ticks 6)
        (send-and-pass snipe heron 'by-hand)
        (is-true (has-words-p (first (reasons-of-waking task))
                              "pulsed by a message of snipe, sent at tick 7."))))))

(test why.names-messages-in-forks
  (with-plan-traces ()
    (on-moor (:parameters '((base:radio-delay* 3)))
      (let ((task (driver:begin-plan 'await-message :robot 'heron)))
        (driver:begin-plan 'send-twice 'heron :robot 'snipe)
        (run:run-ticks 4)
        (let ((fork (run:fork-simulation)))
          (run:run-ticks 3)
          (run:run-ticks 3 fork)
          (let ((lines (reasons-of-waking task)))
            (is-true (has-words-p (first lines) "which task 2 issued at tick 1"))
            (is (equal lines (run:call-in-fork fork (lambda () (reasons-of-waking 1)))))))))))

(test why.names-messages-in-a-live-run
  (with-plan-traces ()
    (with-stopped-run (heron)
      (run:simulator 'heron :rate :free :display nil)
      (let ((task (driver:begin-plan 'await-message :robot 'heron)))
        (driver:run-plan 'send-twice 'heron :robot 'snipe)
        (run:await-idle)
        (is-true (has-words-p (first (reasons-of-waking task)) "pulsed by a message of snipe, sent"
                              "by (rpl-robot-send heron news), which task 2 issued at tick"))))))
