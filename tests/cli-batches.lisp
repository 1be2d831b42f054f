;;;; cli-batches.lisp -- batches whose lines start live runs, and how batches wait and end.

(in-package :ars-magna.tests)
(in-suite cli-scripts)

(defun last-line-of (text &rest options)
  "Return the last line that a script of TEXT with OPTIONS writes."
  (first (last (apply #'run-script text options))))

(test batches.start-a-simulator-whose-plans-run
  "Manual A: a headless run around SIMULATOR does not hide the fluents from the plans' thread."
  (dolist (robot '("dot" "'dot"))
    (is (string= ":SUCCEEDED"
                 (last-line-of (format nil "(simulator ~A :rate :free)
(run-plan 'look-round 0 '((:color blue)))" robot))))))

(test batches.have-robots-named-where-time-passes
  "A continuation names the robot that SIMULATOR has started, also after that began anew."
  (is (eq :turned
          (run:with-simulation (fitter)
            (let ((turned (base:make-semaphore "turned")) (*standard-output* (make-broadcast-stream)))
              (run:simulator fitter :rate :free)
              (command:robot-turn
               fitter 1
               (lambda (&rest results)
                 (declare (ignore results))
                 (command:robot-turn fitter 1 (lambda (&rest results)
                                                 (declare (ignore results))
                                                 (base:signal-semaphore turned)))))
              (and (base:wait-on-semaphore turned 20) :turned))))))
