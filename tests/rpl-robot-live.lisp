;;;; rpl-robot-live.lisp -- plans in a thread of their own beside a simulator that does not wait.

(in-package :ars-magna.tests)
(in-suite rpl-robot)

;;; No test here waits for a length of time. Each waits for events, with a limit.

(defun await (fact)
  "Wait until FACT, a function, returns true; return that, or NIL if it does not come."
  (loop with never = (base:make-semaphore "never")
        repeat 1000
          thereis (funcall fact)
        do (base:wait-on-semaphore never 0.01)))

(defmacro awaiting (fact) `(is-true (await (lambda () ,fact)) "~S" ',fact))

(defun call-live (function rate)
  (let ((driver::*default-interface* nil) (time:*simulation* nil))
    (with-messages
      (let* ((simulation (run:fresh-simulation '(fitter) :seed 3))
             (time:*simulation* simulation)
             (robot (first (run:simulation-robots simulation))))
        (progv '(fitter) (list robot)
          (run:start-clock simulation :rate rate)
          (driver:rpl-init-robot robot)
          (unwind-protect (funcall function simulation)
            (run:stop-clock simulation)
            (driver::close-interface driver::*default-interface*)))))))

(defmacro live ((simulation &key (rate :free)) &body body)
  "Run BODY while a fresh SIMULATION of FITTER runs live, at RATE."
  `(call-live (lambda (,simulation) (declare (ignorable ,simulation)) ,@body) ,rate))

(test await-idle.waits-for-plans-that-go-on-by-themselves
  "Neither too short, between two commands of a plan, nor too long, when its last step takes no
tick."
  (dolist (thinking '(:real :free))
    (live (simulation :rate 1000)
      (run:set-thinking thinking simulation)
      (loop repeat 5
            do (let ((task (driver:begin-plan
                            (rpl:make-plan '(rpl:seq (rpl:n-times 3
                                                      (driver:rpl-robot-turn .1d0)
                                                      (rpl:wait-for driver:robot-stopped*))
                                                     (rpl:wait-time 1))))))
                 (is-true (run:await-idle simulation))
                 (is (eq :succeeded (rpl:task-state task))))))))

