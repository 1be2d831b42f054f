;;;; clim-progress.lisp -- what the window shows about time, and how often it updates.

(in-package :ars-magna.tests)

(in-suite clim)

(defun progress-text-of (simulation &optional (pulse (window::make-rate-sample)))
  (window::progress-text (window::measure-progress simulation pulse)))

(test progress.says-whether-time-stands-still
  (in-studio (robot)
    (let ((simulation (time:current-simulation)))
      (is (mentions-p (progress-text-of simulation) "not live"))
      (run:start-clock simulation :rate 50)
      (unwind-protect
           (progn
             (run:await-idle simulation)
             (is (mentions-p (progress-text-of simulation) "50/s  idle"))
             (time:pause simulation)
             (is (mentions-p (progress-text-of simulation) "paused"))
             (time:resume simulation)
             (time:set-rate :free simulation)
             (is (mentions-p (progress-text-of simulation) "as fast as possible")))
        (run:stop-clock simulation)))))

(test progress.measures-the-rate-over-some-ticks
  (let ((pulse (window::make-rate-sample :seconds 100d0)))
    (is (null (window::measure-rate pulse 3 100.5d0)))
    (is (= 20 (window::measure-rate pulse 20 101d0)))
    (is (= 20 (window::measure-rate pulse 21 101.2d0)))
    (is (= 40 (window::measure-rate pulse 60 102d0)))
    (is (null (window::measure-rate pulse 5 103d0)))))

(defun call-while-code-holds (function robot &optional (enter (constantly nil)))
  "Call FUNCTION with the live run of ROBOT while a continuation there, which calls ENTER, waits."
  (let ((simulation (time:current-simulation))
        (there (base:make-semaphore "there")) (on (base:make-semaphore "on")))
    (run:start-clock simulation :rate :free)
    (unwind-protect
         (progn (command:robot-turn robot 1/10 (lambda (err robot angle)
                                                 (declare (ignore err robot angle))
                                                 (funcall enter)
                                                 (base:signal-semaphore there)
                                                 (base:wait-on-semaphore on)))
                (base:wait-on-semaphore there)
                (unwind-protect (funcall function simulation)
                  (base:signal-semaphore on)))
      (run:stop-clock simulation))))

(test progress.says-that-a-program-has-broken
  (in-studio (robot)
    (call-while-code-holds
     (lambda (simulation)
       (is (mentions-p (progress-text-of simulation) "a program has broken")))
     ;; As code that enters a debugger does.
     robot #'base:note-debugger-waiting)))

(test progress.names-users-code-that-does-not-return
  (in-studio (robot)
    (call-while-code-holds
     (lambda (simulation)
       (let ((pulse (window::make-rate-sample)))
         (window::measure-progress simulation pulse)
         (is (mentions-p (progress-text-of simulation pulse) "busy in"))))
     robot)))

(test watcher.tells-of-a-scale-that-was-set
  (in-studio (robot)
    (let* ((count 0)
           (watcher (window::make-watcher 'studio-robot (lambda () (incf count)))))
      (window::check-graphics-scale watcher)
      (is (= 0 count))
      (let ((canvas:graphics-scale* 13))
        (window::check-graphics-scale watcher)
        (window::check-graphics-scale watcher)
        (is (= 1 count))))))
