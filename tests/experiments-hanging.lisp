;;;; experiments-hanging.lisp -- trials that do not return, or that end the thread they run in.

(in-package :ars-magna.tests)

(in-suite experiments)

(defun timed-outcomes (directory &rest options)
  "Run QUESTION in DIRECTORY with OPTIONS; return lists (outcome reason ticks error)."
  (mapcar #'cddr (rows-of (apply #'experiment:run-experiment 'question
                                 :directory directory :stream nil options))))

(defun define-hanging ()
  "Define QUESTION: one of its two conditions never returns, and handles all that it can."
  (define-for-test (:robots ars-worlds:dot) (:trials 1)
    (:vary (hang nil t))
    (:run (run:run-ticks 3)
          (loop while hang do (ignore-errors (loop)))
          t)
    (:measure (ten 10))))

(test time-limit.ends-a-trial-that-does-not-return
  (define-hanging)
  (with-directories (one other)
    (let ((rows (timed-outcomes one :workers 2 :time-limit 1)))
      (is (equal '(("success" "" 3 "") ("timeout" "" :none "")) rows))
      ;; It is not run again: this returns although it has no limit.
      (is (equal rows (timed-outcomes one)))
      (is (equal '("TRUE" "FALSE" "TRUE" "FALSE")
                 (mapcar (lambda (hang) (if (search hang (table-text one)) "TRUE" "FALSE"))
                         '("timeout,,,,," "timeout,,0" "success,,3,10" "error,,"))))
      (timed-outcomes other :workers 1 :time-limit 3/2)
      (is (string= (table-text one) (table-text other))))))

(test time-limit.may-stand-in-the-experiment
  (define-for-test (:robots ars-worlds:dot) (:trials 1) (:time-limit 1/5) (:run (loop)))
  (is (equal '(("timeout" "" :none "")) (outcomes)))
  (rejected-clause (:time-limit 0) (:robots ars-worlds:dot) (:run t) (:time-limit 0))
  (signals-wrong-argument experiment:run-experiment
    (experiment:run-experiment 'question :time-limit -1 :stream nil)))

(test time-limit.is-told-in-the-report
  (define-for-test (:robots ars-worlds:dot) (:time-limit 1/10) (:run (loop)))
  (let ((text (with-output-to-string (out)
                (experiment:print-results
                 (experiment:run-experiment 'question :trials 2 :stream nil) out))))
    (is (search "timeout" text))
    (is (search "limit of time" text))))

(test threads.that-trials-end-are-errors-of-theirs
  "The second time a trial of each condition is run again, and comes out the same."
  (define-for-test (:robots ars-worlds:dot) (:trials 3)
    (:vary (way :plain :ending)) (:run (when (eq way :ending) (sb-thread:abort-thread)) t))
  (with-directories (directory)
    (let ((rows (timed-outcomes directory :workers 2)))
      (is (equal '("error" "error" "error" "success" "success" "success")
                 (sort (mapcar #'first rows) #'string<)))
      (is (= 3 (count "The trial has ended the thread that it ran in." rows
                      :key #'fourth :test #'string=)))
      (is (= 8 (length (timed-outcomes directory :trials 4)))))))

(test progress.gives-the-seed-of-what-takes-longer-than-others
  (define-for-test (:robots ars-worlds:dot) (:run t))
  (let ((progress (experiment::make-progress nil nil 10 1))
        (condition (first (experiment:experiment-conditions
                           (experiment:find-experiment 'question)))))
    (flet ((told (done seconds-before seconds)
             (let ((now (host:real-microseconds)))
               (setf (experiment::progress-done progress) done
                     (slot-value progress 'experiment::begun)
                     (- now (* 1000000 (+ seconds-before seconds)))
                     (svref (experiment::progress-under-way progress) 1)
                     (list condition 3 (- now (* 1000000 seconds)) 1003))
               (experiment::slow-trial-text progress))))
      (is (search "trial 3 of all, seed 1003, has been under way for 60 s" (told 10 20 60)))
      (is (null (told 10 200 60)))
      (is (null (told 10 20 5))))))

;;; Functions that trials put in the place of others.

(defun often-replaced () -1)

(test functions.that-trials-replace-are-noticed
  (let ((before #'often-replaced))
    (unwind-protect
         (is-true (has-words-p (refusal-of-trials
                                1 '(progn (often-replaced)
                                    (setf (symbol-function 'often-replaced)
                                          (let ((k (random 9))) (lambda () k)))
                                    t))
                               "often-replaced"))
      (setf (symbol-function 'often-replaced) before)))
  (is (null (refusal-of-trials 1 '(eql -1 (often-replaced))))))

(let ((kept nil))
  (defun kept-here (value) (or kept (setf kept value)))
  (defun forget-kept () (setf kept nil)))

(test functions.that-keep-what-trials-roll-are-noticed
  (forget-kept)
  (is-true (has-words-p (refusal-of-trials 1 '(kept-here (random 9.0)))
                        "kept-here" "in a variable, which each trial binds"))
  (is (null (refusal-of-trials 1 '(kept-here (random 9.0)))) "what it has now, it has for all"))
