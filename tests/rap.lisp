;;;; rap.lisp -- reactive action packages: memory, methods, task nets, agenda.

(ars:define-user-package :ars-magna.tests.rap
  (:documentation "Tests of reactive action packages, in the words of their users.")
  (:use :cl :ars :nisp :ars-rap)
  (:import-from :ars-magna.basics #:with-debugger-hook)
  (:import-from :ars-magna.tests #:def-suite* #:in-suite #:test #:is #:signals))

(in-package :ars-magna.tests.rap)

(def-suite* ars-magna.tests::rap :in ars-magna.tests::ars-magna)

(defmap rap-floor (20 20))
(defrobot rapper (rap-floor (4 10) 0))

(defvar *rap-notes* '() "Lists (tick what), the newest first.")

(defun note-rap (what) (push (list (simulation-tick) what) *rap-notes*))

(defmacro rap-notes (&body body)
  "Return what BODY notes in a run."
  `(let ((*rap-notes* '()))
     (with-simulation (rapper :seed 1) ,@body)
     (reverse *rap-notes*)))

(defmacro in-rap-run (&body body) `(with-simulation (rapper :seed 1) ,@body))

(defun failure-of-run (plan &rest arguments)
  "Run PLAN and return its failure, or NIL."
  (let ((value (apply #'run-plan plan arguments)))
    (and (typep value 'plan-failure) value)))

;;; Memory.

(test rap.facts-are-added-set-and-deleted
  (in-rap-run
    (memory-add '(at ball hall))
    (memory-add '(at cup hall))
    (memory-set '(at ball yard))
    (is (equal '(yard) (memory-query '?p '(at ball ?p))))
    (is (equal '(hall) (memory-query '?p '(at cup ?p))))
    (is (= 2 (memory-delete '(at ? ?))))
    (is (= 0 (memory-delete '(at ? ?))))
    (is (null main-memory*))))

(test rap.an-added-fact-is-renewed
  (in-rap-run
    (memory-add '(seen cat))
    (run-ticks 10)
    (memory-add '(seen dog))
    (is (memory-holds-p '(within 5 (seen dog))))
    (is (not (memory-holds-p '(within 5 (seen cat)))))
    (is (memory-holds-p '(within 10 (seen cat))))
    (memory-add '(seen cat))
    (is (= 2 (length main-memory*)))
    (is (= 10 (memory-tick '(seen cat))))))

(test rap.queries-combine-patterns
  (in-rap-run
    (mapc #'memory-add '((size cup 3) (size pan 9) (size box 5) (red cup) (red pan)))
    (is (equal '(pan cup) (memory-query '?x '(and (red ?x) (size ?x ?s)))))
    (is (equal '(cup) (memory-query '?x '(and (red ?x) (size ?x ?s) (< ?s 5)))))
    (is (equal '(box) (memory-query '?x '(and (size ?x ?) (not (red ?x))))))
    (is (equal '((cup 3) (box 7)) (memory-query '(?x ?n) '(or (and (size ?x ?n) (= ?n 3))
                                                           (and (size ?x 5) (= ?n 7))))))
    (is (equal '() (memory-query '?x '(same ?x ?x))))
    (memory-add '(pair 1 2))
    (memory-add '(pair 2 2.0))
    (is (equal '(2) (memory-query '?x '(pair ?x ?x))))))

(define-memory-rule rap-above (above ?a ?b) (or (on ?a ?b) (and (on ?a ?c) (above ?c ?b))))
(define-memory-rule rap-endless (deeper ?a ?b) (deeper (box ?a) ?b))

(test rap.rules-follow-chains-and-circles
  (in-rap-run
    (mapc #'memory-add '((on a b) (on b c) (on c d)))
    (is (equal '(b c d) (memory-query '?x '(above a ?x))))
    (is (equal '(c b a) (memory-query '?x '(above ?x d))))
    (memory-add '(on d a))
    (is (equal '(b c d a) (memory-query '?x '(above a ?x))))
    (signals misuse (memory-query '?x '(deeper a ?x)))))

(test rap.facts-and-queries-are-checked
  (in-rap-run
    (signals wrong-argument (memory-add '(at ?x hall)))
    (signals wrong-argument (memory-add 'ball))
    (signals wrong-argument (memory-add '(not (at ball))))
    (signals wrong-argument (memory-add '(at . hall)))
    (signals wrong-argument (memory-add (list 'at (lambda () 1))))
    (signals wrong-argument (memory-query '?x '(and (at ?x) (not))))
    (signals wrong-argument (memory-query '?x '(test (print 1))))
    (signals misuse (memory-holds-p '(< ?x 3)))
    (signals misuse (memory-holds-p '(within ?n (ball))))
    (signals misuse (memory-holds-p '(and (= ?n soon) (within ?n (ball)))))
    (handler-case (memory-set '(ball))
      (wrong-argument (condition)
        (is (search "memory-set: fact is (ball)" (string-downcase (princ-to-string condition))))))
    (signals misuse (memory-holds-p '(< a 3)))
    (is (null main-memory*)))
  (signals misuse (memory-add '(no run))))

;;; Methods.

(define-rap (index (rap-work ?what ?ticks))
  (method (primitive (wait-time ticks) (note-rap what) (memory-add `(done ,what)))))

(define-rap (index (rap-try ?thing))
  (succeed (got ?thing))
  (attempts 2)
  (method first-way (context (way ?thing ?n)) (primitive (note-rap n) (fail)))
  (method second-way (primitive (note-rap :second) (memory-add '(way ball 9)))))

(test rap.tries-what-it-has-tried-least
  "A fact that a try adds is tried next, as often as the others."
  (let (failure)
    (is (equal '((0 2) (0 1) (0 :second) (0 9) (0 9) (0 2) (0 1) (0 :second))
               (rap-notes (memory-add '(way ball 1))
                          (memory-add '(way ball 2))
                          (setf failure (failure-of-run 'rap-try 'ball)))))
    (is (typep failure 'rap-failed))
    (is (eq 'rap-try (rap-failed-name failure)))
    (is (= 8 (length (rap-failed-tries failure))))
    (is (equal '((first-way (9)) (first-way (9)))
               (loop for (method values) in (subseq (reverse (rap-failed-tries failure)) 3 5)
                     collect (list method values))))))

(test rap.does-nothing-if-its-success-test-holds
  (is (equal '() (rap-notes (memory-add '(got ball)) (is (eq t (run-plan 'rap-try 'ball)))))))

(define-rap (index (rap-find ?kind => ?thing ?size))
  (succeed (and (kind ?thing ?kind) (size ?thing ?size)))
  (method (primitive (wait-time 3) (memory-add `(kind rose ,kind)) (memory-add '(size rose 7)))))

(define-rap (index (rap-double ?n => ?m)) (method (primitive (setf m (* 2 n)))))

(define-rap (index (rap-garden))
  (method (task-net (sequence (find (rap-find flower => ?thing ?size))
                              (double (rap-double ?size => ?more))
                              (work (rap-work (sold ?thing ?more) 1))))))

(test rap.results-go-to-later-steps
  (is (equal '((4 (sold rose 14))) (rap-notes (run-plan 'rap-garden))))
  (is (equal '(rose 7) (in-rap-run (run-plan (interp-lambda ()
                                              (multiple-value-bind (thing size) (rap-find 'flower)
                                                (list thing size))))))))

(define-rap (index (rap-broken))
  (method (primitive (error "broken arm")))
  (method (primitive (note-rap :never))))

(test rap.an-error-of-lisp-ends-it
  (let ((notes (rap-notes (is (typep (failure-of-run 'rap-broken) 'lisp-failure)))))
    (is (equal '() notes))))

(define-rap (index (rap-lose ?thing))
  (method (context (at ?thing ?place))
          (primitive (memory-delete `(at ,thing ?))
                     (memory-add (list 'gone ?thing ?place (memory-query '?x '(at ?x ?)))))))

(test rap.quoted-data-in-code-stay-patterns
  (in-rap-run
    (mapc #'memory-add '((at cup sink) (at pan stove)))
    (run-plan 'rap-lose 'cup)
    (is (equal '((gone cup sink (pan)) (at pan stove)) (mapcar #'first main-memory*)))))

;;; Task nets.

(define-rap (index (rap-hum ?what))
  (method (primitive (evap-protect (wait-time 50) (note-rap what)))))

(define-rap (index (rap-signal ?ticks))
  (method (primitive (wait-time ticks) (memory-add '(signal)) (wait-time 4) (note-rap :over))))

(define-rap (index (rap-net-1))
  (method (task-net (a (rap-work a 5)) (b (rap-work b 2) (for c)) (c (rap-work c 2)))))

(define-rap (index (rap-net-2))
  (method (task-net (hum (rap-hum :hum) (until-end b))
                    (start (rap-hum :start) (until-start b))
                    (signal (rap-signal 3) (wait-for (signal) b))
                    (b (rap-work b 2)))))

(define-rap (index (rap-net-3))
  (method (task-net (hum (rap-hum :hum) (wait-for (signal) :succeed)) (signal (rap-signal 3)))))

(define-rap (index (rap-net-4))
  (method (task-net (hum (rap-hum :hum) (wait-for (signal) :fail)) (signal (rap-signal 3))))
  (method (primitive (note-rap :other))))

(define-rap (index (rap-net-5))
  (method (task-net (sequence (parallel (a (rap-work a 5)) (b (rap-work b 2)))
                              (sequence (c (rap-work c 1)) (d (rap-work d 1)))))))

(test rap.task-nets-order-their-steps
  (is (equal '((2 b) (4 c) (5 a)) (rap-notes (run-plan 'rap-net-1))))
  (is (equal '((3 :start) (5 b) (5 :hum) (7 :over)) (rap-notes (run-plan 'rap-net-2))))
  (is (equal '((3 :hum) (7 :over)) (rap-notes (run-plan 'rap-net-3))))
  (is (equal '((3 :hum) (3 :other)) (rap-notes (run-plan 'rap-net-4))))
  (is (equal '((2 b) (5 a) (6 c) (7 d)) (rap-notes (run-plan 'rap-net-5)))))

(define-run-variable *rap-slips* 2 "How many tries fail.")

(define-rap (index (rap-clean))
  (method (primitive (wait-time 1) (note-rap :clean)
                     (if (zerop *rap-slips*) (memory-add '(clean)) (decf *rap-slips*)))))

(define-rap (index (rap-serve))
  (attempts 1)
  (method (task-net (clean (rap-clean) ((clean) for serve)) (serve (rap-work serve 1)))))

(test rap.a-step-is-repeated-until-what-it-is-for-holds
  (is (equal '((1 :clean) (2 :clean) (3 :clean) (4 serve)) (rap-notes (run-plan 'rap-serve))))
  (let ((notes (rap-notes (setf *rap-slips* 9)
                          (is (typep (failure-of-run 'rap-serve) 'rap-failed)))))
    (is (equal '((1 :clean) (2 :clean) (3 :clean) (4 :clean)) notes))))

(defun rap-mistake (form)
  "Return the text of the error of FORM."
  (handler-case (progn (macroexpand-1 form) nil)
    (malformed-definition (condition) (princ-to-string condition))))

(test rap.mistakes-in-definitions-are-named
  (loop for (form . text)
          in '(((define-rap foo) . "one of the clauses")
               ((define-rap (succeed (x))) . "a clause (index")
               ((define-rap (index (foo ?x)) (succeed (x))) . "at least one clause (method")
               ((define-rap (index (foo ?x ?x)) (method (primitive 1))) . "different variables")
               ((define-rap (index (foo bar)) (method (primitive 1))) . "an index (name")
               ((define-rap (index (foo)) (method (primitiv 1))) . "one of the clauses")
               ((define-rap (index (foo)) (method (primitive 1) (task-net (a (b))))) . "either")
               ((define-rap (index (foo)) (method (task-net (a (b)) (a (b))))) . "different tags")
               ((define-rap (index (foo)) (method (task-net (a (b) (for c)))))
                . "the tag of a step")
               ((define-rap (index (foo)) (method (task-net (a (b ?x))))) . "no ?x")
               ((define-rap (index (foo)) (method (task-net (a (b) (until-end a)))))
                . "another step")
               ((define-rap (index (foo)) (method (task-net (a (b) (until-hell a)))))
                . "(until-start tag) or (until-end tag)")
               ((define-rap (index (foo)) (method (context (and x)) (primitive 1))) . "a pattern")
               ((define-rap (index (foo => ?x)) (succeed (y)) (method (primitive 1))) . "?x")
               ((define-rap (index (foo)) (attempts 0) (method (primitive 1))) . "(attempts n)")
               ((define-rap (index (foo)) (method (task-net))) . "at least one step")
               ((define-rap (index (foo)) (method (primitive))) . "at least one form")
               ((define-rap (index (foo)) (method (resources ?x) (primitive 1))) . "have values")
               ((define-rap (index (list)) (method (primitive 1)))
                . "define-rap list: cannot use the clause")
               ((define-rap . foo) . "define-rap")
               ((define-memory-rule 3 (a) (b)) . "a symbol as the name")
               ((define-memory-rule r (not a) (b)) . "a pattern of facts")
               ((define-memory-rule r (a) (or b)) . "a pattern such as"))
        do (let ((mistake (rap-mistake form)))
             (is (and mistake (search text mistake)) "~S: ~A" form mistake))))

;;; The agenda.

(define-rap (index (rap-use ?what ?ticks))
  (resources arm)
  (method (task-net (work (rap-work ?what ?ticks)))))

(test rap.goals-share-resources-by-priority
  (is (equal '((3 high) (5 middle) (7 low))
             (rap-notes
               (install-goal '(rap-use low 2) 1)
               (install-goal '(rap-use middle 2) 2)
               (install-goal '(rap-use high 3) 3)
               (is (= 3 (process-goal-agenda)))
               (is (null (agenda-goals '(:waiting :active :failed))))))))

(define-rap (index (rap-boss))
  (method (primitive (wait-time 2) (install-goal '(rap-use urgent 3) 9))))

(test rap.urgent-goals-take-resources
  "The timer of a suspended task goes on."
  (is (equal '((5 urgent) (6 slow))
             (rap-notes
               (install-goal '(rap-use slow 6) 1)
               (install-goal '(rap-boss))
               (is (= 3 (process-goal-agenda)))))))

(test rap.goals-fail-at-their-deadline
  (in-rap-run
    (install-goal '(rap-use a 5) 2 3)
    (install-goal '(rap-use b 2) 1)
    (is (= 1 (process-goal-agenda)))
    (is (equal '(:failed :achieved) (mapcar (lambda (goal) (getf goal :state)) (agenda-goals))))
    (is (= 6 (simulation-tick)))
    (is (search "Not achieved by tick 3."
                (with-output-to-string (stream) (dump-agenda :stream stream))))
    (is (not (execute-goal '(rap-use c 5) 0 7)))
    (is (execute-goal '(rap-use c 5) 0 70))
    (reset-agenda)
    (is (null main-agenda*))))

(test rap.an-error-of-lisp-in-a-goal-is-reported-as-that-of-a-plan
  (with-simulation (rapper :seed 1 :errors :collect)
    (is (not (execute-goal '(rap-broken))))
    (let ((told (with-output-to-string (*standard-output*) (error-display))))
      (is (search "broken arm" told) "~A" told)
      (is (search "at tick 0 in" told)))
    (is (search "broken arm" (getf (first (agenda-goals)) :note))))
  (handler-case (with-simulation (rapper :errors :signal)
                  (install-goal '(rap-broken))
                  (begin-plan 'work-on-agenda)
                  (run-ticks 5)
                  (is (null :signal)))
    (user-code-error (condition)
      (is (search "The goal (rap-broken) failed: " (princ-to-string condition)) "~A" condition))))

(test rap.a-goal-whose-plan-is-ended-has-failed
  (in-rap-run
    (install-goal '(rap-use a 50) 1)
    (let ((task (begin-plan 'work-on-agenda)))
      (run-ticks 5)
      (end-plan task)
      (run-ticks 2))
    (is (equal '(:failed) (mapcar (lambda (goal) (getf goal :state)) (agenda-goals))))
    (install-goal '(rap-use b 2) 1)
    (is (= 1 (process-goal-agenda)))))

(test rap.goals-are-checked
  (in-rap-run
    (signals wrong-argument (install-goal '(rap-use ?x 1)))
    (signals wrong-argument (remove-goal '(rap-use a 1)))
    (signals wrong-argument (install-goal '(no-such-rap)))
    (signals wrong-argument (install-goal 'rap-boss))
    (signals wrong-argument (install-goal '(rap-boss) :high))
    (signals wrong-argument (install-goal '(rap-boss) 1 :soon))
    (let ((number (install-goal '(rap-boss))))
      (is (remove-goal number))
      (is (not (remove-goal number))))
    (is (null main-agenda*))))

;;; Forks and rewinds.

(test rap.forks-and-rewinds-are-exact
  (with-simulation (rapper :seed 1 :keep t)
    (let ((*rap-notes* '()))
      (flet ((outcome () (list main-memory* (agenda-goals) (state-digest))))
        (install-goal '(rap-use slow 6) 1)
        (install-goal '(rap-boss))
        (begin-plan 'work-on-agenda)
        (run-ticks 3)
        (let ((now (outcome))
              (ahead (with-fork () (run-ticks 20) (outcome))))
          (is (equal now (outcome)))
          (run-ticks 20)
          (is (equal ahead (outcome)))
          (rewind 20)
          (is (equal now (outcome)))
          (run-ticks 20)
          (is (equal ahead (outcome))))))))
