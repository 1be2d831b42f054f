;;;; rpl-replacing.lisp -- code of a plan replaced by path, for its next start.

(in-package :ars-magna.tests)
(in-suite rpl)

(rpl:def-interp-proc stepwise (n)
  (let ((sum 0))
    (macrolet ((twice (x) `(* 2 ,x)))
      (flet ((thrice (x) (* 3 x)))
        (rpl:n-times n
          (:tag outer
            (rpl:wait-time 1)
            (:tag inner (incf sum (twice 1)))
            (:tag beside (incf sum (thrice 0)))))))
    sum))

(defmacro with-stepwise (&body body)
  "Run BODY, and let STEPWISE then be as it is written."
  `(unwind-protect (progn ,@body)
     (dolist (tag '(outer inner))
       (rpl:restore-task-code (list 'stepwise tag)))))

(test replace-task-code.counts-from-the-next-start
  (with-stepwise
    (is (= 6 (plan-value (stepwise 3))))
    (is (equal '((incf sum (twice 1)) nil)
               (multiple-value-list (rpl:task-code '(stepwise inner)))))
    (is (equal '(incf sum 10) (rpl:replace-task-code '(stepwise inner) '(incf sum 10))))
    (is (= 30 (plan-value (stepwise 3))))
    (is (equal '((incf sum 10) t) (multiple-value-list (rpl:task-code '(stepwise outer inner)))))
    (is (equal '(incf sum (twice 1)) (rpl:restore-task-code '(stepwise inner))))
    (is (= 6 (plan-value (stepwise 3))))))

(test replace-task-code.what-runs-goes-on-as-it-is
  (with-stepwise
    (is (= (+ 2 (* 7 2))
           (plan-value
             (rpl:par (rpl:seq (rpl:wait-time 1)
                               (rpl:replace-task-code '(stepwise outer)
                                                      '(seq (rpl:wait-time 2) (incf sum 7))))
                      (stepwise 3)))))))

(test replace-task-code.sees-what-is-visible-there
  (dolist (compile '(nil t))
    (with-stepwise
      (rpl:replace-task-code '(stepwise inner)
                             '(let ((more (thrice (twice n))))
                               (rpl:wait-time 1)
                               (setf sum (+ sum more)))
                             :compile compile)
      (is (= 54 (plan-value (stepwise 3)))))))

(test replace-task-code.the-new-code-is-plan-text
  (with-stepwise
    (rpl:replace-task-code '(stepwise inner) '(rpl:par (incf sum) (rpl:fail :class :of-new-code)))
    (is (eq :of-new-code (rpl:failure-class (plan-failure-of (stepwise 1)))))
    (signals base:ars-magna-error
      (rpl:replace-task-code '(stepwise inner) '(mapcar (lambda (x) (rpl:wait-time x)) '(1))))))

(test replace-task-code.in-local-plans-branches-and-handlers
  (base:with-own-definitions ()
    (eval '(rpl:def-interp-proc places ()
            (flet ((away () (:tag local (rpl:wait-time 1) (rpl:fail))))
              (rpl:par (:tag branch :old)
                       (rpl:handle-failure ((t () (:tag handler :old) (return :old)))
                         (away))))))
    (dolist (tag '(local branch handler))
      (rpl:replace-task-code (list 'places tag) (list 'tell (list 'quote tag)))
      (is (equal (list tag) (mapcar #'first (tale (plan-value (rpl:call-plan 'places))))))
      (rpl:restore-task-code (list 'places tag)))))

(test replace-task-code.is-forgotten-by-a-new-definition
  (base:with-own-definitions ()
    (eval '(rpl:def-interp-proc fickle () (:tag step :first)))
    (rpl:replace-task-code '(fickle step) :second)
    (is (eq :second (plan-value (rpl:call-plan 'fickle))))
    (eval '(rpl:def-interp-proc fickle () (:tag step :third)))
    (is (eq :third (plan-value (rpl:call-plan 'fickle))))))

(test replace-task-code.paths-that-lead-nowhere
  (signals base:misuse (rpl:task-code '(stepwise innermost)))
  (signals base:misuse (rpl:task-code '(stepwise inner outer)))
  (signals base:unknown-name (rpl:task-code '(no-such-plan inner)))
  (dolist (path '((stepwise) stepwise () (stepwise "inner") (stepwise . inner)))
    (signals base:wrong-argument (rpl:task-code path)))
  (base:with-own-definitions ()
    (eval '(rpl:def-interp-proc both () (:tag a (:tag c 1)) (:tag b (:tag c 2))))
    (signals base:misuse (rpl:task-code '(both c)))
    (is (eql 2 (rpl:task-code '(both b c))))))
