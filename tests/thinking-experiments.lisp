;;;; thinking-experiments.lisp -- what thinking costs as a condition of experiments.

(in-package :ars-magna.tests)
(in-suite thinking)

(defmacro define-thoughtful (&body clauses)
  "Define the experiment QUESTION: how long a plan takes that thinks for 7 ticks, with CLAUSES."
  `(define-for-test
     (:robots ars-worlds:dot)
     (:run (driver:run-plan (rpl:interp-lambda () (rpl:wait-time 1) (rpl:think 7) :thought)))
     (:measure (mode (run:simulation-thinking)))
     ,@clauses))

(defun thoughtful-ticks ()
  "Run QUESTION once in each condition; return conditions and ticks."
  (loop for row in (rows-of (experiment:run-experiment 'question :trials 1 :stream nil))
        collect (list (first row) (fifth row))))

(defun first-fingerprint ()
  (first (question-fingerprints)))

(test thinking-clause.is-for-all-trials
  (define-thoughtful)
  (is (equal '(("all" 1)) (thoughtful-ticks)))
  (define-thoughtful (:thinking :charged))
  (is (equal '(("all" 8)) (thoughtful-ticks)))
  (define-thoughtful (:thinking (:charged :budget 1)))
  (is (< 8 (second (first (thoughtful-ticks))) 20)))

(test thinking-clause.can-vary
  (define-thoughtful (:vary (:thinking :free :charged (:charged :budget 1000))))
  (is (equal '(("thinking=free" 1) ("thinking=charged" 8) 
               ("thinking=[\"charged\", \"budget\", 1000]" 8))
             (thoughtful-ticks)))
  (define-thoughtful (:vary (:thinking :in '(:charged (:charged :budget 1000)))))
  (is (equal '(8 8) (mapcar #'second (thoughtful-ticks))))
  (define-thoughtful (:conditions (quick (:thinking :free)) (slow (:thinking :charged))))
  (is (equal '(("quick" 1) ("slow" 8)) (thoughtful-ticks))))

(test thinking-clause.is-in-fingerprints-and-journals
  (flet ((fingerprint (mode)
           (eval `(define-thoughtful (:thinking ,mode)))
           (first-fingerprint)))
    (is (equal (fingerprint :charged) (fingerprint :charged)))
    (is (not (equal (fingerprint :charged) (fingerprint :free))))
    (is (not (equal (fingerprint '(:charged :budget 3)) (fingerprint '(:charged :budget 4))))))
  (define-thoughtful (:vary (:thinking :free :charged)))
  (is (= 2 (length (remove-duplicates (question-fingerprints) :test #'equal))))
  (let ((condition (experiment:find-condition 'question "thinking=charged")))
    (is (eq :charged
            (experiment::call-in-trial
             (lambda ()
               (getf (run:journal-header (run:simulation-journal time:*simulation*)) :thinking))
             (experiment:find-experiment 'question) condition 1 :journal t)))))

(test thinking-clause.is-checked
  (rejected-clause (:thinking) (:robots ars-worlds:dot) (:run t) (:thinking))
  (rejected-clause (:thinking :cheap) (:robots ars-worlds:dot) (:run t) (:thinking :cheap))
  (rejected-clause (:thinking :free :dear) (:robots ars-worlds:dot) (:run t)
    (:vary (:thinking :free :dear)))
  (rejected-clause (:thinking :free) (:robots ars-worlds:dot) (:run t) (:thinking :free)
    (:vary (:thinking :free :charged))))
