;;;; trials.lisp -- the cost of a bare trial: a fresh world, a short run, its end.

(ars:define-user-package :ars-magna.benchmarks.trials
  (:documentation "Benchmarks of the loop of trials that experiments stand on.")
  (:import-from :ars-worlds #:dot #:marvin #:fetch-thing)
  (:import-from :ars-magna.base #:start-thread #:join-thread)
  (:import-from :ars-magna.benchmarks #:bytes-for #:per-second #:say))

(in-package :ars-magna.benchmarks.trials)

;;; Trials share nothing that changes, so they may run in any number of threads.

(def-interp-proc three-commands ()
  "Turn, drive, and sense the place."
  (seq (rpl-robot-turn 0.5)
       (wait-for robot-stopped*)
       (rpl-robot-go-forward 3)
       (wait-for robot-stopped*)
       (rpl-robot-place)
       (wait-for robot-place-input*)))

(defun command-trial (seed finish)
  (with-simulation (dot :seed seed)
    (robot-go-forward dot 5)
    (run-ticks 30)
    (funcall finish)))

(defun plan-trial (seed finish)
  (with-simulation (dot :seed seed)
    (run-plan 'three-commands)
    (funcall finish)))

(defun fetch-trial (seed finish)
  (with-simulation (marvin :seed seed)
    (run-plan 'fetch-thing '((:color blue) (:substance plastic)) '((109 24)))
    (funcall finish)))

(defun run-trials (trial first count finish)
  (cl:loop for seed from first repeat count do (funcall trial seed finish)))

(defun run-in-threads (trial count threads finish)
  "Call TRIAL for COUNT seeds, shared among so many THREADS."
  (let ((share (floor count threads)))
    (mapc #'join-thread
          (cl:loop for thread below threads
                   collect (let ((first (* thread share)))
                             (start-thread (lambda () (run-trials trial first share finish))
                                           "trials"))))))

(defun report-trials (name trial count)
  "Print what COUNT calls of TRIAL cost, one by one and side by side, and what a digest adds."
  (flet ((rate (threads &optional (finish (constantly nil)))
           (per-second count (lambda () (run-in-threads trial count threads finish)))))
    (run-trials trial 0 (floor count 10) #'state-digest)
    (let ((one (rate 1)) (two (rate 2)) (digested (rate 1 #'state-digest)))
      (say name one "trials/s")
      (say "  in two threads" two (format nil "trials/s, ~,2F times as many" (/ two one)))
      (say "  time for each" (/ 1d9 one) "ns")
      (say "  allocated for each"
           (/ (bytes-for (lambda () (run-trials trial 0 count (constantly nil)))) count) "bytes")
      (say "  state-digest at its end" (- (/ 1d9 digested) (/ 1d9 one)) "ns"))))

(report-trials "one command and 30 ticks in tiny" 'command-trial 20000)
(report-trials "a plan of three commands in tiny" 'plan-trial 4000)
(report-trials "a fetch in the office" 'fetch-trial 40)
