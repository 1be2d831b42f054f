;;;; beginners-words.lisp -- what beginners write for something else: tests, waits, keywords, lines.

(in-package :ars-magna.tests)

(in-suite beginners)

;;; Keywords and tests.

(test simulator.refuses-keywords-that-it-does-not-know
  (is-true (complains-p '(run:simulator 'rover :sead 3 :display nil)
                        "simulator: there is no keyword :sead; did you mean :seed?"))
  (is-true (complains-p '(run:simulator 'rover :rat 3) "did you mean :rate?")))

(test tests.that-are-functions-or-quoted-are-warned-of
  (dolist (form '('(> 1 2) (lambda () nil) #'(lambda () nil) #'car))
    (is-true (has-words-p (warning-about `(lambda () (time:schedule (:r :when ,form) (print 1))))
                          "schedule, :when:" "which always counts as true"))
    (is-true (has-words-p (warnings-of-procedure 'robot `(rpl:wait-until ,form))
                          "wait-until:" "which always counts as true. Write the form alone")))
  (is-true (has-words-p (warning-about '(world:defkicker idly (thing) (:test (lambda () (list thing)))))
                        "defkicker idly, :test:" "(list thing)"))
  (dolist (form '((list 1) t nil (funcall #'list) robot))
    (is (string= "" (warnings-of-procedure 'robot `(rpl:wait-until ,form))))
    (is (string= "" (warning-about `(lambda (robot)
                                      (time:schedule (robot :when ,form) (print 1))))))))

;;; Plans.

(test wait-until.warns-of-numbers
  (is-true (has-words-p (warnings-of-procedure 'robot '(rpl:wait-until 5)) "(wait-time 5)")))

(test plans.warn-of-what-lets-time-pass-for-programs
  (flet ((told (form) (warnings-of-procedure 'robot form)))
    (is-true (has-words-p (told '(sleep 3)) "stops all plans" "(wait-time 3)"))
    (is-true (has-words-p (told '(when robot (run:run-ticks 5))) "for programs" "(wait-time 5)"))
    (is-true (has-words-p (told '(run:run-until (lambda () t))) "(wait-until condition)"))
    (dolist (form '((mapc (lambda (x) (sleep x)) robot) '(sleep 3)))
      (is (string= "" (told form))))))

(test plans.warn-of-values-in-the-place-of-fluents
  (flet ((told (form) (warnings-of-procedure 'robot form)))
    (is-true (has-words-p (told '(setq driver:robot-stopped* nil))
                          "puts nil in the place of the fluent" "set-value "))
    (is-true (has-words-p (told '(setf driver:robot-stopped* (not t))) "set-value "))
    (dolist (form '((setq robot nil) (setq driver:robot-stopped* (rpl:create-fluent nil))
                    (setf (rpl:fluent-value driver:robot-stopped*) nil)))
      (is (string= "" (told form))))))

(test policies.that-wait-for-nothing-are-warned-of
  (flet ((told (policy)
           (warnings-of-procedure 'robot `(rpl:with-policy ,policy (rpl:wait-time 3)))))
    (is-true (has-words-p (told '(print robot)) "waits for nothing" "(whenever test form...)"))
    (is-true (has-words-p (told '(when (listp robot) (rpl:fail)))
                          "wait-until (listp robot)"))
    (dolist (policy '((rpl:whenever driver:robot-stopped* (print 1))
                      (rpl:seq (rpl:wait-for driver:robot-stopped*) (rpl:fail))
                      (when robot (rpl:wait-for driver:robot-stopped*) (rpl:fail))
                      (loop (rpl:wait-time 1))))
      (is (string= "" (told policy))))))
