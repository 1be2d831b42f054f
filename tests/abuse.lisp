;;;; abuse.lisp -- wrong input by users and files neither breaks the simulator nor runs as code.

(in-package :ars-magna.tests)

(def-suite* abuse :in ars-magna)

;;; Each run tries the same few dozens of each kind; tests/benchmarks/abuse.lisp tries any number.

(test abuse.begins-with-what-makes-sense
  "Else nothing would be learnt from its damage."
  (dolist (abuse *abuses*)
    (dolist (sample (abuse-samples abuse))
      (multiple-value-bind (outcome text) (call-isolated (lambda () (try-example abuse sample)))
        (is (member outcome '(:fine :warned)) "~A ~S: ~A" (abuse-name abuse) outcome text)))))

(test abuse.is-borne
  "Nothing is executed that is data, nothing crashes, and each error is one of ours."
  (dolist (abuse *abuses*)
    (let ((table (abuse-table abuse 40)))
      (is (null (bad-rows table)) "~(~A~): ~A" (abuse-name abuse) (rows-text (bad-rows table)))
      (is (find :fine table :key #'first :test-not #'eq) "~A does no damage" (abuse-name abuse)))))

(test abuse.is-the-same-again
  (dolist (abuse *abuses*)
    (let ((*print-circle* t))
      (is (string= (prin1-to-string (example-of abuse 3))
                   (prin1-to-string (example-of abuse 3)))))))