(test live.a-plan-drives-the-robot
  (live (simulation)
    (is (equal '(:done :succeeded)
               (multiple-value-list
                (run-as-plan
                  (rpl:n-times 20
                    (driver:rpl-robot-turn 1)
                    (rpl:wait-for driver:robot-stopped*)
                    (rpl:wait-time 2))
                  :done))))
    (is (typep (run-as-plan (rpl:fail :class :oops)) 'rpl:plan-failure))
    (awaiting (null (driver::interface-thread driver::*default-interface*)))))

(test live.the-plan-has-its-own-thread
  (live (simulation)
    (let ((here (base:current-thread)))
      (destructuring-bind (plan-thread simulator-thread)
          (run-as-plan
            (driver:rpl-robot-place)
            (rpl:wait-for driver:robot-place-input*)
            (list (base:current-thread) (run:simulation-thread simulation)))
        (is (not (eq plan-thread here)))
        (is (not (eq plan-thread simulator-thread)))
        (is (eq simulator-thread (run:simulation-thread simulation)))))))

(test live.a-plan-begins-in-the-tick-that-it-is
  "No plan has reacted meanwhile."
  (live (simulation)
    (let ((ticks '()))
      (flet ((begin ()
               (driver:begin-plan (rpl:interp-lambda () (rpl:wait-time 1)))
               (push (rpl:plan-runner-tick (driver:rpl-runner)) ticks)))
        (begin)
        (awaiting (null (driver:plans)))
        (let ((before (run:simulation-tick simulation)))
          (command:robot-turn (symbol-value 'fitter) 30)
          (awaiting (< (+ before 5) (run:simulation-tick simulation)))
          (begin)
          (is (< (+ before 5) (first ticks))))))))

(test live.waiting-costs-nothing
  "While its plans wait, the thread does not run, whatever number of ticks pass."
  (live (simulation)
    (let ((runner (driver:rpl-runner))
          (task (driver:begin-plan (rpl:interp-lambda ()
                                   (rpl:wait-for (svref driver:hand-lost* 0))))))
      (awaiting (eq :waiting (rpl:task-state task)))
      (let ((steps (rpl:runner-steps runner))
            (tick (run:simulation-tick simulation)))
        (command:robot-turn fitter 30)
        (awaiting (> (run:simulation-tick simulation) (+ 10 tick)))
        (is (= steps (rpl:runner-steps runner))))
      (driver:end-plan task)
      (awaiting (eq :evaporated (rpl:task-state task))))))

(test live.plans-may-ask-the-simulator
  "The owner never waits for plans, so a plan may wait for the owner."
  (live (simulation)
    (is (eq :moved (run-as-plan
                     (rpl:n-times 20
                       (world:move-thing
                        (world:find-thing 'ball (robot:robot-world (driver:rpl-robot)))
                        (list 2.5 2.5))
                       (driver:rpl-robot-turn .1)
                       (rpl:wait-for driver:robot-stopped*))
                     :moved)))))

(test live.two-hundred-plans-hear-one-pulse
  (live (simulation)
    (let* ((order (make-array 0 :adjustable t :fill-pointer t))
           (tasks (loop for number from 1 to 200
                        collect (driver:begin-plan 'waiter number order))))
      (awaiting (every (lambda (task) (eq :waiting (rpl:task-state task))) tasks))
      (driver:rpl-robot-turn 1)
      (awaiting (every #'rpl:task-over-p tasks))
      (is (= 400 (length order)))
      (is (equal (loop for number from 1 to 200 collect number)
                 (loop for number across order when (plusp number) collect number))))))

(test live.a-plan-waits-on-for-what-somebody-may-bring-about
  "A warning says what that is; who sets it lets the plan go on."
  (live (simulation)
    (let* ((go (rpl:create-fluent 'go-ahead)) (result nil)
           (thread (base:start-thread
                    (base:function-with-specials
                     (lambda ()
                       (setf result (multiple-value-list (run-as-plan (rpl:wait-for go)))))
                     'driver::*default-interface* 'time:*simulation* 'base:*message-queue*)
                    "runner")))
      (awaiting (find-if (lambda (text) (search "wait for events that neither" text))
                         (mapcar #'base:message-text (base:take-messages))))
      (rpl:set-value go :ahead)
      (base:join-thread thread)
      (is (equal '(:ahead :succeeded) result))
      (awaiting (null (driver:plans))))))

(test live.a-stopped-simulator-ends-the-waiting
  (live (simulation)
    (let ((ended (base:make-semaphore "ended")) (state nil)
          (interface driver::*default-interface*))
      (base:start-thread
       (base:function-with-specials
        (lambda ()
          (setf state (nth-value 1 (run-as-plan
                                     (loop (driver:rpl-robot-turn 1)
                                           (rpl:wait-for driver:robot-stopped*)))))
          (base:signal-semaphore ended))
        'driver::*default-interface* 'time:*simulation* 'base:*message-queue*)
       "runs a plan")
      (awaiting (> (run:simulation-tick simulation) 20))
      (run:stop-clock simulation)
      (is-true (base:wait-on-semaphore ended 30))
      (is (eq :stopped state))
      (is-true (driver::interface-valid-p interface))
      (awaiting (null (rpl:plan-runner-tasks (driver:rpl-runner))))
      (run:start-clock simulation :rate :free)
      (is (eq 5 (run-as-plan (rpl:wait-time 3) 5)) "and it goes on after a new start"))))

(defun call-resident (function)
  "Call FUNCTION while the resident FITTER runs live."
  (let ((driver::*default-interface* driver::*default-interface*)
        (time:*simulation* time:*simulation*)
        (*standard-output* (make-broadcast-stream)))
    (with-messages
      (unwind-protect
           (progn (run:simulator fitter :rate :free)
                  (driver:rpl-init-robot fitter)
                  (funcall function))
        (run:stop-simulator)))))

(test live.a-restarted-simulator-ends-old-plans
  "Also if they try a command before they hear of it."
  (call-resident
   (lambda ()
     (let ((task (driver:begin-plan (rpl:interp-lambda ()
                                      (loop (driver:rpl-robot-turn 1)
                                            (rpl:wait-for driver:robot-stopped*))))))
       (awaiting (> (run:simulation-tick) 20))
       (run:simulator fitter :rate :free)
       (awaiting (rpl:task-over-p task))
       (is (eq :evaporated (rpl:task-state task)))
       (signals base:misuse (driver:rpl-robot-turn 1))
       (is (eq :fine (run-as-plan (driver:rpl-robot-turn 1)
                                  (rpl:wait-for driver:robot-stopped*)
                                  :fine)))))))

(defun define-fitter-anew ()
  (robot:define-robot 'fitter 'workbench '(3.5 5.5) 0
                      :cameras (list (list (* 2 pi) 5) '(1 3)) :hands '(5 5) :bins '(10 1)))

(test live.a-robot-defined-anew-ends-what-waits-for-it
  "A plan that waits for the end of a command does not take its interruption for that."
  (call-resident
   (lambda ()
     (time:pause)
     (let ((task (driver:begin-plan (rpl:interp-lambda ()
                                      (driver:rpl-robot-turn 1)
                                      (rpl:wait-for driver:robot-stopped*)
                                      :fine))))
       (define-fitter-anew)
       (awaiting (rpl:task-over-p task))
       (is (eq :evaporated (rpl:task-state task)))))))

(test live.a-robot-defined-anew-ends-its-plans
  "Also if they try a command before they hear of it."
  (call-resident
   (lambda ()
     (let ((task (driver:begin-plan (rpl:interp-lambda ()
                                      (loop (driver:rpl-robot-turn 1)
                                            (rpl:wait-for driver:robot-stopped*))))))
       (awaiting (> (run:simulation-tick) 20))
       (define-fitter-anew)
       (awaiting (rpl:task-over-p task))
       (is (eq :evaporated (rpl:task-state task)))
       (driver:rpl-init-robot fitter)
       (is (eq :fine (run-as-plan (driver:rpl-robot-turn 1)
                                  (rpl:wait-for driver:robot-stopped*)
                                  :fine)))))))

(test live.run-plan-not-in-the-simulators-thread
  (live (simulation)
    (let ((trouble nil) (answered (base:make-semaphore "answered"))
          (interface driver::*default-interface*))
      (command:robot-turn fitter .1
                          (lambda (&rest ignore)
                            (declare (ignore ignore))
                            (let ((driver::*default-interface* interface))
                              (handler-case (run-as-plan 1)
                                (base:misuse (condition) (setf trouble condition))))
                            (base:signal-semaphore answered)))
      (is-true (base:wait-on-semaphore answered 30))
      (is-true trouble))))

;;; Plans that never wait, and code that never returns.

(defvar *stop* nil "True when what tests keep going for ever is to end all the same.")

(rpl:def-interp-proc never-waiting ()
  "Take step after step."
  (loop UNTIL *stop* (rpl:seq (rpl:task-state (rpl:current-task)))))

(defun stay-here ()
  (loop until *stop*))

(rpl:def-interp-proc never-returning ()
  "Be at one expression for ever."
  (rpl:seq (stay-here)))

(defmacro with-quick-watch (() &body body)
  "Run BODY, in which it takes little to be named as a hog."
  `(let ((before time:*hog-seconds*))
     (unwind-protect (progn (setf time:*hog-seconds* 0.05 *stop* nil) ,@body)
       (setf time:*hog-seconds* before *stop* t))))

(defun queued-text-p (text)
  "True if a message that is queued contains TEXT; none is taken."
  (some (lambda (message) (search text (base:message-text message)))
        (definitions::message-queue-newest-first base:*message-queue*)))

(test live.a-plan-that-never-waits-deafens-nobody
  (with-quick-watch ()
    (live (simulation)
      (let ((runaway (driver:begin-plan 'never-waiting)))
        (is (eq :fine (run-as-plan (rpl:n-times 5
                                     (driver:rpl-robot-turn .1)
                                     (rpl:wait-for driver:robot-stopped*))
                                   (rpl:wait-time 3)
                                   :fine)))
        (is-false (rpl:task-over-p runaway))
        (is (search "never-waiting" (with-output-to-string (stream)
                                      (driver:print-plans stream))))
        (driver:end-plan runaway)
        (awaiting (eq :evaporated (rpl:task-state runaway)))))))

(test live.many-steps-come-to-their-end
  "More than a reaction takes: the thread never sleeps while a plan could go on."
  (live (simulation)
    (is (= 2500000 (let ((count 0))
                     (run-as-plan
                       (loop UNTIL (= count 2500000) (rpl:seq (incf count)))
                       count))))))

(test live.code-that-does-not-return-is-named-and-ended
  (with-quick-watch ()
    (live (simulation)
      (let ((task (driver:begin-plan 'never-returning)))
        (awaiting (queued-text-p "never-returning has kept the plans' thread"))
        (is-false (rpl:task-over-p task))
        (signals base:misuse (driver:print-plans (make-broadcast-stream)))
        (signals base:misuse (driver:begin-plan 'turned 1))
        (driver:end-plan task)
        (awaiting (rpl:task-over-p task))
        (is (eq :evaporated (rpl:task-state task)))
        (is (eq :fine (run-as-plan (turned .1) :fine)))))))

(test live.who-has-gone-on-keeps-the-thread-no-longer
  "Though who watches has not looked since."
  (live (simulation)
    (let ((task (driver:begin-plan (rpl:interp-lambda () (rpl:wait-time 1000000)))))
      (awaiting (eq :waiting (rpl:task-state task)))
      (setf (driver::interface-hog driver::*default-interface*) task)
      (is (eq :fine (run-as-plan (turned .1) :fine)))
      (driver:end-plan task)
      (awaiting (rpl:task-over-p task)))))

(test live.stopping-the-simulator-ends-runaways
  (dolist (plan '(never-waiting never-returning))
    (with-quick-watch ()
      (live (simulation)
        (let ((task (driver:begin-plan plan)))
          (awaiting (eq :running (rpl:task-state task)))
          (run:stop-clock simulation)
          (awaiting (rpl:task-over-p task))
          (awaiting (null (driver::interface-thread driver::*default-interface*)))
          (run:start-clock simulation :rate :free)
          (is (eq :fine (run-as-plan (turned .1) :fine))))))))

(test live.the-simulator-never-waits-for-plans
  (with-quick-watch ()
    (live (simulation)
      (driver:begin-plan 'never-returning)
      (let ((tick (run:simulation-tick simulation)))
        (command:robot-turn fitter 30)
        (awaiting (> (run:simulation-tick simulation) (+ 20 tick)))))))

(test live.an-abort-in-a-leaf-ends-that-plan-only
  (live (simulation)
    (let ((other (driver:begin-plan (rpl:interp-lambda () (rpl:wait-time 30) :done))))
      (is (eq :evaporated (nth-value 1 (run-as-plan (rpl:wait-time 1) (abort)))))
      (awaiting (eq :done (rpl:task-result other))))))

(test live.a-thread-that-was-ended-leaves-no-trace
  "Its plan ends; the others go on in another one."
  (live (simulation)
    (let* ((interface driver::*default-interface*)
           (other (driver:begin-plan (rpl:interp-lambda ()
                                       (loop (rpl:wait-time 1)))))
           (task (driver:begin-plan (rpl:interp-lambda ()
                                      (rpl:wait-time 1)
                                      (base:interrupt-thread (base:current-thread)
                                                             #'sb-thread:abort-thread)
                                      (rpl:wait-time 1)))))
      (awaiting (rpl:task-over-p task))
      (awaiting (not (member (driver::plans-thread interface) '(nil :starting))))
      (is-false (rpl:task-over-p other))
      (driver:end-plan other)
      (awaiting (rpl:task-over-p other))
      (awaiting (null (driver::interface-thread interface)))
      (is (eq :fine (run-as-plan (turned .1) :fine))))))

(test live.run-plan-that-is-left-ends-its-plan
  (live (simulation)
    (let ((cleaned nil) (begun (base:make-semaphore "begun")) (thread nil))
      (setf thread
            (base:start-thread
             (base:function-with-specials
              (lambda ()
                (catch 'out
                  (run-as-plan
                    (rpl:evap-protect (rpl:seq (base:signal-semaphore begun)
                                               (loop (rpl:wait-time 1)))
                                      (setf cleaned t)))))
              'driver::*default-interface* 'time:*simulation* 'base:*message-queue*)
             "runs a plan"))
      (is-true (base:wait-on-semaphore begun 30))
      (base:interrupt-thread thread (lambda () (throw 'out nil)))
      (base:join-thread thread)
      (awaiting cleaned)
      (awaiting (null (driver:plans))))))

(test live.who-keeps-taking-the-robot-waits-for-ticks
  (live (simulation)
    (let ((first (driver:begin-plan 'keep-turning))
          (second (driver:begin-plan 'keep-going)))
      (awaiting (queued-text-p "from each other for ever"))
      (let ((tick (run:simulation-tick simulation)))
        (awaiting (> (run:simulation-tick simulation) (+ 5 tick))))
      (is-false (rpl:task-over-p first))
      (is-false (rpl:task-over-p second))
      (driver:end-plan :all)
      (awaiting (null (driver:plans))))))

(test live.a-plan-that-lets-no-time-pass-fails
  (live (simulation)
    (multiple-value-bind (failure state) (driver:run-plan 'staring)
      (is (eq :failed state))
      (is-true (rushing-failure-p failure)))))
