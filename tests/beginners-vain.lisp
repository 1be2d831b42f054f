;;;; beginners-vain.lisp -- policies, handlers, commands and fluents that do nothing as written.

(in-package :ars-magna.tests)

(in-suite beginners)

;;; Fluents.

(defvar *herd* (rpl:create-fluent 'herd 1))

(test set-value.refuses-networks-of-the-fluent-itself
  (dolist (form '((rpl:set-value *herd* (+ *herd* 1))
                  (rpl:pulse *herd* (not (> *herd* 3)))
                  (setf (rpl:fluent-value *herd*) (* 2 *herd*))))
    (let ((failure (driver-failure form)))
      (is-true (has-words-p failure "not a network of herd itself" "(fluent-value ...)")
               "~A" failure)))
  (is (= 2 (rpl:run-plan-alone (plan-of (rpl:set-value *herd*
                                                       (+ 1 (rpl:fluent-value *herd*)))))))
  (let ((other (rpl:create-fluent 'other)))
    (is (rpl:fluent-p (rpl:run-plan-alone (plan-of (rpl:set-value other (+ *herd* 1))))))))

(defun driver-failure (form)
  "Return the text of the failure of a plan that does FORM."
  (princ-to-string (rpl:run-plan-alone (rpl:make-plan form))))

;;; Policies.

(defun warnings-of-policy (policy &rest body)
  (warnings-of-procedure 'robot `(block nil (rpl:with-policy ,policy ,@body))))

(test policies.that-test-once-and-fail-are-warned-of
  (flet ((told (policy) (warnings-of-policy policy '(rpl:wait-time 3))))
    (is-true (has-words-p (told '(when driver:robot-movement-error* (print 1)
                                   (rpl:fail :class :hit)))
                          "waits for nothing" "wait-until" "robot-movement-error*) (print 1)"))
    (dolist (policy '((if robot (rpl:fail) nil)
                      (unless robot (rpl:fail))
                      (cond ((null robot) (rpl:fail)) (t (rpl:fail :class :hit)))))
      (is-true (has-words-p (told policy) "waits for nothing" "(whenever test form...)")))
    (dolist (policy '((if robot (rpl:fail) (rpl:seq (rpl:wait-for robot) (rpl:fail)))
                      (cond (robot (rpl:fail)) (t (turn-once)))
                      (when robot (a-plan-defined-later) (rpl:fail))))
      (is (not (search "waits for nothing" (told policy)))))))

(test policies.that-only-wait-are-warned-of
  (flet ((told (policy) (warnings-of-policy policy '(rpl:wait-time 3))))
    (dolist (policy '((rpl:wait-for driver:robot-stopped*) (rpl:wait-until (< robot 3))))
      (is-true (has-words-p (told policy) "does nothing after its wait" "seq (")))
    (dolist (policy '((rpl:wait-time 9)
                      (rpl:seq (rpl:wait-for driver:robot-stopped*) (rpl:fail))
                      (rpl:wait-until (rpl:seq (rpl:wait-time 1) (turn-once)))))
      (is (string= "" (told policy))))))

(test policies.whose-value-is-lost-are-warned-of
  (flet ((told (policy) (warnings-of-policy policy '(rpl:wait-time 3) ':drove)))
    (is-true (has-words-p (told '(rpl:whenever driver:robot-movement-error* (return :saw)))
                          "(return :saw) ends only the policy" "its value is lost" "(pursue (seq "))
    (dolist (policy '((rpl:whenever driver:robot-movement-error* (return))
                      (rpl:whenever driver:robot-movement-error* (return t))
                      (rpl:whenever driver:robot-movement-error* (when robot (return nil)))
                      (rpl:whenever driver:robot-movement-error*
                       (print (loop (rpl:wait-time 1) (return :saw))))))
      (is (string= "" (told policy))))))

(test policies.in-the-place-of-the-body-are-warned-of
  (let ((watch '(rpl:whenever driver:robot-movement-error* (rpl:fail :class :hit)))
        (react '(rpl:whenever driver:robot-movement-error* (print 1)))
        (leave '(rpl:whenever driver:robot-movement-error* (return 1)))
        (steps '(rpl:seq (driver:rpl-robot-turn 1) (rpl:wait-for driver:robot-stopped*)))
        (fail '((rpl:wait-for driver:robot-movement-error*) (rpl:fail :class :hit))))
    (loop for (policy . body) in `((,steps ,watch) ((turn-once) ,watch) (,steps ,react))
          do (is-true (has-words-p (warnings-of-policy policy (first body))
                                   "never ends" "Write the policy before the body"
                                   "(with-policy (whenever ...) form...)")))
    (dolist (body `(,fail ((rpl:seq ,@fail))))
      (is-true (has-words-p (apply #'warnings-of-policy steps body)
                            "waits, and then fails" "Write the policy before the body"
                            "(with-policy (seq (wait-for ...) (fail ...)) form...)")))
    (loop for (policy . body) in `((,watch ,steps) (,watch ,react) (,steps ,leave)
                                   ((turn-once) ,react)
                                   (,steps (print 1) ,watch)
                                   (,steps (print 1) ,@fail)
                                   (,watch ,@fail)
                                   ((rpl:seq (rpl:wait-for robot) (rpl:fail)) ,react)
                                   ((rpl:seq (rpl:wait-for robot) (return)) ,react))
          do (is (not (search "Write the policy" (apply #'warnings-of-policy policy body)))))))

;;; Handlers for conditions that are not failures.

(test handlers.want-their-clauses-in-a-list
  (is-true (complains-p '(rpl:def-interp-proc careful-one ()
                           (rpl:handle-failure (:stuck () (return :gave-up)) (rpl:fail :stuck)))
                        "a list of clauses" "write ((:stuck nil (return :gave-up)))")))

(test failures.are-named-in-errors-about-them
  (let ((text (rover-writes ()
                (driver:run-plan (plan-of (rpl:handle-failure ((:lost (f) (return (car f))))
                                            (rpl:fail :class :lost)))))))
    (is-true (has-words-p text "The value #<Plan failure :LOST at tick 0 in" "is not a list"))))

(test waits.for-a-status-are-warned-of
  (flet ((told (wait)
           (warnings-of-procedure 'robot `(rpl:par (:tag w (rpl:wait-time 3)) ,wait))))
    (is-true (has-words-p (told '(rpl:wait-for (rpl:task-status w)))
                          "always true" "Compare it: (wait-for (eq ("))
    (is (string= "" (told '(rpl:wait-for (eq (rpl:task-status w) :succeeded)))))))

(test plans.cannot-wait-for-themselves
  (is-true (has-words-p (warnings-of-procedure '(list robot) '(run:await-idle))
                        "await-idle is for programs" "(wait-for fluent)"))
  (live (simulation)
    (let ((failure (driver:run-plan (plan-of (funcall 'run:await-idle)))))
      (is-true (has-words-p (princ-to-string failure) "a plan would wait for itself")))))

(test handlers.of-codes-of-commands-are-warned-of
  (flet ((told (clauses &rest body)
           (warnings-of-procedure 'robot `(rpl:handle-failure ,clauses ,@body))))
    (let ((go '(driver:rpl-robot-go-forward 9)) (wait '(rpl:wait-for driver:robot-stopped*))
          (blocked '((:robot-blocked () (return 1)))))
      (is-true (has-words-p (told blocked go wait)
                            "rpl-robot-go-forward does not fail with class :robot-blocked"
                            "(if (fluent-value robot-movement-error*) ...)" "(fail :class "))
      (is-true (has-words-p (told '(((or :lost :grasp-lost) () (return 1)))
                                  '(driver:rpl-hand-track 0) wait '(when robot (rpl:fail :lost)))
                            "(fluent-value (vref hand-error* hand))"))
      (dolist (body `((,go ,wait (rpl:fail :class :robot-blocked))
                      (,go ,wait (rpl:fail (rpl:fluent-value driver:robot-movement-error*)))
                      (,go ,wait (turn-once))
                      (,go ,wait (a-plan-defined-later))
                      (,go ,wait (mapc (lambda (each) (rpl:fail each)) robot))
                      (,go ,wait (if robot (rpl:fail :robot-blocked)))
                      ((driver:rpl-robot-turn 1) ,wait)
                      (,wait)))
        (is (not (search "does not fail" (apply #'told blocked body))) "~S" body))
      (is (string= "" (told '((t () (return 1))) go wait))))))

;;; Commands that are cut off.

(test plans.that-wait-for-a-tick-between-commands-are-told-so-once
  (flet ((told (plan) (rover-writes () (driver:run-plan plan) (driver:run-plan plan))))
    (let ((text (told (plan-of (driver:rpl-robot-turn 1)
                               (rpl:wait-time 1)
                               (driver:rpl-robot-go-forward 1)
                               (rpl:wait-for driver:robot-stopped*)))))
      (is (= 1 (length (lines-of text))) "~A" text)
      (is-true (has-words-p text "rpl-robot-turn of the plan" "was cut off after a tick"
                            "(wait-for robot-stopped*)")))
    (dolist (plan (list (plan-of (driver:rpl-robot-turn 1) (rpl:wait-time 2)
                          (driver:rpl-robot-go-forward 1) (rpl:wait-for driver:robot-stopped*))
                        (plan-of (driver:rpl-robot-turn 1) (rpl:wait-time 1)
                          (driver:rpl-robot-stop) (rpl:wait-for driver:robot-stopped*))
                        (plan-of (driver:rpl-robot-turn 1/100) (rpl:wait-time 3)
                          (driver:rpl-robot-go-forward 1) (rpl:wait-for driver:robot-stopped*))
                        (plan-of (driver:rpl-robot-turn 1) (rpl:wait-time 1)
                          (when (rpl:fluent-value driver:robot-place*) (rpl:fail))
                          (driver:rpl-robot-go-forward 1) (rpl:wait-for driver:robot-stopped*))
                        (plan-of (driver:rpl-robot-turn 1)
                          (rpl:wait-for driver:robot-stopped* :timeout 1)
                          (driver:rpl-robot-go-forward 1) (rpl:wait-for driver:robot-stopped*))
                        (plan-of (block nil
                                   (loop (driver:rpl-robot-turn 1)
                                         (rpl:wait-time 1)
                                         (driver:rpl-robot-go-forward 1)
                                         (rpl:wait-for driver:robot-stopped*)
                                         (return))))))
      (is (string= "" (told plan))))))

(test commands.after-the-last-tick-are-told-of
  (is-true (has-words-p (rover-writes ()
                          (run:run-ticks 5)
                          (command:robot-turn rover 1 nil)
                          (command:camera-turn (robot:robot-camera rover 0) 1 nil))
                        "robot-turn, camera-turn did nothing" "another tick" "(run-ticks N)"))
  (is (string= "" (rover-writes () (run:run-ticks 5) (command:robot-stop rover nil))))
  (is (string= "" (rover-writes (:errors :collect)
                    (run:run-ticks 5)
                    (command:robot-turn rover 1 nil))))
  (let ((done nil))
    (is (string= "" (rover-writes ()
                      (command:robot-turn rover 1/10 (lambda (&rest told)
                                                       (declare (ignore told))
                                                       (setf done t)
                                                       (command:robot-turn rover 1 nil)))
                      (run:run-until (lambda () done)))))
    (is-true done)))

(test commands.that-interrupt-themselves-are-told-of-once
  (let ((text (rover-writes ()
                (dotimes (i 4) (command:robot-turn rover 1 nil) (run:run-ticks 3)))))
    (is (= 1 (length (lines-of text))) "~A" text)
    (is-true (has-words-p text "robot-turn was issued again after 3 ticks"
                          "(run-ticks N)" "(continuation (err robot angle) ...)")))
  (is (string= "" (rover-writes ()
                    (dotimes (i 4) (command:robot-turn rover (/ i 2) nil) (run:run-ticks 3))
                    (dotimes (i 4) (command:robot-turn rover 1 (constantly nil)) (run:run-ticks 3))
                    (dotimes (i 4) (command:robot-turn rover 1/10 nil) (run:run-ticks 30))))))

;;; Commands without effect.

(defmacro told-of-ends (&body body)
  "Return what a run of a plan with BODY writes to the error output."
  `(rover-writes () (driver:run-plan (plan-of ,@body))))

(defun movement-error () (rpl:fluent-value driver:robot-movement-error*))

(test plans.that-do-not-look-at-how-a-command-ended-are-told-so-once
  (let ((text (rover-writes ()
                (dotimes (i 2)
                  (driver:run-plan (plan-of (driver:rpl-robot-goto-designator 0)
                                     (rpl:wait-for driver:robot-stopped*)
                                     :there))))))
    (is (= 1 (length (lines-of text))) "~A" text)
    (is-true (has-words-p text "rpl-robot-goto-designator ended with :not-tracking"
                          "did not look at robot-movement-error*" "(if (fluent-value ")))
  (is-true (has-words-p (told-of-ends (dotimes (i 2)
                                        (driver:rpl-hand-insert-bin 0 0)
                                        (rpl:wait-for (svref driver:hand-moved* 0))))
                        "rpl-hand-insert-bin ended with :different-location"
                        "(fluent-value (vref hand-error* 0))"))
  (is-true (has-words-p (told-of-ends (driver:rpl-camera-get-object-designator
                                       0 :non-local '((:color violet)))
                                      (rpl:wait-for (svref driver:camera-input* 0)))
                        "ended with :designator-not-found"))
  (is-true (has-words-p (told-of-ends (driver:rpl-robot-go-distance 1000)
                                      (rpl:wait-for driver:robot-stopped*))
                        "rpl-robot-go-distance ended with :robot-blocked")))

(test plans.that-do-not-look-are-told-so-at-once-in-live-runs
  (live (simulation)
    (driver:run-plan (plan-of (driver:rpl-robot-goto-designator 0)
                              (rpl:wait-for driver:robot-stopped*)))
    (let ((warning (find :warning (base:take-messages) :key #'base:message-kind)))
      (is (eq t (definitions::message-notable-p warning)))
      (is-true (has-words-p (base:message-text warning) "ended with :not-tracking")))))

(test plans.that-look-at-how-a-command-ended-are-not-told
  (macrolet ((quiet (&body body)
               `(is (string= "" (told-of-ends (driver:rpl-robot-goto-designator 0) ,@body)))))
    (quiet (rpl:wait-for driver:robot-stopped*) (rpl:fluent-value driver:robot-movement-error*))
    (quiet (rpl:wait-for driver:robot-stopped*) (movement-error))
    (quiet (rpl:wait-for driver:robot-stopped*) (rpl:fluent-value driver:robot-arrived-at*))
    (quiet (rpl:wait-for driver:robot-stopped*) (when driver:robot-movement-error* 1))
    (quiet (rpl:wait-for (or driver:robot-arrived-at* driver:robot-movement-error*)))
    (quiet (rpl:par (rpl:wait-for driver:robot-movement-error*)
                    (rpl:wait-for driver:robot-stopped*)))
    (quiet (rpl:wait-for driver:robot-stopped*)
           (rpl:pursue (rpl:whenever driver:robot-movement-error* (print 1)) (rpl:wait-time 1))))
  (is (string= "" (told-of-ends (driver:rpl-robot-go-forward 99)
                    (rpl:wait-for driver:robot-stopped*)))
      "being blocked")
  (is (string= "" (told-of-ends (driver:rpl-camera-untrack 0) (rpl:wait-time 2)))
      "what was so already")
  (is (string= "" (rover-writes ()
                    (driver:run-plan (plan-of (driver:rpl-robot-goto-designator 0)
                                       (rpl:wait-for driver:robot-stopped*)))
                    (movement-error)))
      "the program looks"))

(test plans.that-try-again-until-it-works-are-not-told
  (is (string= "" (told-of-ends (driver:rpl-robot-set-speed 99) (rpl:wait-time 2)
                    (driver:rpl-robot-set-speed 1/2) (rpl:wait-time 2))))
  (is-true (has-words-p (told-of-ends (driver:rpl-robot-set-speed 1/2) (rpl:wait-time 2)
                          (driver:rpl-robot-set-speed 99) (rpl:wait-time 2))
                        "rpl-robot-set-speed ended with :too-high-speed")))
