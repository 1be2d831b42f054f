;;;; forking-live.lisp -- forks of a live run.

(in-package :ars-magna.tests)
(in-suite forking)

(rpl:def-interp-proc pace-for-forks ()
  "Turn and wait, for ever."
  (loop (driver:rpl-robot-turn 1)
        (rpl:wait-for driver:robot-stopped*)
        (rpl:wait-time 2)))

(defmacro with-live-rover ((rate) &body body)
  "Run BODY with the rover live at RATE, driven by PACE-ABOUT."
  `(with-messages
     (unwind-protect (progn (run:simulator 'rover :rate ,rate :display nil)
                            (driver:begin-plan 'pace-for-forks)
                            ,@body)
       (run:stop-simulator (robot:find-robot 'rover))
       (setf driver::*default-interface* nil time:*simulation* nil))))

(defun await-tick (tick)
  (is-true (await (lambda () (<= tick (run:simulation-tick))))))

(test live.forks-of-a-run-at-free-rate
  (with-live-rover (:free)
    (await-tick 20)
    (let ((original time:*simulation*) (ticks '()))
      (loop repeat 5
            do (let ((fork (run:fork-simulation)))
                 (push (run:simulation-tick fork) ticks)
                 (is (null (time:live-p fork)))
                 (is (null (fork-trouble fork 40)))
                 (run:call-in-fork fork (lambda ()
                                          (is (eq fork time:*simulation*))
                                          (is (= 1 (length (driver:plans))))
                                          (is (eq rover (driver:rpl-robot)))))
                 (run:release-fork fork)
                 (await-tick (+ 20 (run:simulation-tick)))))
      (is (apply #'> ticks))
      (is (eq original time:*simulation*))
      (is-true (time:live-p)))))

(test live.forks-of-a-paused-run
  (with-live-rover (:free)
    (await-tick 20)
    (time:pause)
    (is (null (fork-trouble (run:fork-simulation) 40)))
    (let ((tick (run:simulation-tick)))
      (run:with-fork ()
        (run:run-ticks 30)
        (is (= (+ tick 30) (run:simulation-tick))))
      (is (= tick (run:simulation-tick))))))

(defvar *numbers-drawn* '() "What a plan has drawn by CL:RANDOM, the newest first.")

(rpl:def-interp-proc draw-numbers ()
  "Draw a number with each turn, for ever."
  (loop (push (random 1000000) *numbers-drawn*)
        (driver:rpl-robot-turn 1/10)
        (rpl:wait-for driver:robot-stopped*)))

(defun numbers-drawn-in (ticks)
  "Let TICKS pass in the current run, which stands still; return what its plan draws meanwhile."
  (setf *numbers-drawn* '())
  (run:run-ticks ticks)
  (reverse *numbers-drawn*))

(test live.forks-draw-what-their-run-would
  "Plans draw by CL:RANDOM. All forks of a moment draw the same, those of another moment go on."
  (with-messages
    (unwind-protect
         (progn
           (run:simulator 'rover :rate :free :display nil :thinking :free)
           (time:pause)
           (setf *numbers-drawn* '())
           (driver:begin-plan 'draw-numbers)
           (ars:step-ticks 30)
           (is-true (await (lambda () (<= 30 (run:simulation-tick)))))
           (let* ((drawn (length *numbers-drawn*))
                  (fork (run:with-fork () (numbers-drawn-in 30))))
             (is (< 2 drawn))
             (is (< 2 (length fork)))
             (is (equal fork (run:with-fork () (numbers-drawn-in 30))))
             (is (not (equal fork (run:with-fork (:seed 5) (numbers-drawn-in 30)))))
             (setf *numbers-drawn* '())
             (ars:step-ticks 30)
             (is-true (await (lambda () (<= 60 (run:simulation-tick)))))
             (is (equal fork (reverse *numbers-drawn*)))))
      (run:stop-simulator (robot:find-robot 'rover))
      (setf driver::*default-interface* nil time:*simulation* nil))))

(defvar *semaphores* #() "What a plan says when it has begun a long step, and what ends that.")

(test live.a-fork-waits-for-a-plans-long-step
  (with-live-rover (:free)
    (let ((begun (base:make-semaphore "begun")) (go-on (base:make-semaphore "go on")) (forked nil))
      (setf *semaphores* (vector begun go-on))
      (driver:begin-plan (rpl:interp-lambda ()
                           (base:signal-semaphore (svref *semaphores* 0))
                           (base:wait-on-semaphore (svref *semaphores* 1))
                           (rpl:wait-time 1000000)))
      (base:wait-on-semaphore begun)
      (let* ((simulation time:*simulation*)
             (thread (base:start-thread (lambda ()
                                          (setf forked (run:fork-simulation simulation)))
                                        "forks")))
        (base:signal-semaphore go-on)
        (base:join-thread thread)
        (is (= 2 (length (run:call-in-fork forked #'driver:plans))))))))

(test live.a-plan-that-never-rests-makes-way-for-a-fork
  "It takes step after step, and never waits."
  (with-live-rover (50)
    (driver:begin-plan (rpl:interp-lambda () (loop (list 1))))
    (await-tick 5)
    (loop repeat 3
          do (let ((fork (run:fork-simulation)))
               (is (= 2 (length (run:call-in-fork fork #'driver:plans))))
               (run:release-fork fork)))))

(test live.what-cannot-be-forked-is-asked-where-the-fork-is-wanted
  "The restarts are there for handlers of the thread that forks."
  (with-live-rover (:free)
    (let ((log (make-broadcast-stream)))
      (driver:begin-plan (rpl:interp-lambda (log) (rpl:wait-time 1000000) log) log)
      (await-tick 10)
      (signals base:cannot-fork (run:fork-simulation))
      (handler-bind ((base:cannot-fork (lambda (condition)
                                         (is (eq log (base:cannot-fork-value condition)))
                                         (invoke-restart 'base:share-value))))
        (let ((fork (run:fork-simulation)))
          (is (= 2 (length (run:call-in-fork fork #'driver:plans)))))))))
