;;;; experiments.lisp -- the cost of an experiment, compared with a bare loop of its trials.

(ars:define-user-package :ars-magna.benchmarks.experiments
  (:documentation "Benchmarks of experiments: trials and rows per second.")
  (:import-from :ars-worlds #:dot #:marvin #:fetch-thing)
  (:import-from :ars-magna.base #:start-thread #:join-thread)
  (:import-from :ars-magna.benchmarks #:per-second #:say))

(in-package :ars-magna.benchmarks.experiments)

;;; The bare loop does what a trial must: a run, its measures and its digest. It stores nothing.

(def-interp-proc three-commands ()
  "Turn, drive, and sense the place."
  (rpl-robot-turn 0.5)
  (wait-for robot-stopped*)
  (rpl-robot-go-forward 3)
  (wait-for robot-stopped*)
  (rpl-robot-place)
  (wait-for robot-place-input*)
  t)

(defexperiment a-command (:robots dot) (:run (robot-go-forward dot 5) (run-ticks 30) t)
  (:measure (x (robot-x dot))))
(defexperiment a-plan (:robots dot) (:run (run-plan 'three-commands))
  (:measure (x (robot-x dot))))
(defexperiment a-fetch (:robots marvin)
  (:run (run-plan 'fetch-thing '((:color blue) (:substance plastic)) '((109 24))))
  (:measure (x (robot-x marvin))))

(defun bare-command (seed)
  (with-simulation (dot :seed seed)
    (robot-go-forward dot 5)
    (run-ticks 30)
    (list (robot-x dot) (state-digest))))

(defun bare-plan (seed)
  (with-simulation (dot :seed seed)
    (list (run-plan 'three-commands) (robot-x dot) (state-digest))))

(defun bare-fetch (seed)
  (with-simulation (marvin :seed seed)
    (list (run-plan 'fetch-thing '((:color blue) (:substance plastic)) '((109 24)))
          (robot-x marvin) (state-digest))))

(defun run-bare (trial count threads)
  (let ((share (floor count threads)))
    (mapc #'join-thread
          (cl:loop for thread below threads
                   collect (let ((first (1+ (* thread share))))
                             (start-thread (lambda ()
                                             (cl:loop for seed from first repeat share
                                                      do (funcall trial seed)))
                                           "bare trials"))))))

(defun run-kept (name count workers)
  (uiop:with-temporary-file (:pathname file)
    (let ((directory (concatenate 'string (namestring file) ".d/")))
      (unwind-protect (run-experiment name :trials count :workers workers :directory directory
                                           :stream nil)
        (uiop:delete-directory-tree (pathname directory) :validate t)))))

(defun report-experiment (name trial count)
  "Print the rate of COUNT trials of the experiment NAME, and beside it that of the bare TRIAL."
  (run-bare trial (floor count 10) 1)
  (dolist (workers '(1 2))
    (let ((bare (per-second count (lambda () (run-bare trial count workers))))
          (kept (per-second count (lambda () (run-kept name count workers)))))
      (say (format nil "~(~A~), ~D worker~:P" name workers) kept
           (format nil "trials/s, ~D % of the bare loop's ~D" (round (* 100 kept) bare)
                   (round bare))))))

(report-experiment 'a-command 'bare-command 40000)
(report-experiment 'a-plan 'bare-plan 10000)
(report-experiment 'a-fetch 'bare-fetch 200)
