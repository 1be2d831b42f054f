;;;; goals.lisp -- threads and a plan install goals in one live run whose plan works on them.

(in-package :ars-magna.benchmarks)

(asdf:load-system "ars-magna/rap")

(ars:define-user-package :goals (:use :cl :ars :nisp :ars-rap))
(in-package :goals)

(defmap yard (20 20))
(defrobot clerk (yard (10.5 10.5) 0))

(define-rap (index (file-away ?who ?n))
  (method (primitive (wait-time 1) (memory-add `(filed ,who ,n)))))

(define-rap (index (stay-open))
  (method (primitive (wait-until (memory-holds-p '(closed))))))

(define-rap (index (install-in-plan ?times))
  (method (primitive (dotimes (n times)
                       (when (zerop (mod n 10)) (wait-time 1))
                       (install-goal (list 'file-away 'plan n))))))

(defun install-often (who times run)
  "Install TIMES goals of WHO in RUN, and change the priority of each."
  (dotimes (n times)
    (asking (run)
      (set-goal-priority (install-goal (list 'file-away who n)) n))))

(defun open-goals () (length (agenda-goals '(:waiting :active :suspended))))

(defun install-from-threads (threads times)
  "Let a goal and THREADS threads install TIMES goals each, while a plan works on them. Return when
no goal is left."
  (let ((run (current-simulation)))
    (install-goal '(stay-open))
    (install-goal (list 'install-in-plan times))
    (begin-plan 'work-on-agenda)
    (mapc #'ars-magna.base:join-thread
          (loop for thread below threads
                collect (let ((thread thread))
                          (ars-magna.base:start-thread
                           (lambda () (install-often thread times run)) "goals"))))
    (loop repeat 500 until (= 1 (open-goals)) do (sleep 1/100))
    (memory-add '(closed))
    (await-idle)))

(let ((threads 4) (times 60))
  (simulator clerk :rate :free :display nil)
  (rpl-init-robot clerk)
  (let ((seconds (ars-magna.benchmarks:seconds-for
                  (lambda () (install-from-threads threads times))))
        (all (* times (1+ threads))))
    (ars-magna.benchmarks:say "a plan and 4 threads, one agenda" (/ all seconds) "goals/s")
    (ars-magna.benchmarks:say "  goals lost or not achieved, of 300"
                              (- all (length (memory-query '(?who ?n) '(filed ?who ?n)))) "")
    (ars-magna.benchmarks:say "  goals that stay active" (open-goals) ""))
  (stop-simulator))

(in-package :ars-magna.benchmarks)
