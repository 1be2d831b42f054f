;;;; updates.lisp -- threads and a plan update a run variable and the memory of one live run.

(in-package :ars-magna.benchmarks)

(asdf:load-system "ars-magna/rap")

(ars:define-user-package :updates (:use :cl :ars :nisp :ars-rap))
(in-package :updates)

(defmap depot (20 20))
(defrobot porter (depot (10.5 10.5) 0))

(define-run-variable *updates* 0)
(define-run-variable *looks* 0)

(defun update-often (who times run)
  "Add TIMES facts of WHO to the memory of RUN, and add 1 to its variable as often. Print the plans
before each tenth fact."
  (dotimes (n times)
    (asking (run)
      (incf *updates*)
      (when (zerop (mod n 10))
        (print-plans (make-broadcast-stream))
        (incf *looks*))
      (memory-add (list 'update who n)))))

(def-interp-proc update-in-plan (times)
  (dotimes (n times)
    (when (zerop (mod n 10)) (wait-time 1))
    (asking ((rpl-robot)) (incf *updates*))
    (memory-add (list 'update 'plan n))))

(defun update-from-threads (threads times)
  "Let a plan and THREADS threads make TIMES updates each. Return when all are done."
  (let ((run (current-simulation)))
    (begin-plan 'update-in-plan times)
    (mapc #'ars-magna.base:join-thread
          (loop for thread below threads
                collect (let ((thread thread))
                          (ars-magna.base:start-thread
                           (lambda () (update-often thread times run)) "updates"))))
    (await-idle)))

(let ((threads 4) (times 200))
  (simulator porter :rate :free :display nil)
  (rpl-init-robot porter)
  (let ((seconds (ars-magna.benchmarks:seconds-for
                  (lambda () (update-from-threads threads times))))
        (all (* times (1+ threads))))
    (ars-magna.benchmarks:say "a plan and 4 threads, one live run" (/ all seconds) "updates/s")
    (ars-magna.benchmarks:say "  updates of a run variable lost, of 1,000" (- all *updates*) "")
    (ars-magna.benchmarks:say "  facts added to the memory lost, of 1,000"
                              (- all (length main-memory*)) "")
    (ars-magna.benchmarks:say "  looks at the plan that are missing, of 80"
                              (- (* threads (/ times 10)) *looks*) ""))
  (stop-simulator))

(in-package :ars-magna.benchmarks)
