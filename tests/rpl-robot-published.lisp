;;;; rpl-robot-published.lisp -- what other threads can read of live plans without the plans' lock.

(in-package :ars-magna.tests)
(in-suite rpl-robot)

;;; The data are published when the plans' lock is released. While a thread holds the lock the
;;; runner may be inconsistent; here its heap of timers is broken on purpose.

(defun call-with-half-changed-plans (function)
  "Call FUNCTION with an interface whose plans wait for tick 51, as last published, and the run.
What the runner has cannot be read."
  (let ((driver::*default-interface* nil))
    (run:call-with-simulation
     (lambda ()
       (driver:rpl-init-robot (symbol-value 'fitter))
       (driver:begin-plan (rpl:make-plan '(rpl:wait-time 50)))
       (run:run-ticks 1)
       (let* ((interface driver::*default-interface*)
              (timers (tasks::runner-timers (driver::interface-runner interface)))
              (heap (tasks::timers-heap timers)))
         (setf (tasks::timers-heap timers) (make-array 1 :adjustable t :fill-pointer t
                                                         :initial-element 0))
         (unwind-protect (funcall function interface time:*simulation*)
           (setf (tasks::timers-heap timers) heap
                 (driver::interface-thread interface) nil))))
     '(fitter))))

(test published.the-clock-reads-no-plan-that-another-thread-holds
  (call-with-half-changed-plans
   (lambda (interface simulation)
     (signals error (tasks::next-wake-time (driver::interface-runner interface)))
     (is (eql 51 (driver::wake-tick interface)))
     (is-true (run::participant-busy-p interface simulation))
     (is-false (driver::time-to-wake-p interface))
     (setf (driver::interface-thread interface) :starting)
     (is (eql 51 (run::participant-busy-p interface simulation)))
     (is-false (driver::time-to-wake-p interface)))))

(test published.who-waits-for-a-plan-reads-none-that-another-thread-holds
  (call-with-half-changed-plans
   (lambda (interface simulation)
     (declare (ignore simulation))
     (is-false (driver::deadlocked-p interface)))))

(test published.digests-leave-plans-that-are-at-work
  (call-with-half-changed-plans
   (lambda (interface simulation)
     (declare (ignore simulation))
     (setf (driver::interface-thread interface) :starting)
     (let ((held (base:make-semaphore "held")) (go-on (base:make-semaphore "go on")))
       (let ((thread (base:start-thread
                      (lambda ()
                        (base:with-lock ((driver::interface-lock interface))
                          (base:signal-semaphore held)
                          (base:wait-on-semaphore go-on 10)))
                      "holds the plans")))
         (base:wait-on-semaphore held 10)
         (unwind-protect
              (finishes (run::participant-digest interface (base:make-digest)))
           (base:signal-semaphore go-on)
           (base:join-thread thread)))))))

;;; Plans that have stopped in a debugger.

(defun call-with-editor-asking (function)
  "Call FUNCTION, with a semaphore, as where an editor's debugger asks in a place of its own. A plan
that breaks is stopped there until the semaphore is signalled."
  (let ((before (base:global-debugger-hook)) (answered (base:make-semaphore "answered")))
    (flet ((ask (condition hook)
             (declare (ignore hook))
             (base:wait-on-semaphore answered)
             (continue condition)))
      (setf (base:global-debugger-hook) #'ask)
      (unwind-protect (base:with-debugger-hook (#'ask) (funcall function answered))
        (setf (base:global-debugger-hook) before)))))

(test published.plans-in-a-debugger-are-no-hogs
  (call-with-editor-asking
   (lambda (answered)
     (live (simulation)
       (driver:begin-plan (rpl:interp-lambda () (break "look")))
       (let ((interface driver::*default-interface*))
         (awaiting (driver::plans-in-debugger-p interface))
         (let ((text (trouble-of #'driver:print-plans)))
           (is-true (has-words-p text "stopped in a debugger" "plans of" "print-plans t t")
                    "~A" text))
         (base:signal-semaphore answered)
         (awaiting (not (driver::plans-in-debugger-p interface))))))))

;;; A live run that is started inside of a headless one.

(defun fluent-seen-by-others ()
  "Return the fluent that ROBOT-STOPPED* stands for in a thread without bindings."
  (bt:join-thread (bt:make-thread (lambda () driver:robot-stopped*))))

(test published.by-a-run-inside-of-a-headless-one-ends-with-that
  "Outside, the fluents and the robot of plans are again those of the run that is current there."
  (let ((before (base:global-value 'time:*simulation*)) (outer nil))
    (with-messages
      (unwind-protect
           (let ((inner nil))
             (run:simulator 'ars-worlds:dot :rate :free :display nil)
             (setf outer time:*simulation*)
             (driver:rpl-init-robot 'ars-worlds:dot)
             (let ((fluent (fluent-seen-by-others)))
               (run:call-with-simulation
                (lambda ()
                  (run:simulator 'ars-worlds:robbie :rate :free :display nil)
                  (driver:rpl-init-robot 'ars-worlds:robbie)
                  (setf inner time:*simulation*)
                  (is (not (eq fluent (fluent-seen-by-others)))))
                '(fitter))
               (is (eq fluent (fluent-seen-by-others)))
               (run:stop-simulator inner)))
        (run:stop-simulator outer)
        (setf (base:global-value 'time:*simulation*) before)))))

(test threads-of-plans.end-with-the-clock
  "Plans stay: they go on with ticks that somebody lets pass, or with the next clock."
  (flet ((pass-ticks (simulation) (run:run-ticks 900 simulation))
         (start-anew (simulation) (run:start-clock simulation :rate :free)))
    (dolist (go-on (list #'pass-ticks #'start-anew))
      (live (simulation :rate 20)
        (let ((task (driver:begin-plan (rpl:make-plan '(rpl:seq (rpl:wait-time 800) :fine)))))
          (awaiting (eq :waiting (rpl:task-state task)))
          (run:stop-clock simulation)
          (awaiting (null (driver::plans-thread driver::*default-interface*)))
          (is-false (rpl:task-over-p task))
          (funcall go-on simulation)
          (awaiting (rpl:task-over-p task))
          (is (eq :fine (rpl:task-result task))))))))

;;; A run that is paused.

(test run-plan.of-a-paused-run-says-what-lets-it-go-on
  "Once in a run; who reads that can resume."
  (live (simulation)
    (let ((said 0) (plan (rpl:interp-lambda () (rpl:wait-time 2) :ok)))
      (host:wrap-function 'world:warn-once
                          (lambda (function &rest arguments)
                            (when (apply function arguments) (incf said))
                            (time:resume simulation))
                          'test)
      (unwind-protect (loop repeat 2
                            do (time:pause simulation)
                               (is (eq :ok (driver:run-plan plan))))
        (host:unwrap-function 'world:warn-once 'test))
      (is (= 1 said))
      (is-true (has-words-p (format nil "~{~A~}" (mapcar #'base:message-text (base:take-messages)))
                            "run-plan waits, because the run is paused" "(resume)")))))

(test threads-of-plans.that-leave-end-what-was-closed-meanwhile
  "Who closes plans leaves that to their thread, if there is one: it may just be leaving."
  (let ((driver::*default-interface* nil))
    (run:call-with-simulation
     (lambda ()
       (driver:rpl-init-robot (symbol-value 'fitter))
       (let ((interface driver::*default-interface*)
             (task (driver:begin-plan (rpl:make-plan '(rpl:wait-time 50)))))
         (setf (driver::interface-thread interface) (base:current-thread))
         (driver::close-interface interface)
         (is-false (rpl:task-over-p task) "it is left to the thread")
         (driver::call-with-plans (lambda () (driver::run-plans-in-ticks interface)) interface)
         (is-true (rpl:task-over-p task))
         (is (null (driver::interface-thread interface)))))
     '(fitter))))
