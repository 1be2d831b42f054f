;;;; several-mistakes.lisp -- plans of several robots: which robot is meant, mistakes, messages.

(in-package :ars-magna.tests)

(eval-when (:compile-toplevel :load-toplevel :execute)
  (sb-ext:add-package-local-nickname :projecting :ars-magna.rpl-projecting :ars-magna.tests))

(def-suite* several-mistakes :in ars-magna)

(rpl:def-interp-proc name-robot (metres)
  (driver:rpl-robot-go-forward (round (/ metres 0.8)))
  (rpl:wait-for driver:robot-stopped*)
  (robot:robot-name (driver:rpl-robot)))

(rpl:def-interp-proc meet-other (metres &key robot)
  (list metres robot (robot:robot-name (driver:rpl-robot))))

(rpl:def-interp-proc give-up () (rpl:fail :class :tired))

(defun rollout-values (projection)
  (mapcar #'projecting:rollout-value (projecting:projection-rollouts projection)))

(defmacro error-text (&body body)
  "Return the text of the error in BODY, or NIL."
  `(text-of-error (lambda () ,@body)))

;;; PROJECT.

(test project.drives-the-robot-after-the-arguments
  (with-three ()
    (is (equal '((ben ben) (cyd cyd) (ada) (1 cyd ben))
               (driver:run-plan
                (rpl:interp-lambda ()
                  (list (rollout-values (projecting:project '(name-robot 1 :robot ben) :trials 2))
                        (rollout-values
                         (projecting:project 'name-robot :arguments (list 1 :robot cyd) :trials 2))
                        (rollout-values (projecting:project '(name-robot 1) :trials 1))
                        ;; MEET takes :ROBOT itself.
                        (first (rollout-values
                                (driver:on-robot (ben)
                                  (projecting:project '(meet-other 1 :robot cyd) :trials 1))))))
                :robot ada)))))

(test project.outside-of-plans-drives-the-robot-after-the-arguments
  (with-three ()
    (is (equal '(ben) (rollout-values
                       (projecting:project-plan '(name-robot 1 :robot ben) :trials 1))))
    (is (equal '(cyd) (rollout-values
                       (projecting:project-plan 'name-robot :arguments '(1 :robot cyd)
                                                            :trials 1))))
    (is (equal '((1 ben ada))
               (rollout-values (projecting:project-plan '(meet-other 1 :robot ben) :robot ada
                                                                             :trials 1))))))

(test project.of-a-busy-robot-ends-none-of-its-plans
  (with-three ()
    (let ((busy (driver:begin-plan 'name-robot 16 :robot ben)))
      (flet ((projection ()
               (projecting:project-plan '(name-robot 1 :robot ben) :trials 1)))
        (is (equal '(ben) (rollout-values (projection))))
        (is (equal '(ben) (driver:run-plan
                           (rpl:interp-lambda ()
                             (rollout-values
                              (projecting:project '(name-robot 1 :robot ben) :trials 1)))
                           :robot ada)))
        (is-true (search "(name-robot 1 :robot ben)"
                         (projecting:projection-text (projection))))
        (is-false (rpl:task-over-p busy))
        (run:run-ticks 60)
        (is (eq 'ben (rpl:task-result busy)))))))

(test project.begins-the-plan-of-another-robot-inside-of-the-asking-plan
  (with-three ()
    (let ((rollout (first (projecting:projection-rollouts
                           (driver:run-plan
                            (rpl:interp-lambda ()
                              (projecting:project '(name-robot 8 :robot ben) :trials 1))
                            :robot ada)))))
      (is (equal '(5 13)
                 (projecting:with-rollout (rollout)
                   (mapcar (lambda (name) (x-of (robot:find-robot name))) '(ada ben)))))
      (is (equal '(:tired) (mapcar #'car
                                   (projecting:projection-failures
                                    (driver:run-plan
                                     (rpl:interp-lambda ()
                                       (projecting:project '(give-up :robot ben) :trials 2))
                                     :robot ada))))))))

(test project.in-a-believed-world-knows-robots-by-name
  (with-three ()
    (flet ((believe (function seed)
             (run:with-simulation ((cyd ben) :seed seed :clean t) (funcall function))))
      (is (equal '(ben) (rollout-values
                         (projecting:project-plan (list 'name-robot 1 :robot ben)
                                                  :trials 1 :world #'believe)))))))

(test project.refuses-robots-that-plans-cannot-drive
  (with-three ()
    (is (has-words-p (error-text (projecting:project-plan '(name-robot 1 :robot nobody)))
                     "no robot in this run called nobody" "ada, ben, cyd"))
    (is (has-words-p (error-text (projecting:project-plan '(name-robot 1 :robot ben) :robot 'ada))
                     "robot is ADA" "none, since the arguments of the plan end with :robot"))
    (is (has-words-p (error-text (projecting:project-plan
                                  (driver:begin-plan 'name-robot 1 :robot 'ada) :robot 'ben))
                     "none, since a task has its robot"))))

;;; Which robot a plan drives.

(test plans.that-take-a-robot-themselves-say-so
  (with-three ()
    (let ((text (error-text (driver:begin-plan 'meet-other 1 :robot 'ben))))
      (is (has-words-p text "The plan meet-other takes :robot itself" "(rpl-init-robot ada)"
                       "(run-plan (interp-lambda () (meet-other ...)) :robot 'ada)")))
    (is (has-words-p (error-text (driver:begin-plan 'name-robot 1))
                     "or :robot ROBOT after the arguments of the plan"))
    (driver:rpl-init-robot ada)
    (is (equal '(1 ben ada) (driver:run-plan 'meet-other 1 :robot 'ben)))
    (is (equal '(1 ben cyd)
               (driver:run-plan (rpl:interp-lambda () (meet-other 1 :robot 'ben)) :robot 'cyd)))))

(test plans.name-the-robots-of-the-run
  (with-three ()
    (dolist (text (list (error-text (driver:begin-plan 'name-robot 1 :robot 'nobody))
                        (error-text (driver:plans 'nobody))
                        (error-text (driver:robot-fluent 'nobody 'driver:robot-stopped*))
                        (error-text (driver:rpl-init-robot 'nobody))))
      (is (string= "There is no robot in this run called nobody. Known: ada, ben, cyd." text)))
    (dolist (several (list :all (list ada ben)))
      (is (has-words-p (error-text (driver:run-plan 'name-robot 1 :robot several))
                       "Give one robot. Each robot needs a plan of its own"
                       "(begin-plan PLAN ... :robot robot)")))))

(test end-plan.of-all-plans-needs-none
  (with-three ()
    (is (null (multiple-value-list (driver:end-plan :all))))
    (is (null (multiple-value-list (driver:end-plan :all :robot ben)))))
  (run:with-simulation (ada :clean t)
    (is (null (multiple-value-list (driver:end-plan :all)))))
  (let ((ars-magna.time:*simulation* nil))
    (signals base:misuse (driver:end-plan :all))))

(test end-plan.refuses-a-robot-of-another-run
  (run:with-simulation ((ada ben) :clean t)
    (driver:begin-plan 'name-robot 8 :robot 'ada)
    (is (has-words-p (error-text (driver:end-plan :all :robot 'cyd)) "No plan can drive CYD here"))
    (is (= 1 (length (driver:plans))))))

(test plans.live-refuse-a-robot-that-has-left
  (with-own-definitions ()
    (eval '(world:defmap fold (20 20)))
    (eval '(robot:defrobot ewe (fold (3 3) 0)))
    (eval '(robot:defrobot ram (fold (3 7) 0)))
    (let ((ram (robot:find-robot 'ram)))
      (with-stopped-run (ewe)
        (ars:undefine 'robot 'ram)
        (dolist (text (list (error-text (driver:begin-plan 'give-up :robot ram))
                            (error-text (driver:run-plan 'give-up :robot ram))
                            (error-text (driver:end-plan :all :robot ram))))
          (is (has-words-p text "No plan can drive RAM any more"
                           "Use a robot of the run, such as ewe")))
        (is (null (driver:plans)))))))

;;; Messages.

(test plans.are-named-by-the-run-of-several-robots
  (flet ((owner-text (robot)
           (driver:begin-plan 'name-robot 8 :robot robot)
           (definitions:text-of-origin
            (run:participant-origin (driver:interface-of-simulation time:*simulation*)))))
    (with-three () (is (string-equal "the plans of croft" (owner-text ben))))
    (run:with-simulation (ben :clean t)
      (is (string-equal "the plans of ben" (owner-text 'ben))))))

(test errors.of-plans-name-the-robot-among-several
  (flet ((errors (robots)
           (run:with-simulation (robots :clean t :errors :collect)
             (driver:begin-plan 'give-up :robot 'ben)
             (run:run-ticks 1)
             (mapcar #'princ-to-string (run:simulation-errors)))))
    (is (equal '("The plan give-up of ben failed: Plan failure :TIRED") (errors '(ada ben))))
    (is (equal '("The plan give-up failed: Plan failure :TIRED") (errors 'ben))))
  (is (string= "The plan give-up of ben failed: Plan failure :TIRED"
               (error-text (run:with-simulation ((ada ben) :errors :signal)
                             (driver:begin-plan 'give-up :robot 'ben)
                             (run:run-ticks 1))))))

(defun shown-after-plan (robots plan)
  "Return what is shown of messages after PLAN of the robot BEN, in a run of ROBOTS."
  (run:with-simulation (robots :clean t)
    (driver:begin-plan plan :robot 'ben)
    (run:run-ticks 2)
    (with-output-to-string (out) (base:error-display out))))

(test aborts-and-breaks.of-plans-name-the-robot-among-several
  (let ((aborting (rpl:interp-lambda () (abort)))
        (breaking (rpl:interp-lambda () (break "look"))))
    (is-true (search "*ERROR* -> ben: (abort) was aborted at (abort)"
                     (shown-after-plan '(ada ben) aborting)))
    (is-true (search "*ERROR* -> (abort) was aborted at (abort)" (shown-after-plan 'ben aborting)))
    (is (has-words-p (shown-after-plan '(ada ben) breaking) "ben: Break in " "look"))
    (is (has-words-p (shown-after-plan 'ben breaking) "Break in " "look"))
    (is-false (search "ben: Break in" (shown-after-plan 'ben breaking)))))

(test breaks.at-the-prompt-name-the-robot-among-several
  (flet ((text (robots)
           (run:with-simulation (robots :clean t)
             (driver:run-plan
              (rpl:interp-lambda ()
                (cli::break-condition-text
                 (cli::break-request-for-condition
                  (make-condition 'simple-condition :format-control "oh") '())))
              :robot 'ben))))
    (is (string= "ben: oh" (text '(ada ben))))
    (is (string= "oh" (text 'ben)))))

;;; Names that begin with a colon.

(robot:defrobot |:ODD| (croft (5 35) 0))

(test names.that-begin-with-a-colon-can-be-saved
  (is (eq '|:ODD| (robot:robot-name (robot:find-robot "ARS-MAGNA.TESTS:::ODD"))))
  (is (eq 'ada (robot:robot-name (robot:find-robot "ARS-MAGNA.TESTS:ADA"))))
  (with-temporary-file (file)
    (run:with-simulation ((ada |:ODD|) :clean t)
      (run:run-ticks 3)
      (run:save-simulation file)
      (is (equal '(ada |:ODD|)
                 (mapcar #'robot:robot-name
                         (run:simulation-robots (run:load-simulation file)))))))
  (with-temporary-file (file)
    (run:with-simulation ((ada |:ODD|) :clean t :journal t)
      (command:robot-turn (robot:find-robot '|:ODD|) 1)
      (run:run-ticks 5)
      (run:save-journal file)
      (is (= (run:state-digest) (nth-value 1 (run:replay (run:load-journal file))))))))

;;; Projections beside a plan that never waits.

(test project.beside-a-plan-that-never-waits-tells-of-its-own-plan
  (let ((rpl:*runaway-limit* 2000))
    (with-three (:seed 1)
      (driver:begin-plan (rpl:interp-lambda () (loop (random 5))) :robot ben)
      (flet ((reasons (plan)
               (ars-magna.rpl-projecting:projection-failures
                (ars-magna.rpl-projecting:project-plan plan :trials 2 :horizon 60))))
        (is (equal '() (reasons '(drive-metres 2 :robot ada))))
        (driver:end-plan :all)
        (is (equal '((:runaway . 2))
                   (reasons (list (rpl:interp-lambda () (loop (random 5))) :robot 'ada))))))))
