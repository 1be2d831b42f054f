;;;; rpl-valves.lisp -- valves: priorities, preemption, several at once.

(in-package :ars-magna.tests)
(in-suite rpl)

(test valve.who-has-it-and-who-wants-it
  (let ((hand (rpl:make-valve 'hand)) (seen '()))
    (flet ((look () (push (list (rpl:task-name (rpl:valve-owner hand))
                                (mapcar #'rpl:task-name (rpl:valve-requests hand))
                                (mapcar #'rpl:task-name (rpl:valve-losers hand)))
                          seen)))
      (plan-value
        (rpl:par (:tag a (rpl:with-valve (hand) (rpl:wait-time 5)))
                 (:tag b (rpl:with-valve (hand) 1))
                 (:tag c (rpl:with-valve (hand :priority -1) 1))
                 (:tag d (rpl:wait-time 1) (rpl:with-valve (hand) 1))
                 (:tag e (rpl:wait-time 2)
                   (rpl:with-valve (hand :priority 1) (look) (rpl:wait-time 1)))
                 (rpl:seq (rpl:wait-time 1) (rpl:wait-time 0) (look)))))
    (is (equal '((a (b d c) ()) (e (b d c) (a))) (reverse seen)))
    (is (null (rpl:valve-owner hand)))
    (is (string= "#<valve HAND>" (princ-to-string hand)))))

(test with-valve.a-higher-priority-takes-it
  "The owner is suspended, with its parts, until it is given back; what it waits for counts."
  (let ((hand (rpl:make-valve 'hand)))
    (is (equal '((:stop 2) (:urgent 2) (:suspended 3) (:back 6) (:part 6) (:owner 6) (:next 6))
               (with-log (note)
                 (plan-value
                   (rpl:par (:tag owner
                              (rpl:with-valve (hand)
                                (rpl:on-suspension (note :stop)
                                  (rpl:par (rpl:seq (rpl:wait-time 5) (note :owner))
                                           (rpl:seq (rpl:wait-time 4) (note :part))))))
                            (rpl:seq (rpl:wait-time 1) (rpl:with-valve (hand) (note :next)))
                            (rpl:seq (rpl:wait-time 2)
                                     (rpl:with-valve (hand :priority 5)
                                       (note :urgent)
                                       (rpl:wait-time 4)
                                       (note :back)))
                            (rpl:seq (rpl:wait-time 3)
                                     (note (rpl:fluent-value (rpl:task-status owner)))))))))))

(test with-valve.the-owner-may-start-anew
  (let ((hand (rpl:make-valve 'hand)))
    (is (equal '((:begin 0) (:undone 2) (:begin 4) (:undone 7))
               (with-log (note)
                 (plan-value
                   (rpl:par (rpl:with-valve (hand)
                              (rpl:retry-after-suspension
                                (note :begin)
                                (rpl:evap-protect (rpl:wait-time 3) (note :undone))))
                            (rpl:seq (rpl:wait-time 2)
                                     (rpl:with-valve (hand :priority 1) (rpl:wait-time 2))))))))))

(test with-valve.three-priorities
  (let ((hand (rpl:make-valve 'hand)))
    (is (equal '((:low 0) (:middle 1) (:high 2) (:high 3) (:middle 5) (:low 6))
               (with-log (note)
                 (plan-value
                   (rpl:par-loop (job '((:low 0 6) (:middle 1 4) (:high 2 1)))
                     (destructuring-bind (name priority span) job
                       (rpl:wait-time priority)
                       (rpl:with-valve (hand :priority priority)
                         (note name)
                         (rpl:wait-time span)
                         (note name))))))))
    (is (null (rpl:valve-owner hand)))))

(test with-valve.who-is-preempted-and-killed-cleans-up
  (let ((hand (rpl:make-valve 'hand)))
    (is (equal '((:killed 2) (:cleaned 3) (:urgent 5) (:third 5))
               (with-log (note)
                 (plan-value
                   (rpl:par (:tag owner
                              (rpl:with-valve (hand)
                                (rpl:evap-protect (rpl:wait-time 9)
                                  (rpl:seq (rpl:wait-time 1) (note :cleaned)))))
                            (rpl:seq (rpl:wait-time 1)
                                     (rpl:with-valve (hand :priority 1)
                                       (rpl:wait-time 4)
                                       (note :urgent)))
                            (rpl:seq (rpl:wait-time 2) (note :killed) (rpl:evaporate owner)
                                     (rpl:with-valve (hand) (note :third))))))))
    (is (null (rpl:valve-owner hand)))
    (is (null (rpl:valve-losers hand)))))

(test with-valve.cleanups-are-not-disturbed
  (let ((hand (rpl:make-valve 'hand)))
    (is (equal '((:cleaned 5) (:urgent 5))
               (with-log (note)
                 (plan-value
                   (rpl:par (:tag owner
                              (rpl:with-valve (hand)
                                (rpl:evap-protect (rpl:wait-time 9)
                                  (rpl:seq (rpl:wait-time 4) (note :cleaned)))))
                            (rpl:seq (rpl:wait-time 1) (rpl:evaporate owner)
                                     (rpl:wait-time 1)
                                     (rpl:with-valve (hand :priority 1) (note :urgent))))))))))

(test with-valve.a-circle-through-preemption-is-reported
  (let ((base:*message-queue* (base:make-message-queue))
        (hand (rpl:make-valve 'hand)) (camera (rpl:make-valve 'camera)))
    (is (eq :deadlock
            (nth-value 1 (rpl:run-plan-alone
                          (rpl:interp-lambda ()
                            (rpl:par (rpl:with-valves (hand camera :priority 1)
                                       (rpl:wait-time 3))
                                     (rpl:seq (rpl:wait-time 1)
                                              (rpl:with-valve (hand :priority 2)
                                                (rpl:with-valve (camera) 1)))))))))
    (let ((texts (mapcar #'base:message-text (base:take-messages))))
      (is (search "Deadlock at tick 1" (first texts)))
      (is (search "camera" (first texts)))
      (is (search "gives back" (first texts))))))

(test with-valve.arguments
  (signals-failure base:wrong-argument (rpl:with-valve (3) 1))
  (signals-failure base:wrong-argument (rpl:with-valve ((rpl:make-valve 'v) :priority :high) 1))
  (is (eq :yes (plan-value (let ((v (rpl:make-valve 'v)))
                             (rpl:with-valve ((rpl:seq (rpl:wait-time 1) v)
                                              :priority (rpl:seq (rpl:wait-time 1) 2))
                               :yes))))))

;;; Several at once.

(test with-valves.all-or-none
  (let ((a (rpl:make-valve 'a)) (b (rpl:make-valve 'b)))
    (is (equal '((:b-free 1) (:got-b 1) (:both 5))
               (with-log (note)
                 (plan-value
                   (rpl:par (rpl:with-valve (a) (rpl:wait-time 4))
                            (rpl:seq (rpl:wait-time 1) (rpl:wait-time 0)
                                     (unless (rpl:valve-owner b) (note :b-free))
                                     (rpl:with-valve (b) (note :got-b) (rpl:wait-time 4)))
                            (rpl:with-valves (b a) (note :both)))))))
    (is (null (rpl:valve-owner a)))
    (is (null (rpl:valve-requests b)))))

(test with-valves.philosophers-do-not-starve-each-other
  "Whatever the order in which they want their forks, all eat."
  (let ((forks (coerce (loop for i below 5 collect (rpl:make-valve i)) 'vector)) (meals 0))
    (plan-value
      (rpl:par-loop (i '(0 1 2 3 4))
        (rpl:n-times 20
          (rpl:with-valves ((aref forks i) (aref forks (mod (1+ i) 5)))
            (rpl:wait-time 1)
            (incf meals)))))
    (is (= 100 meals))
    (is (every (lambda (fork) (null (rpl:valve-owner fork))) forks))))

(test with-valves.none-the-same-twice-and-nested
  (let ((a (rpl:make-valve 'a)) (b (rpl:make-valve 'b)))
    (is (eq :none (plan-value (rpl:with-valves () :none))))
    (is (eq :twice (plan-value (rpl:with-valves (a a) :twice))))
    (is (eq :inner (plan-value (rpl:with-valve (a)
                                 (rpl:par (rpl:with-valves (a b) (rpl:wait-time 1) :inner))))))
    (is (eq :later (plan-value (rpl:with-valves ((rpl:seq (rpl:wait-time 1) a) b :priority 1)
                                 :later))))
    (is (null (rpl:valve-owner a)))
    (is (null (rpl:valve-owner b)))))

;;; Parts of an owner.

(defmacro log-under-valve ((note valve) &body branches)
  "Return what BRANCHES note by NOTE, run side by side by a task that owns VALVE."
  `(let ((,valve (rpl:make-valve 'hand)))
     (with-log (,note)
       (plan-value (rpl:with-valve (,valve) (rpl:par ,@branches)))
       (is (null (rpl:valve-owner ,valve))))))

(test with-valve.one-part-of-an-owner-at-a-time
  (is (equal '((:a 0) (:a-too 0) (:b 2) (:b-done 3))
             (log-under-valve (note hand)
               (rpl:with-valve (hand)
                 (note :a)
                 (rpl:with-valve (hand) (note :a-too) (rpl:wait-time 2)))
               (rpl:with-valve (hand) (note :b) (rpl:wait-time 1) (note :b-done))))))

(test with-valve.a-part-of-a-part
  "Nor do those two levels below the owner have it at once with those beside it."
  (is (equal '((:a 0) (:b 1) (:c 2))
             (log-under-valve (note hand)
               (rpl:par (rpl:with-valve (hand)
                          (rpl:par (rpl:with-valve (hand) (note :a) (rpl:wait-time 1))
                                   (rpl:with-valve (hand) (note :b) (rpl:wait-time 1)))))
               (rpl:seq (rpl:wait-time 1) (rpl:with-valve (hand) (note :c)))))))

(test with-valve.parts-have-priorities-among-themselves
  "Who is not of the owner goes by the owner's: it is suspended with all of its parts."
  (is (equal '((:a 0) (:b 1) (:b 3) (:a 4))
             (log-under-valve (note hand)
               (rpl:with-valve (hand) (note :a) (rpl:wait-time 4) (note :a))
               (rpl:seq (rpl:wait-time 1)
                        (rpl:with-valve (hand :priority 1)
                          (note :b) (rpl:wait-time 2) (note :b))))))
  (let ((hand (rpl:make-valve 'hand)))
    (is (equal '((:taken 3) (:back 5) (:part 5) (:beside 5) (:middle 5))
               (with-log (note)
                 (plan-value
                   (rpl:par (rpl:with-valve (hand :priority 2)
                              (rpl:par (rpl:with-valve (hand) (rpl:wait-time 4) (note :part))
                                       (rpl:seq (rpl:wait-time 4) (note :beside))))
                            (rpl:seq (rpl:wait-time 1)
                                     (rpl:with-valve (hand :priority 1) (note :middle)))
                            (rpl:seq (rpl:wait-time 3)
                                     (rpl:with-valve (hand :priority 3)
                                       (note :taken) (rpl:wait-time 2) (note :back))))))))
    (is (null (rpl:valve-owner hand)))
    (is (null (rpl:valve-losers hand)))))

(test with-valve.a-circle-of-parts-is-reported
  (let ((base:*message-queue* (base:make-message-queue))
        (hand (rpl:make-valve 'hand)) (eye (rpl:make-valve 'eye)))
    (rpl:run-plan-alone
     (rpl:interp-lambda ()
       (rpl:with-valves (hand eye)
         (rpl:par (:tag left (rpl:with-valve (hand) (rpl:wait-time 1) (rpl:with-valve (eye) 1)))
                  (:tag right (rpl:with-valve (eye)
                                (rpl:wait-time 1) (rpl:with-valve (hand) 1)))))))
    (is-true (has-words-p (base:message-text (first (base:take-messages)))
                          "left waits for the valve eye that right has"
                          "right waits for the valve hand that left has"))
    (is (null (rpl:valve-owner hand)))))

(test with-valve.a-circle-that-closes-when-a-part-ends-is-reported-then
  "As long as a part of the owner goes on, it may be what helps."
  (let ((base:*message-queue* (base:make-message-queue))
        (hand (rpl:make-valve 'hand)) (eye (rpl:make-valve 'eye)))
    (rpl:run-plan-alone
     (rpl:interp-lambda ()
       (rpl:pursue (rpl:par (rpl:with-valve (hand)
                              (rpl:par (rpl:wait-time 5)
                                       (:tag left (rpl:wait-time 1) (rpl:with-valve (eye) 1))
                                       (rpl:wait-time 3)))
                            (:tag right (rpl:with-valve (eye)
                                          (rpl:wait-time 2) (rpl:with-valve (hand) 1))))
                   (rpl:wait-time 9))))
    (let ((texts (mapcar #'base:message-text (base:take-messages))))
      (is (= 1 (length texts)))
      (is-true (has-words-p (first texts) "Deadlock at tick 5" "left waits for the valve eye"
                            "right waits for the valve hand")))))

(test with-valve.a-part-that-waits-for-another-is-reported
  (let ((base:*message-queue* (base:make-message-queue)) (hand (rpl:make-valve 'hand)))
    (rpl:run-plan-alone
     (rpl:interp-lambda ()
       (let ((done (rpl:create-fluent 'done)))
         (rpl:with-valve (hand)
           (rpl:par (:tag left (rpl:with-valve (hand) (rpl:wait-for done)))
                    (:tag right (rpl:with-valve (hand) (rpl:set-value done t))))))))
    (is-true (has-words-p (base:message-text (first (base:take-messages)))
                          "the valve hand that left has" "right"))))

;;; An owner that begins something anew gives up what a part of it has of the valve it loses.

(defmacro while-taken (form)
  "Return what FORM notes, and when, and who runs beside it that takes its valve, HAND, at 1 until
7. It can note by NOTE; the valve EYE is free."
  `(let ((hand (rpl:make-valve 'hand)) (eye (rpl:make-valve 'eye)))
     (declare (ignorable eye))
     (prog1 (with-log (note)
              (plan-value (rpl:par ,form
                                   (rpl:seq (rpl:wait-time 1)
                                            (rpl:with-valve (hand :priority 1)
                                              (note :taken) (rpl:wait-time 6) (note :back))))))
       (is (null (rpl:valve-owner hand)))
       (is (null (rpl:valve-losers hand))))))

(test with-valve.an-owner-whose-part-begins-anew-does-not-run
  (is (equal '((:taken 1) (:back 7) (:beside 7) (:beside 9))
             (while-taken (rpl:with-valve (hand)
                            (rpl:par (rpl:n-times 2 (rpl:wait-time 2) (note :beside))
                                     (rpl:retry-after-suspension
                                       (rpl:with-valve (hand) (rpl:wait-time 2)))))))))

(test with-valve.an-owner-whose-part-begins-anew-does-not-go-on
  (is (equal '((:taken 1) (:back 7) (:after 7))
             (while-taken (rpl:with-valve (hand)
                            (rpl:pursue (rpl:wait-time 3)
                                        (rpl:retry-after-suspension
                                          (rpl:with-valve (hand) (rpl:wait-time 9))))
                            (note :after)))))
  (is (equal '((:taken 1) (:back 7) (:late 7))
             (while-taken (rpl:with-valve (hand)
                            (rpl:handle-failure ((rpl:deadline-missed () (note :late) (return)))
                              (rpl:with-deadline (3)
                                (rpl:retry-after-suspension
                                  (rpl:with-valve (hand) (rpl:wait-time 9))))))))))

(test with-valves.an-owner-whose-part-begins-anew-does-not-go-on
  (is (equal '((:taken 1) (:back 7) (:after 7))
             (while-taken (rpl:with-valves (eye hand)
                            (rpl:pursue (rpl:wait-time 3)
                                        (rpl:retry-after-suspension
                                          (rpl:with-valves (hand eye) (rpl:wait-time 9))))
                            (note :after))))))

(test with-valve.a-whole-loses-what-parts-took-from-each-other
  "Of three parts one has taken the valve from another when somebody else takes it from all."
  (is (equal '((:part 0) (:taken 1) (:back 7) (:beside 7) (:part-ends 8) (:other-ends 8))
             (while-taken (rpl:with-valve (hand)
                            (rpl:par (rpl:with-valve (hand :priority -1)
                                       (rpl:wait-time 2) (note :other-ends))
                                     (rpl:with-valve (hand)
                                       (note :part) (rpl:wait-time 8) (note :part-ends))
                                     (rpl:seq (rpl:wait-time 3) (note :beside))))))))

(test with-valves.who-has-lost-one-takes-none
  "A part that waits for two, while its whole has lost one of them, takes that from nobody."
  (let ((hand (rpl:make-valve 'hand)) (eye (rpl:make-valve 'eye)))
    (is (equal '((:taken 2) (:back 12) (:part 12) (:beside 12))
               (with-log (note)
                 (plan-value
                   (rpl:par (rpl:with-valve (eye :priority 9) (rpl:wait-time 4))
                            (rpl:with-valve (hand)
                              (rpl:par (rpl:seq (rpl:wait-time 1)
                                                (rpl:with-valves (hand eye :priority 5)
                                                  (note :part)))
                                       (rpl:seq (rpl:wait-time 8) (note :beside))))
                            (rpl:seq (rpl:wait-time 2)
                                     (rpl:with-valve (hand :priority 1)
                                       (note :taken) (rpl:wait-time 10) (note :back))))))))))

;;; Many.

(defun calls-of (name function)
  "Return how often the function called NAME is called while FUNCTION is."
  (let ((calls 0))
    (host:wrap-function name
                        (lambda (function &rest arguments)
                          (incf calls)
                          (apply function arguments))
                        'test)
    (unwind-protect (funcall function)
      (host:unwrap-function name 'test))
    calls))

(defun looks-of-queue (count)
  "Return how often it is asked whether a claim can be granted while COUNT tasks have a valve."
  (let ((valve (rpl:make-valve 'hand)))
    (calls-of 'constructs::available-p
              (lambda ()
                (plan-value (rpl:par-loop (i (make-list count))
                              (rpl:with-valve (valve) (rpl:wait-time 1))))))))

(defun looks-of-queue-for-two (count)
  "Do as LOOKS-OF-QUEUE does for tasks that each want two valves."
  (let ((hand (rpl:make-valve 'hand)) (eye (rpl:make-valve 'eye)))
    (calls-of 'constructs::available-p
              (lambda ()
                (plan-value (rpl:par-loop (i (make-list count))
                              (rpl:with-valves (hand eye) (rpl:wait-time 1))))))))

(defun order-of-queue (priorities)
  "Return PRIORITIES in the order in which tasks with those have a valve that another had first."
  (let ((valve (rpl:make-valve 'hand)) (order '()))
    (plan-value (rpl:par (rpl:with-valve (valve :priority 1000000) (rpl:wait-time 2))
                         (rpl:par-loop (priority priorities)
                           (rpl:with-valve (valve :priority priority)
                             (push priority order)
                             (rpl:wait-time 0)))))
    (nreverse order)))

(test with-valve.to-queue-takes-little-with-as-many-priorities
  (flet ((priorities (count)
           ;; Rising, falling, mixed.
           (append (loop for i below count collect i)
                   (loop for i below count collect (- i))
                   (loop for i below count collect (+ 1/2 (mod (* i 7919) count))))))
    (is (equal (sort (priorities 40) #'>) (order-of-queue (priorities 40))))
    (is (< (calls-of 'constructs::line-before-p (lambda () (order-of-queue (priorities 400))))
           (* 1200 100)))))

(test with-valve.to-queue-takes-the-same-however-many-do
  (is (< (looks-of-queue 1000) 10000))
  (is (< (looks-of-queue 2000) 20000))
  (is (< (looks-of-queue-for-two 1000) 10000))
  (is (< (looks-of-queue-for-two 2000) 20000)))
