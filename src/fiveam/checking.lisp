;;;; checking.lisp -- IS-SUCCESS-RATE, and the reasons of failed checks.

(in-package :ars-magna.fiveam)

(export '(is-success-rate))

(defparameter *most-failures-listed* 5
  "The largest number of unsuccessful trials that a failed check lists.")

(defun subject-text (check)
  (if (check-subject check)
      (form-text-for-check (subject-form (check-subject check)) check)
      (format nil "~(~A~), ~A" (experiment-name (check-experiment check))
              (condition-name (check-condition check)))))

(defun percent-text (share)
  (let ((text (format nil "~,2F" (* 100 share))))
    (format nil "~A %" (string-right-trim "." (string-right-trim "0" text)))))

(defun outcome-text (result check)
  (if (string= "limit" (result-outcome result))
      (format nil "not done in ~D ticks" (experiment-limit (check-experiment check)))
      (format nil "~A~:[: ~A~;~*~]~:[: ~A~;~*~]" (result-outcome result)
              (string= "" (result-reason result)) (result-reason result)
              (string= "" (result-error result)) (result-error result))))

(defun failed-trial-lines (bad check)
  "Return lines about the first *MOST-FAILURES-LISTED* of BAD, the unsuccessful results of CHECK."
  (append (loop for result in bad
                repeat *most-failures-listed*
                collect (format nil "  trial ~D, seed ~D: ~A" (result-trial result)
                                (result-seed result) (outcome-text result check)))
          (when (> (length bad) *most-failures-listed*)
            (list (format nil "  and ~D more" (- (length bad) *most-failures-listed*))))))

(defun success-count-text (check)
  (let ((trials (length (check-results check))) (successes (check-successes check)))
    (format nil "~D of ~D trial~:P succeeded, ~A" successes trials
            (percent-text (/ successes trials)))))

(defun false-alarm-text (check)
  (if (= 1 (check-at-least check))
      "All should."
      (format nil "If ~A or more succeeded in the long run, this check would fail with a ~
                   probability of at most ~A."
              (percent-text (check-at-least check)) (percent-text (check-level check)))))

(defun failure-text (check)
  (let ((bad (remove-if #'success-p (reverse (check-results check)))))
    (format nil "~A~%succeeds less often than ~A: ~A.~%~A~%Trials that did not ~
                 succeed:~%~{~A~%~}To repeat the first of them, in the package ~A:~%  ~A"
            (subject-text check) (percent-text (check-at-least check)) (success-count-text check)
            (false-alarm-text check) (failed-trial-lines bad check)
            (package-name (experiment-package (check-experiment check)))
            (repeat-trial-text check (first bad)))))

;;;; The check

(defun resolve-condition (experiment condition)
  "Return the condition of EXPERIMENT for the designator CONDITION; for NIL, the only condition."
  (let ((all (experiment-conditions experiment)))
    (cond (condition (find-condition experiment condition))
          ((rest all)
           (reject-use "The experiment ~(~A~) has several conditions; name one of them, as in ~
                        (:experiment '~(~A~) :condition ~S)."
                       (experiment-name experiment) (experiment-name experiment)
                       (condition-name (first all))))
          (t (first all)))))

;;; Checking.

(defun run-and-report-check (experiment condition subject at-least trials level workers)
  "Check, with at most TRIALS trials of CONDITION of EXPERIMENT, that the rate of success is
AT-LEAST or more. SUBJECT is the subject for which EXPERIMENT was made, or NIL. Report the result to
FiveAM; return true if the check passes."
  (check-rate-arguments 'is-success-rate at-least trials level)
  (check-argument is-success-rate workers (whole-p workers 1 1000)
                  "a number of threads, from 1 to 1000")
  (let ((check (run-check (make-check experiment condition subject (share-as-double at-least) trials
                                      (share-as-double level) workers))))
    (cond ((eq :passed (check-verdict check))
           (pass "~A: ~A" (subject-text check) (success-count-text check))
           t)
          (t (fail "~A" (failure-text check))
             nil))))

(defun check-form-rate (subject at-least trials level workers seed)
  (let ((experiment (experiment-for-subject subject 'is-success-rate seed)))
    (run-and-report-check experiment (first (experiment-conditions experiment)) subject
                          at-least trials level workers)))

(defun check-experiment-rate (name condition at-least trials level workers)
  (let ((experiment (find-experiment name)))
    (run-and-report-check experiment (resolve-condition experiment condition) nil
                          at-least (or trials (experiment-trials experiment)) level workers)))

(defun parse-experiment-clause (form options)
  "Return a list of name and condition in FORM, (:experiment name :condition c). Signals
MALFORMED-DEFINITION for another FORM, or if there are OPTIONS, which the experiment determines."
  (unless (and (proper-list-p form) (member (length form) '(2 4))
               (or (null (cddr form)) (eq :condition (third form))))
    (reject-clause "is-success-rate" form "(:experiment name) or (:experiment name :condition c)"))
  (when options
    (reject-clause "is-success-rate" form
                   (format nil "no option ~(~S~), because the experiment determines it"
                           (first options))))
  (list (second form) (fourth form)))

(define-user-macro is-success-rate
    (form &rest options
          &key robots (at-least .95) trials (level .05) (seed 0) parameters clean ghosts
          (limit +default-tick-limit+) (workers 1)
     &environment environment)
  "Check, in a test of FiveAM, that the rate of success of FORM is at least AT-LEAST, by default
.95. Return true if the check passes. Signals MALFORMED-DEFINITION, WRONG-ARGUMENT and UNKNOWN-NAME.

  (is-success-rate (run-plan 'fetch-thing '((:color blue)) '((109 24)))
    :robots marvin :at-least .9 :trials 60 :parameters ((motion-noise* .2) (max-speed* 2)))

Each trial evaluates FORM in a fresh headless simulation. ROBOTS is the name of a robot, a list of
names and entries (NAME :as OTHER-NAME :at (X Y) :angle A), see WITH-SIMULATION, or a form that
computes such a list; names that are written out are bound to the robots. If GHOSTS is true, robots
have no bodies. As for :run of an experiment, the values of RUN-PLAN, or else the first value of
FORM, decide whether the trial succeeded. Trials with an error or with more than LIMIT ticks do not
succeed: so :limit 300 :at-least 1/2 checks that the median of ticks is at most 300. Trial T has the
seed SEED + T. Parameters have the values of the manual, except those in PARAMETERS: lists (name
form) as in DEFEXPERIMENT, or a form that returns lists (name value). If CLEAN is true, trials have
no noise.

FORM may also be (:experiment NAME) or (:experiment NAME :condition C). Then the check runs trials
of the experiment NAME, which determines robots, seed, parameters and limit.

At most TRIALS trials are run: by default 200, or the number that the experiment specifies. The
check fails as soon as the rate is clearly lower than AT-LEAST, and passes as soon as it is clearly
higher. After the last trial the check fails if the rate is significantly below AT-LEAST, else it
passes. (RATE-VERDICT decides after each trial, EXACT-INTERVAL at the end, each with half of LEVEL.)
So a form whose rate of success is really AT-LEAST or more fails the check with a probability of at
most LEVEL. PASS-PROBABILITY returns the probability that a check passes for a given rate; with more
trials, a low rate is noticed more often. If AT-LEAST is 1, all trials must succeed.

Seeds are fixed, so the same code gives the same result, with any number WORKERS of threads. With
several threads FORM does not see the dynamic bindings of the test. The message about a failure
gives the numbers, the first unsuccessful trials with reasons, and a form that repeats one of these
trials, by REPEAT-TRIAL or REPLAY-TRIAL, in any Lisp with the same code."
  (if (and (consp form) (eq :experiment (first form)))
      (destructuring-bind (name condition)
          (parse-experiment-clause form (intersection '(:robots :seed :parameters :clean :ghosts
                                                     :limit)
                                                      options))
        `(check-experiment-rate ,name ,condition ,at-least ,trials ,level ,workers))
      `(check-form-rate ,(subject-expansion "is-success-rate" form robots parameters clean
                                             ghosts limit environment)
                        ,at-least ,(or trials 200) ,level ,workers ,seed)))
