;;;; run-variables-asking.lisp -- several threads update the run variables of a live run.

(in-package :ars-magna.tests)

(def-suite* run-variables-asking :in ars-magna)

(defvar *tally-step* 1 "What is added at a time.")

(rpl:def-interp-proc tally-by-asking (count)
  (dotimes (n count)
    (rpl:wait-time 1)
    (time:asking ((driver:rpl-robot)) (incf *catch* *tally-step*))))

(defun tally-in-threads (threads each run)
  "Let THREADS threads of users add EACH times to the variable of RUN."
  (mapc #'host:join-thread
        (loop repeat threads
              collect (host:start-thread
                       (lambda () (dotimes (n each) (time:asking (run) (incf *catch*))))
                       "tallying"))))

(test threads.lose-no-update-of-a-run-variable-by-asking
  (with-stopped-run (otter)
    (run:simulator 'otter :rate :free :display nil)
    (driver:rpl-init-robot (robot:find-robot 'otter))
    (let ((task (driver:begin-plan 'tally-by-asking 50)))
      (tally-in-threads 3 50 time:*simulation*)
      (run:await-idle)
      (run:stop-simulator)
      (is (rpl:task-over-p task))
      (is (= 200 *catch*))
      (is (= (run:state-digest) (replayed-digest))))))

(defun call-keeping-one-fork (function)
  "Call FUNCTION while live runs have no time for forks beyond their first."
  (let ((usual run::*fork-time-share*))
    (setf run::*fork-time-share* (expt 10 -9))
    (unwind-protect (funcall function)
      (setf run::*fork-time-share* usual))))

(test rewinding.leaves-to-plans-what-they-have-asked-a-live-run-to-do
  (with-stopped-run (otter)
    (call-keeping-one-fork
     (lambda ()
       (run:simulator 'otter :rate :free :display nil :keep t)
       (driver:rpl-init-robot (robot:find-robot 'otter))
       (driver:begin-plan 'tally-by-asking 10)
       (run:await-idle)
       (run:stop-simulator)))
    (is (= 10 *catch*))
    (let ((*tally-step* 2))
      (run:rewind 1)
      ;; The last change may be of the tick that is taken back.
      (is (member *catch* '(18 20))
          "~A: the plan acts anew, and its old changes are not made again" *catch*))))

;;; The thread that holds the plans asks for a change while the owner of the run waits for plans.

(defun start-asker (run &optional (interface driver::*default-interface*))
  "Start a thread that asks RUN to add 1 to the variable, holding the plans of INTERFACE if that is
not NIL. Return the thread when it waits for the answer."
  (let* ((custody (time:timeline-custody (time:timeline-of run)))
         (before (length (time:custody-questions custody))))
    (flet ((ask () (time:asking (run) (incf *catch*))))
      (prog1 (host:start-thread (lambda ()
                                  (if interface (driver:call-with-plans #'ask interface) (ask)))
                                "asks")
        (awaiting (< before (length (time:custody-questions custody))))))))

(defun print-plans-to-nowhere () (driver:print-plans (make-broadcast-stream)))

(defmacro with-otter-and-plans ((run) &body body)
  `(run:with-simulation (otter :clean t :journal t)
     (driver:rpl-init-robot otter)
     (let ((,run time:*simulation*)) ,@body)))

(test plans.can-be-printed-in-a-run-that-their-thread-waits-for
  (with-otter-and-plans (run)
    (let ((threads '()))
      (time:asking (run)
        (push (start-asker run nil) threads)
        (push (start-asker run) threads)
        (print-plans-to-nowhere)
        (is (= 1 *catch*) "only what holds up the plans is done meanwhile"))
      (mapc #'host:join-thread threads)
      (is (= 2 *catch*)))))

(test plans.can-be-printed-in-a-continuation-while-their-thread-waits-for-the-run
  (with-otter-and-plans (run)
    (let ((thread nil) (seen nil))
      (command:robot-turn otter 1/10 (lambda (&rest results)
                                       (declare (ignore results))
                                       (setf thread (start-asker run))
                                       (print-plans-to-nowhere)
                                       (setf seen *catch*)))
      (run:run-ticks 10)
      (host:join-thread thread)
      (is (eql 1 seen))
      (is (= (run:state-digest) (replayed-digest))))))

(test plans.waited-for-in-a-tick-that-their-thread-waits-for-are-an-error
  (with-otter-and-plans (run)
    (let ((thread nil))
      (time:schedule (nil :timer 3)
        (setf thread (start-asker run))
        (signals base:misuse (print-plans-to-nowhere))
        (is (= 0 *catch*)))
      (run:run-ticks 4)
      (host:join-thread thread)
      (is (= 1 *catch*)))))

(rpl:def-interp-proc tally-by-setting (count)
  (dotimes (n count)
    (rpl:wait-time 1)
    (setf *catch* (+ *catch* 1))))

(test plans.that-set-run-variables-live-can-be-printed-by-asking
  (with-stopped-run (otter)
    (run:simulator 'otter :rate :free :display nil)
    (driver:rpl-init-robot (robot:find-robot 'otter))
    (driver:begin-plan 'tally-by-setting 100)
    (dotimes (n 50) (time:asking (time:*simulation*) (print-plans-to-nowhere)))
    (run:await-idle)
    (run:stop-simulator)
    (is (= 100 *catch*))
    (is (= (run:state-digest) (replayed-digest)))))
