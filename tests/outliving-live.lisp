;;;; outliving-live.lisp -- live runs continue after errors in users' code and in other threads.

(in-package :ars-magna.tests)

(in-suite outliving)

(defmacro with-live-shrew (&body body)
  "Run BODY with the shrew live, users' code that hangs being noticed soon, and messages collected."
  `(with-messages
     (let ((time:*hog-seconds* .05))
       (unwind-protect (progn (run:simulator 'shrew :rate :free :display nil)
                              ,@body)
         (run:stop-simulator (robot:find-robot 'shrew))))))

(defun live-shrew () (robot:find-robot 'shrew))

(defun goes-on-p (robot)
  "True if a command of ROBOT, which is live, comes to its end."
  (let ((done (base:make-semaphore "done")))
    (turn-and robot (lambda () (base:signal-semaphore done)))
    (base:wait-on-semaphore done 60)))

(defun message-with (text)
  "Wait for a message with TEXT in the current queue. True if it has come."
  (loop with come = (base:make-semaphore "come") and queue = base:*message-queue*
          initially (setf (base:message-queue-listener queue)
                          (lambda () (base:signal-semaphore come)))
        when (told-p text) return t
        while (base:wait-on-semaphore come 60)))

(test live.an-abort-is-a-message-and-the-clock-goes-on
  (with-live-shrew
    (turn-and (live-shrew) #'abort)
    (is-true (message-with "robot-turn was aborted"))
    (is-true (goes-on-p (live-shrew)))))

(test clean.headless-runs-beside-a-live-run-are-clean-each-time
  (with-live-shrew
    (is (equal '(t t t) (loop repeat 3
                              collect (run:with-simulation (shrew :clean t)
                                        base:no-sensor-error*))))))

(test rate.is-kept-after-the-clock-has-rested
  (with-live-shrew
    (let* ((pacing (time::timeline-pacing (time:timeline-of (live-shrew))))
           (later (+ 1d6 (time:seconds-now))))
      (setf (time::pacing-rate pacing) 20)
      ;; A tick's time after the tick before, though a request has come at once,
      (is (= later (time::time-to-go-on pacing later)))
      ;; but ticks that were not needed are not made up.
      (is (< 0 (time::time-to-go-on pacing 0d0) (time:seconds-now))))))

(test live.a-thread-that-is-ended-can-be-replaced
  "It is said so; nothing hangs, and the simulator starts again."
  (with-live-shrew
    (turn-and (live-shrew) #'sb-thread:abort-thread)
    (is-true (message-with "ended from outside"))
    (is-false (time:live-p))
    (is (integerp (run:state-digest)) "who asks is answered")
    (run:simulator 'shrew :rate :free :display nil)
    (is-true (goes-on-p (live-shrew)))))

(test live.ending-its-thread-from-another-leaves-no-tick-unfinished
  (with-live-shrew
    (let ((thread (run:simulation-thread time:*simulation*)))
      (sb-thread:terminate-thread thread)
      (is-true (message-with "ended from outside"))
      (is-false (run:simulation-inside-tick-p time:*simulation*))
      (run:simulator 'shrew :rate :free :display nil)
      (is-true (goes-on-p (live-shrew))))))

(defun hang () (loop))

(test live.code-that-hangs-is-named-and-can-be-stopped
  (with-live-shrew
    (turn-and (live-shrew) #'hang)
    (is-true (message-with "robot-turn has kept the simulator waiting"))
    (run:stop-simulator)
    (is-false (time:live-p))
    (is-true (told-p "robot-turn was aborted"))
    (run:simulator 'shrew :rate :free :display nil)
    (is-true (goes-on-p (live-shrew)))))

(test live.a-kicker-that-hangs-can-be-stopped
  (with-own-definitions
    (world:define-kicker 'brood :prob 1 :test nil :body (lambda (thing)
                                                          (declare (ignore thing))
                                                          (hang)))
    (with-live-shrew
      (time:set-rate 1000)
      (world:set-kicker (world:find-thing 'log) 'brood)
      (is-true (message-with "has kept the simulator waiting"))
      (run:simulator 'shrew :rate :free :display nil)
      (is-true (goes-on-p (live-shrew))))))

(test live.the-debugger-can-stop-the-simulator
  (let ((base:*user-calls* (base:make-user-calls (lambda () (throw 'out :stopped)))))
    (with-shrew ()
      (with-debugger (condition) (invoke-restart (find 'stop-simulator (compute-restarts condition)
                                                       :key #'restart-name :test #'string=))
        (turn-and shrew (lambda () (error "bad wiring")))
        (is (eq :stopped (run-catching 20)))))))

;;; Several worlds.

(test worlds.that-ask-each-other-do-not-wait-for-ever
  (with-messages
    (let ((told (base:make-semaphore "told")) (meet (base:make-semaphore "meet")))
      (flet ((ask-other (robot)
               (lambda ()
                 (base:signal-semaphore meet)
                 (base:wait-on-semaphore meet 1)
                 (time:ask robot (lambda () (robot:robot-x robot)))
                 (base:signal-semaphore told))))
        (unwind-protect
             (progn
               (run:simulator 'shrew :rate :free :display nil)
               (run:simulator 'vole :rate :free :display nil)
               (loop repeat 20
                     do (turn-and (robot:find-robot 'shrew) (ask-other (robot:find-robot 'vole)))
                        (turn-and (robot:find-robot 'vole) (ask-other (robot:find-robot 'shrew)))
                        (is-true (base:wait-on-semaphore told 60))
                        (is-true (base:wait-on-semaphore told 60))))
          (run:stop-simulator (robot:find-robot 'shrew))
          (run:stop-simulator (robot:find-robot 'vole)))))))

(test worlds.others-are-not-asked-inside-a-tick
  (with-messages
    (unwind-protect
         (progn
           (run:simulator 'vole :rate :free :display nil)
           (let ((vole (robot:find-robot 'vole)))
             (with-shrew ()
               (time:schedule (nil) (time:ask vole (lambda () 1)))
               (run:run-ticks 1)
               (is-true (told-p "between ticks")))))
      (run:stop-simulator (robot:find-robot 'vole)))))

(test run-ticks.is-refused-in-a-continuation
  (with-shrew ()
    (turn-and shrew (lambda () (run:run-ticks 1)))
    (is (= 20 (run:run-ticks 20)))
    (is-true (told-p "no time can pass here"))))

(test simulator.is-refused-while-it-starts
  "A continuation that is called because another run starts cannot start one itself."
  (with-live-shrew
    (let ((codes '()))
      (is-true (goes-on-p (live-shrew)))
      (time:pause)
      (command:robot-go-forward (live-shrew) 5
                                (lambda (code &rest ignore)
                                  (declare (ignore ignore))
                                  (push code codes)
                                  (run:simulator 'shrew :rate :free :display nil)))
      (run:simulator 'shrew :rate :free :display nil)
      (is (equal '(:interrupt) codes))
      (is-true (told-p "is already starting the same world"))
      (is-true (goes-on-p (live-shrew))))))

(test simulator.from-many-threads-leaves-one-that-works
  (with-live-shrew
    (let ((threads (loop repeat 4
                         collect (base:start-thread
                                  (lambda ()
                                    (loop repeat 5
                                          do (run:simulator 'shrew :rate :free :display nil)
                                             (run:stop-simulator (live-shrew))))
                                  "starter"))))
      (mapc #'base:join-thread threads)
      (run:simulator 'shrew :rate :free :display nil)
      (is-true (goes-on-p (live-shrew)))
      (is-true (replays-p (progn (run:stop-simulator) time:*simulation*))))))

(test live.a-time-limit-in-users-code-is-an-error-there
  (with-live-shrew
    (turn-and (live-shrew) (lambda () (sb-ext:with-timeout .01 (hang))))
    (is-true (message-with "Error in the continuation of robot-turn: Timeout"))
    (is-true (goes-on-p (live-shrew)))))

(test live.a-time-limit-ends-a-wait-for-code-that-does-not-return
  (with-live-shrew
    (let ((held (base:make-semaphore "held")) (release (base:make-semaphore "release")))
      (turn-and (live-shrew) (lambda ()
                               (base:signal-semaphore held)
                               (base:wait-on-semaphore release 60)))
      (is-true (base:wait-on-semaphore held 60))
      (dolist (wait (list (lambda () (run:await-idle)) (lambda () (time:asking ((live-shrew)) 1))))
        (is (eq :timed-out (handler-case (sb-ext:with-timeout .05 (funcall wait))
                             (sb-ext:timeout () :timed-out)))))
      (base:signal-semaphore release)
      (is-true (run:await-idle)))))

(test live.a-break-in-what-is-asked-is-told-to-who-asks
  (with-live-shrew
    (signals base:misuse (time:asking ((live-shrew)) (break "Here?")))
    (signals base:misuse (time:asking ((live-shrew)) (abort)))
    (is-true (goes-on-p (live-shrew)))))

(test live.stopped-and-started-in-continuations-is-the-current-one
  (with-live-shrew
    (let ((started (base:make-semaphore "started")))
      (turn-and (live-shrew)
                (lambda ()
                  (run:stop-simulator (live-shrew))
                  (run:simulator 'shrew :rate :free :display nil)
                  (base:signal-semaphore started)))
      (is-true (base:wait-on-semaphore started 60))
      (is-true (goes-on-p (live-shrew)))
      (is (eq (run:robot-simulation (live-shrew)) (base:global-value 'time:*simulation*))))))

(defun simulators-of (name)
  "Return how many threads pass ticks of maps called NAME."
  (count (format nil "simulator of ~A" name) (sb-thread:list-all-threads)
         :key #'sb-thread:thread-name :test #'string=))

(test live.no-run-of-a-map-that-is-replaced-is-left
  "Some threads start the simulator while others define its map again."
  (with-own-definitions
    (with-messages
      (flet ((start () (run:simulator 'hare :rate :free :display nil))
             (define () (handler-bind ((warning #'muffle-warning))
                          (eval '(world:defmap form (9 9))))))
        (define)
        (eval '(robot:defrobot hare (form (4 4) 0)))
        (mapc #'base:join-thread
              (loop for function in (list #'start #'define #'start #'define)
                    collect (let ((function function))
                              (base:start-thread (lambda () (loop repeat 20 do (funcall function)))
                                                 "hunter"))))
        (define)
        (loop repeat 100000 until (zerop (simulators-of 'form)) do (base:yield-thread))
        (is (= 0 (simulators-of 'form)))))))

(test live.at-a-free-rate-kickers-alone-let-no-time-pass
  (with-own-definitions
    (world:define-kicker 'twitch :prob 1 :body (lambda (thing) (world:kick-thing thing .1 0 nil)))
    (with-live-shrew
      (world:set-kicker (world:find-thing 'log) 'twitch)
      (is-true (goes-on-p (live-shrew)))
      (is-true (run:await-idle))
      (is (< 0 (run:simulation-tick time:*simulation*) 1000)))))
