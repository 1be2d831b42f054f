;;;; rates.lisp -- checks of success rates: what they decide, and how often they err.

(in-package :ars-magna.tests)

(def-suite* rates :in ars-magna)

;;; How often they err, exactly.

(defun pass-share (rate &rest arguments)
  (values (apply #'rates:pass-probability rate arguments)))

(defun pass-share-of-paths (rate at-least trials level)
  "Return the same by trying all paths, one by one."
  (labels ((walk (successes count)
             (ecase (rates::verdict successes count trials (float at-least 1d0)
                                               (float level 1d0))
               (:passed 1)
               (:failed 0)
               ((nil) (+ (* rate (walk (1+ successes) (1+ count)))
                         (* (- 1 rate) (walk successes (1+ count))))))))
    (+ (* rate (walk 1 1)) (* (- 1 rate) (walk 0 1)))))

(test pass-probability.adds-up-all-paths
  (loop for (rate at-least trials level) in '((9/10 4/5 12 1/10) (1/2 4/5 12 1/20) (1/3 1/2 14 1/2)
                                              (3/4 1/10 12 1/5) (1 9/10 12 1/20) (0 9/10 12 1/20))
        do (is (near-p (pass-share-of-paths rate at-least trials level)
                       (pass-share rate :at-least at-least :trials trials :level level)))))

(test rates.that-are-high-enough-fail-as-rarely-as-the-level-says
  (dolist (level '(1/100 1/20 1/5))
    (dolist (trials '(1 2 5 20 50 200))
      (dolist (at-least '(1/10 1/2 4/5 9/10 19/20 99/100))
        (let ((share (pass-share at-least :at-least at-least :trials trials :level level)))
          (is (<= (- 1 share) level) "~A of ~D, ~A: ~F" at-least trials level share)
          (is (<= (- share 1d-12)
                  (pass-share (/ (1+ at-least) 2) :at-least at-least :trials trials
                                                  :level level))))))))

(test rates.that-are-much-too-low-fail-after-few-trials
  (loop for (rate most-passes most-trials) in '((9/10 .21 170) (17/20 .005 85) (3/4 1d-5 25)
                                                (1/2 1d-10 7))
        do (multiple-value-bind (share trials)
               (rates:pass-probability rate :at-least .95 :trials 200)
             (is (< share most-passes) "~A passes with ~F" rate share)
             (is (< trials most-trials) "~A takes ~F" rate trials)))
  (is (= 0 (pass-share 0)))
  (is (= 1 (pass-share 1)))
  (is (> 1d-3 (pass-share 9/10 :at-least 1 :trials 100)))
  (is (= 1 (pass-share 1 :at-least 1 :trials 100))))

(test pass-probability.checks-its-arguments
  (signals base:wrong-argument (rates:pass-probability 2))
  (signals base:wrong-argument (rates:pass-probability .9 :at-least 0))
  (signals base:wrong-argument (rates:pass-probability .9 :trials 0))
  (signals base:wrong-argument (rates:pass-probability .9 :level 1)))

;;; Checks. Each is made inside a test, but counts for none.

(defmacro check-of (&body forms)
  "Return whether the check that FORMS make passed, and the reason it gives."
  `(let ((results (results-of (lambda () ,@forms))))
     (is (= 1 (length results)))
     (values (passed-p (first results)) (failure-reason (first results)))))

(defvar *trials-seen* '() "The seeds of trials, the latest first.")

(defun note-trial ()
  (push (world:world-seed world:*world*) *trials-seen*))

(defmacro seeds-seen (&body forms)
  "Return the seeds that trials noted while FORMS ran, in order."
  `(let ((base:*message-queue* base:*message-queue*))
     (setf *trials-seen* '())
     ,@forms
     (reverse *trials-seen*)))

(test is-success-rate.passes-what-succeeds-often-enough
  (is (eq t (check-of (rates:is-success-rate (chance-p 9/10)
                       :robots ars-worlds:dot :at-least 4/5 :trials 100))))
  (eval '(rpl:def-interp-proc lazy-plan (what) (if what (rpl:fail :class 'too-lazy) t)))
  (is (eq t (check-of (rates:is-success-rate (driver:run-plan 'lazy-plan nil)
                        :robots (ars-worlds:dot) :trials 5))))
  (multiple-value-bind (passed reason)
      (check-of (rates:is-success-rate (driver:run-plan 'lazy-plan t)
                  :robots (ars-worlds:dot) :trials 5))
    (is (not passed))
    (is (mentions-p reason "failure: too-lazy"))))

(test is-success-rate.fails-what-succeeds-too-rarely-and-says-why
  (multiple-value-bind (passed reason)
      (check-of (rates:is-success-rate (if (chance-p 1/2) t (values nil :slipped))
                 :robots ars-worlds:dot :at-least 9/10 :trials 100 :seed 40))
    (is (not passed))
    (is (mentions-p reason "(if (chance-p 1/2) t (values nil :slipped))"))
    (is (mentions-p reason "succeeds less often than 90 %"))
    (is (mentions-p reason "failure: slipped"))
    (is (mentions-p reason "repeat-trial"))))

(test is-success-rate.stops-when-it-knows
  (let ((bad (seeds-seen (check-of (rates:is-success-rate (progn (note-trial) nil)
                                    :robots ars-worlds:dot :at-least .95 :trials 100 :seed 6))))
        (good (seeds-seen (check-of (rates:is-success-rate (progn (note-trial) t)
                                     :robots ars-worlds:dot :at-least 1/2 :trials 100)))))
    (is (equal '(7 8) bad))
    (is (equal (loop for seed from 1 to (length good) collect seed) good))
    (is (< (length good) 20))))

(test is-success-rate.of-one-needs-all
  (is (eq t (check-of (rates:is-success-rate t :robots ars-worlds:dot :at-least 1 :trials 20))))
  (let ((seen (seeds-seen
                (multiple-value-bind (passed reason)
                    (check-of (rates:is-success-rate (/= 9 (first (note-trial)))
                               :robots ars-worlds:dot :at-least 1 :trials 20))
                  (is (not passed))
                  (is (mentions-p reason "8 of 9 trials succeeded"))
                  (is (mentions-p reason "All should."))
                  (is (mentions-p reason "trial 9, seed 9: failure"))))))
    (is (= 9 (length seen)))))

(test is-success-rate.takes-errors-and-limits-as-failures
  (multiple-value-bind (passed reason)
      (check-of (rates:is-success-rate (error "The arm is off.") :robots ars-worlds:dot))
    (is (not passed))
    (is (mentions-p reason "error: The arm is off.")))
  (multiple-value-bind (passed reason)
      (check-of (rates:is-success-rate (run:run-until (constantly nil) :limit 1000)
                 :robots ars-worlds:dot :limit 50))
    (is (not passed))
    (is (mentions-p reason "trial 1, seed 1: not done in 50 ticks"))))

(test is-success-rate.begins-with-the-parameters-of-the-manual
  (let ((base:max-speed* 7) (base:motion-noise* 1/3))
    (flet ((passes-p (passed) (is-true passed)))
      (passes-p (check-of (rates:is-success-rate (and (/= 7 base:max-speed*)
                                                     (/= 1/3 base:motion-noise*))
                           :robots ars-worlds:dot :trials 5)))
      (passes-p (check-of (rates:is-success-rate (and (= 5 base:max-speed*)
                                                     (= 0 base:motion-noise*))
                           :robots ars-worlds:dot :trials 5 :clean t
                           :parameters '((base:max-speed* 5))))))))

(defun form-told-in (reason)
  "Return the form that a check's REASON ends with."
  (let ((*package* (find-package :ars-magna.tests)))
    (read-from-string reason t nil :start (search "(rates:repeat-trial" reason))))

(defvar *digest* (list nil) "A list of the digest that a form has noted last; trials share it.")

(defun digest-of-failure (reason)
  "Return the digest of the trial that a check's REASON repeats, where all has been set otherwise."
  (setf (first *digest*) nil)
  (let ((base:braking* 9) (base:motion-noise* .9)
        (*random-state* (make-random-state t)))
    (eval (form-told-in reason))
    (first *digest*)))

(defmacro repeats-p (&body check)
  "Make CHECK, which fails. The trial that it repeats must be the very same run."
  `(let ((reason (nth-value 1 (check-of ,@check))) (digest (first *digest*)))
     (is (integerp digest))
     (is (eql digest (digest-of-failure reason)))))

(test is-success-rate.tells-how-to-repeat-a-trial
  "With and without noise, whatever the parameters are here: the run is the same to the last bit."
  (let ((base:max-speed* 1/2))
    (repeats-p (rates:is-success-rate (note-digest) :robots ars-worlds:dot :trials 5 :at-least 1))
    (repeats-p (rates:is-success-rate (note-digest) :robots ars-worlds:dot :trials 5 :at-least 1
                                                    :clean t :parameters '((base:braking* 2))))
    (repeats-p (rates:is-success-rate (note-digest) :robots (ars-worlds:dot) :trials 5 :at-least 1
                                                    :seed -30
                                                    :parameters ((base:motion-noise* (/ 4 5)))))))

(test is-success-rate.repeats-what-lisps-dice-say
  (repeats-p (rates:is-success-rate (progn (command:robot-go-forward
                                            (robot:find-robot 'ars-worlds:dot) (+ 1 (random 3.0)))
                                           (run:run-ticks 20)
                                           (setf (first *digest*) (run:state-digest))
                                           nil)
               :robots ars-worlds:dot :trials 5 :at-least 1)))

(test is-success-rate.repeats-trials-that-do-not-end
  (multiple-value-bind (passed reason)
      (check-of (rates:is-success-rate (loop (run:run-ticks 1))
                  :robots ars-worlds:dot :limit 30))
    (is (not passed))
    (let ((plist (eval (form-told-in reason))))
      (is (string= "limit" (getf plist :outcome)))
      (is (= 30 (getf plist :ticks))))))

(test is-success-rate.takes-parameters-as-experiments-do
  (flet ((speed (passed) (is-true passed)))
    (speed (check-of (rates:is-success-rate (= 5 base:max-speed*)
                       :robots ars-worlds:dot :trials 3 :parameters ((base:max-speed* (+ 2 3))))))
    (let ((parameters '((base:max-speed* 5))))
      (speed (check-of (rates:is-success-rate (= 5 base:max-speed*)
                         :robots ars-worlds:dot :trials 3 :parameters parameters)))))
  (signals base:malformed-definition
    (eval '(rates:is-success-rate t :robots ars-worlds:dot :parameters ((base:max-speed* 5 6)))))
  (signals base:unknown-name
    (eval '(rates:is-success-rate t :robots ars-worlds:dot :parameters ((max-sped 5)))))
  (signals base:wrong-argument
    (eval '(rates:is-success-rate t :robots ars-worlds:dot :parameters 5))))

(test repeat-trial.can-be-looked-at-as-any-other
  (let ((plist (rates:repeat-trial (progn (run:run-ticks 20) (values nil :tired))
                 :robots ars-worlds:dot :seed 3 :until 7)))
    (is (= 7 (getf plist :ticks)))
    (is (null (getf plist :outcome))))
  (is (string= "tired" (getf (rates:repeat-trial (values nil :tired) :robots ars-worlds:dot)
                             :reason)))
  (signals base:malformed-definition (eval '(rates:repeat-trial t)))
  (signals base:malformed-definition (eval '(rates:repeat-trial t :robots ars-worlds:dot :sed 3)))
  (signals base:wrong-argument (eval '(rates:repeat-trial t :robots ars-worlds:dot :seed .5))))

(defun note-digest ()
  (command:robot-go-forward (robot:find-robot 'ars-worlds:dot) 3)
  (run:run-ticks 20)
  (setf (first *digest*) (run:state-digest))
  nil)

(test is-success-rate.is-the-same-by-any-number-of-threads
  (flet ((reason (workers)
           (nth-value 1 (check-of (rates:is-success-rate (chance-p 8/10)
                                   :robots ars-worlds:dot :at-least .95 :trials 300
                                   :workers workers)))))
    (is (string= (reason 1) (reason 2)))
    (is (string= (reason 1) (reason 3)))))

(test is-success-rate.has-fluents-of-each-trials-own
  (rpl:set-value *laps* 7)
  (dolist (workers '(1 2))
    (is-true (check-of (rates:is-success-rate
                           (progn (driver:run-plan 'laps 3) (= 3 (rpl:fluent-value *laps*)))
                         :robots ars-worlds:dot :at-least 1 :trials 100 :workers workers))))
  (is (= 7 (rpl:fluent-value *laps*))))

(test is-success-rate.checks-experiments-that-there-are
  (define-walk)
  (is-true (check-of (rates:is-success-rate (:experiment 'walk :condition 1) :at-least 1/2
                      :trials 50)))
  (multiple-value-bind (passed reason)
      (check-of (rates:is-success-rate (:experiment 'walk :condition "max-speed*=2")
                 :at-least .95 :trials 50))
    (is (not passed))
    (is (mentions-p reason "walk, max-speed*=2"))
    (is (mentions-p reason "replay-trial 'walk \"max-speed*=2\" ")))
  (signals base:misuse (rates:is-success-rate (:experiment 'walk)))
  (signals base:unknown-name (rates:is-success-rate (:experiment 'walk :condition 3)))
  (signals base:unknown-name (rates:is-success-rate (:experiment 'no-walk))))

(test is-success-rate.refuses-what-it-cannot-check
  (flet ((rejects (condition form) (is (typep (nth-value 1 (ignore-errors (eval form))) condition)
                                       "~S" form)))
    (rejects 'base:malformed-definition '(rates:is-success-rate t))
    (rejects 'base:malformed-definition '(rates:is-success-rate t :robots 5))
    (rejects 'base:malformed-definition '(rates:is-success-rate t :robots ars-worlds:dot :trails 5))
    (rejects 'base:malformed-definition
             '(rates:is-success-rate t :robots (ars-worlds:dot ars-worlds:robbie)))
    (rejects 'base:malformed-definition '(rates:is-success-rate (:experiment 'walk) :seed 3))
    (rejects 'base:malformed-definition '(rates:is-success-rate (:experiment 'walk 2)))
    (rejects 'base:wrong-argument '(rates:is-success-rate t :robots ars-worlds:dot :at-least 2))
    (rejects 'base:wrong-argument '(rates:is-success-rate t :robots ars-worlds:dot :trials 0))
    (rejects 'base:wrong-argument '(rates:is-success-rate t :robots ars-worlds:dot :seed .5))
    (rejects 'base:malformed-definition
             '(rates:is-success-rate t :robots ars-worlds:dot :parameters '((base:braking* -1))))))

;;; As users write it: a suite of their own, run as FiveAM runs it.

(def-suite plans-of-users)

(test (walking.is-reliable :suite plans-of-users)
  (rates:is-success-rate (chance-p 99/100) :robots ars-worlds:dot :at-least .9 :trials 60))

(test (walking.is-perfect :suite plans-of-users)
  (rates:is-success-rate (chance-p 1/2) :robots ars-worlds:dot :at-least .9 :trials 60))

(test is-success-rate.works-in-suites-of-users
  (let ((results (run 'plans-of-users)))
    (is (= 2 (length results)))
    (is (= 1 (count-if #'passed-p results)))
    (is (not (results-status results)))
    (is (mentions-p (with-output-to-string (*test-dribble*) (explain! results))
                    "succeeds less often than 90 %"))))
