;;;; runs-replaced.lisp -- several threads start, stop and replace one world's simulator.

(in-package :ars-magna.tests)
(in-suite runs)

;;; Each test stops one thread at a critical point, by a wrapper of the function called there, and
;;; lets another run. So the interleaving is the same in every run.

(defun call-wrapped-once (name between function)
  "Call FUNCTION. Where NAME, a function's name, is called first, BETWEEN is called instead, with
that function and its arguments."
  (let ((left 1))
    (host:wrap-function name
                        (lambda (wrapped &rest arguments)
                          (if (minusp (decf left))
                              (apply wrapped arguments)
                              (apply between wrapped arguments)))
                        'test)
    (unwind-protect (funcall function)
      (host:unwrap-function name 'test))))

(defmacro coming-between ((name lambda-list &body between) &body body)
  "Run BODY. Where the function NAME is called first, run BETWEEN instead; LAMBDA-LIST binds that
function and its arguments."
  `(call-wrapped-once ',name (lambda ,lambda-list ,@between) (lambda () ,@body)))

(defmacro interrupted (&body body)
  "Run BODY, which LEAVE leaves, as a time limit would. Return :LEFT if it was left."
  `(catch 'left ,@body))

(defun leave () (throw 'left :left))

(defun interrupt-here ()
  "Interrupt this thread, as a time limit would: it leaves when interrupts are let in."
  (sb-thread:interrupt-thread sb-thread:*current-thread* #'leave))

(defun ends-p (thread)
  "True if THREAD ends within some seconds."
  (await (lambda () (not (base:thread-alive-p thread)))))

(defun start-dray (&rest options)
  (apply #'run:simulator 'dray :display nil :rate :free options))

(defmacro with-yard (() &body body)
  "Run BODY where DRAY is in a map of its own, and nothing of what BODY does is left afterwards."
  `(with-messages
     (base:with-own-definitions ()
       (handler-bind ((warning #'muffle-warning))
         (world:define-map 'coach-yard 9 9)
         (robot:define-robot 'dray 'coach-yard '(3 3) 0)
         ,@body))))

(defun thread-of-dray ()
  (run:simulation-thread (run:robot-simulation (symbol-value 'dray))))

;;; A start that is interrupted.

(test simulator.left-while-its-thread-begins-leaves-none
  (with-yard ()
    (let ((threads '()))
      (is (eq :left
              (coming-between (base:start-thread (start function name)
                         (push (funcall start function name) threads)
                         (leave))
                (interrupted (start-dray)))))
      (is (= 1 (length threads)))
      (is-true (every #'ends-p threads))
      (is (null (thread-of-dray)))
      (start-dray)
      (is-true (thread-of-dray)))))

(test simulator.interrupted-at-the-hand-over-is-live
  (with-yard ()
    (is (eq :left
            (coming-between (time::hand-over-custody (hand-over &rest arguments)
                       (interrupt-here)
                       (apply hand-over arguments))
              (interrupted (start-dray)))))
    (let ((thread (thread-of-dray)))
      (is-true thread)
      (finishes (run:stop-simulator (symbol-value 'dray)))
      (is-true (ends-p thread)))))

(test plans.left-while-their-thread-begins-get-another
  (with-yard ()
    (let ((driver::*default-interface* nil))
      (start-dray)
      (driver:rpl-init-robot (symbol-value 'dray))
      ;; A tick that found the plan would begin its thread.
      (time:pause)
      (is (eq :left
              (coming-between (base:start-thread (start function name)
                         (declare (ignore start function name))
                         (leave))
                (interrupted (driver:begin-plan (rpl:make-plan '(rpl:wait-time 1)))))))
      (time:resume)
      (is (eq :succeeded (nth-value 1 (driver:run-plan (rpl:make-plan '(rpl:wait-time 1)))))))))

;;; A rewind, and what comes between.

(defun start-and-pass (ticks)
  "Start the simulator of DRAY, let TICKS pass, and return the run, paused."
  (start-dray :keep t :journal t)
  (time:pause)
  (time:pass-then-pause ticks time:*simulation*)
  (awaiting (= ticks (run:simulation-tick)))
  time:*simulation*)

(test rewind.robots-found-meanwhile-are-those-of-the-run-that-goes-on
  "Another thread looks for the robot when those of the run that is over take no more commands."
  (with-yard ()
    (let* ((old (start-and-pass 3)) (found nil) (thread nil)
           (custody (time:timeline-custody (run:simulation-timeline old))))
      (coming-between (run::end-rewound-run (end old new)
                 (funcall end old new)
                 (setf thread (base:start-thread
                               (lambda () (setf found (run::find-current-robot 'dray)))
                               "finds the robot"))
                 (awaiting (time:custody-questions custody)))
        (run:rewind 1))
      (is-true (ends-p thread))
      (is-true (world:map-resident (world:find-map 'coach-yard)))
      (is (eq (world:map-resident (world:find-map 'coach-yard)) (robot:robot-world found)))
      (is (eq found (symbol-value 'dray))))))

(test rewind.of-a-run-that-is-stopped-meanwhile-is-not-live
  (with-yard ()
    (let ((old (start-and-pass 3)))
      (coming-between (run::end-rewound-run (end old new)
                 (funcall end old new)
                 (run:stop-simulator old))
        (run:rewind 1))
      (is-false (time:live-p (run:latest-successor old))))))

(test stop-simulator.of-a-run-that-was-rewound-stops-what-goes-on
  (with-yard ()
    (let* ((old (start-and-pass 3)) (new (run:rewind 1)))
      (is-true (time:live-p new))
      (run:stop-simulator old)
      (is-false (time:live-p new)))))

(test rewind.that-is-interrupted-puts-all-of-the-run-in-its-place
  (with-yard ()
    (let ((old (start-and-pass 3)))
      (is (eq :left
              (coming-between (run::record-rewind (note &rest arguments)
                         (interrupt-here)
                         (apply note arguments))
                (interrupted (run:rewind 1)))))
      (let ((new (run:latest-successor old)))
        (is (not (eq old new)))
        (is (eq (run:simulation-world new) (world:map-resident (world:find-map 'coach-yard))))
        (is (eq (run:simulation-world new) (robot:robot-world (symbol-value 'dray))))
        (run:stop-simulator (symbol-value 'dray))
        (is-false (time:live-p new))))))

(test start-clock.of-a-run-that-is-over-meanwhile-is-refused
  (with-yard ()
    (start-dray)
    (run:stop-simulator)
    (let ((old time:*simulation*))
      (time:pass-then-pause 0 old)
      (coming-between (run::check-parameters (check &rest arguments)
                 (run::end-simulation old "the test has ended it")
                 (apply check arguments))
        (signals base:misuse (run:start-clock old)))
      (is-false (time:live-p old)))))

;;; A map that is defined again, and what comes between.

(test defmap.by-two-threads-ends-what-is-live-in-either-map
  "The second thread defines and starts when the first knows the map that it is to replace."
  (with-yard ()
    (let ((thread nil))
      (flet ((define-and-start ()
               (handler-bind ((warning #'muffle-warning))
                 (world:define-map 'coach-yard 8 8)
                 (start-dray)
                 (setf thread (thread-of-dray)))))
        (coming-between (base:register (register &rest arguments)
                   (base:join-thread (base:start-thread #'define-and-start "defines"))
                   (apply register arguments))
          (world:define-map 'coach-yard 7 7)))
      (is-true thread)
      (is-true (ends-p thread))
      (is (= 7 (world:map-width (world:find-map 'coach-yard)))))))

(test defmap.that-is-interrupted-ends-what-is-live-in-the-old-map
  (with-yard ()
    (start-dray)
    (let ((thread (thread-of-dray)))
      (is (eq :left (coming-between (run::end-world-run (&rest arguments)
                               (declare (ignore arguments))
                               (leave))
                      (interrupted (world:define-map 'coach-yard 7 7)))))
      (is-true (ends-p thread)))))

(test defmap.that-is-interrupted-at-its-entry-ends-what-is-live-in-the-old-map
  "Locks, such as that of what is defined, let no interrupts in while they are held off."
  (with-yard ()
    (let ((dray (start-dray)))
      (is (eq :left (interrupted
                     (coming-between (base:register (register &rest arguments)
                                       (interrupt-here)
                                       (apply register arguments))
                       (world:define-map 'coach-yard 7 7)))))
      (is-true (await (lambda () (robot:robot-retired dray)))))))

(test plans.that-are-interrupted-at-the-end-of-their-run-end
  "What interrupts the end of a run leaves one piece of users' code, not the rest of the end."
  (with-yard ()
    (robot:define-robot 'cart 'coach-yard '(5 5) 0)
    (run:with-simulation (dray)
      (driver:rpl-init-robot dray)
      (let ((plan (driver:begin-plan (rpl:make-plan '(rpl:wait-time 100))))
            (heard '()))
        (flet ((hear (code part &rest results)
                 (declare (ignore part results))
                 (push code heard)))
          (dolist (robot (world:world-robots (robot:robot-world dray)))
            (ars:robot-turn robot 1 #'hear)))
        (run:run-ticks 1)
        (is (eq :left (interrupted
                       (coming-between (run::notify-of-end (tell simulation)
                                         (interrupt-here)
                                         (funcall tell simulation))
                         (run::end-simulation time:*simulation* "it is enough")))))
        (is (eq :evaporated (rpl:task-state plan)))
        (is (equal '(:interrupt) heard))))))

(test rewind.of-a-run-whose-map-is-defined-anew-leaves-none-live
  "The map is defined again when the run is about to be replaced."
  (with-yard ()
    (let* ((old (start-and-pass 3)) (thread nil)
           (custody (time:timeline-custody (run:simulation-timeline old))))
      (coming-between (run::end-rewound-run (end old new)
                 (funcall end old new)
                 (setf thread (base:start-thread
                               (lambda ()
                                 (handler-bind ((warning #'muffle-warning))
                                   (world:define-map 'coach-yard 7 7)))
                               "defines"))
                 (awaiting (time:custody-questions custody)))
        (run:rewind 1))
      (is-true (ends-p thread))
      (is-false (time:live-p (run:latest-successor old)))
      (is-true (run::simulation-over (run:latest-successor old))))))

;;; A time limit is that of the thread that has set it.

(test asking.a-time-limit-is-not-for-whoever-asks
  "It comes in a thread of a user's that answers another's question."
  (with-yard ()
    (let* ((robot (symbol-value 'dray)) (told nil) (thread nil)
           (custody (time:timeline-custody (time:timeline-of robot))))
      (flet ((ask ()
               (setf told (handler-case (time:asking (robot) (error 'sb-ext:timeout))
                            (base:misuse () :aborted)
                            (sb-ext:timeout () :limit)))))
        (is (eq :limit
                (handler-case
                    (time:asking (robot)
                      (setf thread (base:start-thread #'ask "asks"))
                      (awaiting (time:custody-questions custody)))
                  (sb-ext:timeout () :limit)))))
      (is-true (ends-p thread))
      (is (eq :aborted told)))))

;;; What is to be done in any case is, also if an interrupt comes just then.

(test in-any-case.no-interrupt-comes-between
  (let ((log '()))
    (is (eq :left (interrupted
                   (base:in-any-case (push 1 log)
                                     (progn (interrupt-here) (push 2 log))
                                     (push 3 log)))))
    (is (equal '(1 2 3) (reverse log)))))

(test with-simulation.that-is-interrupted-at-its-end-ends-its-run
  (with-yard ()
    (let ((simulation nil))
      (is (eq :left (coming-between (run::warn-of-unpassed-ticks (warn &rest arguments)
                                      (interrupt-here)
                                      (apply warn arguments))
                      (interrupted (run:with-simulation (dray)
                                     (setf simulation time:*simulation*))))))
      (is-true (run:simulation-over simulation)))))

(test homes.are-left-by-who-is-interrupted-while-leaving
  (let ((runner (rpl:make-plan-runner)))
    (is (eq :left (coming-between (fluents::release-home (leave home)
                                    (interrupt-here)
                                    (funcall leave home))
                    (interrupted (fluents::call-with-owned-home runner (constantly 1))))))
    (is (null (fluents::home-holder runner)))))

;;; Threads that were woken, or started, and interrupted before they could say so.

(test stop-simulator.of-one-that-has-ended-needs-nobody-to-wake-it
  "A thread that has waited for the end was interrupted before it could wake the next one."
  (with-yard ()
    (start-dray)
    (run:stop-simulator)
    (let ((pacing (time:timeline-pacing (run:simulation-timeline time:*simulation*))))
      (is-true (base:wait-on-semaphore (time::pacing-ended pacing) 10))
      (finishes (run:stop-simulator)))))

(test plans.a-thread-whose-start-was-given-up-leaves-them
  (with-yard ()
    (let ((driver::*default-interface* nil) (called nil))
      (start-dray)
      (driver:rpl-init-robot (symbol-value 'dray))
      (driver::call-as-plans-thread driver::*default-interface* (lambda () (setf called t)))
      (is-false called))))
