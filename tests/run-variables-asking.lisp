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
