;;;; rpl.lisp -- the cost of plans, and whether anything is ever lost.

(defpackage :ars-magna.benchmarks.rpl
  (:documentation "Benchmarks of the plan language.")
  (:use :cl :ars-magna.rpl :ars-magna.benchmarks)
  (:import-from :ars-magna.base #:make-dice #:roll-index))

(in-package :ars-magna.benchmarks.rpl)

(defun say-time (name count seconds)
  (format t "~&~56A ~15,3F us~%" name (/ (* 1d6 seconds) count))
  (finish-output))

(defun seconds-of (plan argument &optional (times 1) trace)
  "Return the median of the seconds that PLAN takes, when run TIMES times over, traced if TRACE."
  (flet ((run ()
           (loop repeat times
                 for runner = (make-plan-runner :trace trace)
                 do (assert (eq :succeeded
                                (nth-value 1 (run-plan-alone plan :arguments (list argument)
                                                                  :runner runner)))))))
    (/ (median (loop repeat 5 collect (seconds-for #'run))) times)))

;;; Waiting tasks.

(def-interp-proc many-waiters (items)
  (let ((go (create-fluent 'go)))
    (par (par-loop (item items)
           (wait-for go))
         (seq (wait-time 1)
              (set-value go t)))))

(def-interp-proc many-networks (items)
  (let ((level (create-fluent 'level 0)))
    (par (par-loop (item items)
           (wait-for (> level item)))
         (seq (wait-time 1)
              (set-value level most-positive-fixnum)))))

;;; Tasks that queue for one valve.

(def-interp-proc many-owners (items)
  (let ((valve (make-valve 'one)))
    (par-loop (item items)
      (with-valve (valve) (wait-time 1)))))

(defun waiting-bytes (count)
  "Return how many bytes each of COUNT waiting tasks keeps alive."
  (let ((runner (make-plan-runner))
        (items (loop for i below count collect i)))
    (sb-ext:gc :full t)
    (let ((before (ars-magna.host:dynamic-usage)))
      (start-plan runner 'many-waiters items)
      (react-to-all runner)
      (sb-ext:gc :full t)
      (prog1 (/ (- (ars-magna.host:dynamic-usage) before) count)
        (stop-plan runner)))))

(dolist (count '(100 1000 10000 100000))
  (let ((items (loop for i below count collect i)))
    (say-time (format nil "a waiting task, start to end, ~:D of them" count) count
              (seconds-of 'many-waiters items (floor 200000 count)))))
(let ((items (loop for i below 100000 collect i)))
  (say "100,000 waiting tasks, start to end" (* 1000 (seconds-of 'many-waiters items)) "ms")
  (say "the same, each with a network of its own" (* 1000 (seconds-of 'many-networks items)) "ms")
  (say "20,000 tasks that have one valve in turn"
       (* 1000 (seconds-of 'many-owners (subseq items 0 20000))) "ms")
  (say "kept alive by a waiting task" (waiting-bytes 100000) "bytes"))

;;; Parallel constructs.

(def-interp-proc nothing-at-all (count)
  (n-times count nil))

(def-interp-proc many-pursuits (count)
  (let ((never (create-fluent 'never)))
    (n-times count (pursue (wait-for never) nil))))

(def-interp-proc many-pairs (count)
  (n-times count (par nil nil)))

(def-interp-proc many-policies (count)
  (let ((never (create-fluent 'never)))
    (n-times count (with-policy (whenever never (fail)) nil))))

(def-interp-proc many-failures (count)
  (n-times count (handle-failure ((t (failure) (return nil))) (fail :class 'on-purpose))))

(def-interp-proc step-down (n)
  (if (> n 0) (step-down (- n 1))))

(def-interp-proc many-calls (count)
  (n-times count (step-down 9)))

(loop for (plan name per) in '((nothing-at-all "a turn of n-times" 1)
                               (many-pairs "par of two branches" 1)
                               (many-pursuits "pursue, one branch waiting" 1)
                               (many-policies "with-policy, the policy waiting" 1)
                               (many-failures "a failure handled" 1)
                               (many-calls "a call of a procedure" 10))
      do (say-time name (* per 300000) (seconds-of plan 300000)))

;;; What a trace costs.

(loop for (plan name) in '((many-pursuits "pursue, one branch waiting, traced")
                           (many-pairs "par of two branches, traced")
                           (many-policies "with-policy, the policy waiting, traced"))
      do (say-time name 100000 (seconds-of plan 100000 1 t)))

;;; Switching between tasks.

(def-interp-proc ping-pong (count)
  (let ((ping (create-fluent 'ping)) (pong (create-fluent 'pong)))
    (par (n-times count (set-value ping t) (wait-for pong) (set-value pong nil))
         (n-times count (wait-for ping) (set-value ping nil) (set-value pong t)))))

(say "switches between two tasks"
     (/ 1000000 (seconds-of 'ping-pong 500000)) "per second")

;;; Networks.

(defun chain (source depth)
  (loop with fluent = source
        repeat depth
        do (setf fluent (fl-funcall #'+ fluent 1))
        finally (return fluent)))

(def-interp-proc watch-chain (source depth)
  (wait-for (< (chain source depth) 0)))

(defun updates-per-second (depth count)
  (let* ((source (create-fluent 'source 0))
         (runner (make-plan-runner)))
    (start-plan runner 'watch-chain source depth)
    (react-to-all runner)
    (per-second count (lambda () (dotimes (i count) (set-value source i))))))

(say "updates of a fluent under a network 10 deep" (updates-per-second 9 1000000) "per second")
(say "the same, 2 deep" (updates-per-second 1 3000000) "per second")

;;; Is anything lost? Small random plans, each a few pulses between tasks.

(def-interp-proc relay (fluents order)
  (let ((heard 0) (ready (create-fluent 'ready 0)))
    (par (par-loop (fluent fluents)
           (seq (set-value ready (+ 1 (fluent-value ready)))
                (wait-for fluent)
                (incf heard)))
         (seq (wait-for (= ready (length fluents)))
              (dolist (index order)
                (pulse (nth index fluents)))))
    heard))

(defun shuffled (count dice)
  (let ((left (loop for i below count collect i)))
    (loop while left
          collect (let ((next (elt left (roll-index (length left) dice))))
                    (setf left (remove next left))
                    next))))

(let ((dice (make-dice 1992)) (lost 0) (hung 0))
  (dotimes (run 10000)
    (let* ((count (1+ (roll-index 8 dice)))
           (fluents (loop for i below count collect (create-fluent i))))
      (multiple-value-bind (heard state)
          (run-plan-alone 'relay :arguments (list fluents (shuffled count dice)))
        (if (eq state :succeeded)
            (incf lost (- count heard))
            (incf hung)))))
  (say "pulses lost in 10,000 runs" lost "")
  (say "runs that did not end" hung ""))
