;;;; rpl-named-policies.lisp -- named policies, counters, waiting for other values than fluents.

(in-package :ars-magna.tests)
(in-suite rpl)

;;; Notes that the policies below make.

(defvar *told* '() "What clauses of policies have told, last first.")

(defun tell (item) (push (list item (rpl:plan-time)) *told*) item)

(defmacro tale (&body body)
  "Run BODY, and return what was told, in order."
  `(let ((*told* '()))
     ,@body
     (reverse *told*)))

(rpl:define-policy told-policy (fluent &key (ready t))
  "Tells of each clause."
  (:init (tell :init) (rpl:wait-time 1) ready)
  (:check (ars-magna.rpl.lifted:> fluent 3))
  (:recover (tell :recover) (rpl:wait-time 2))
  (:clean-up (rpl:wait-time 1) (tell :clean-up)))

(test define-policy.is-found-by-name-and-is-a-variable
  (is (eq told-policy (rpl:find-policy 'told-policy)))
  (is (eq told-policy (rpl:find-policy "TOLD-POLICY")))
  (is (member told-policy (rpl:all-policies)))
  (is (equal '(fluent &key (ready t)) (rpl:policy-lambda-list told-policy)))
  (is (string= "Tells of each clause." (documentation 'told-policy 'variable)))
  (signals base:unknown-name (rpl:find-policy 'no-such-policy)))

(test with-named-policy.a-policy-that-holds
  (let ((f (fluent 1)))
    (is (equal '((:init 0) (:body 1) (:clean-up 4))
               (tale (is (eq :value (plan-value
                                      (rpl:with-named-policy 'told-policy (f)
                                        (tell :body)
                                        (rpl:wait-time 2)
                                        :value)))))))))

(test with-named-policy.one-that-does-not-evaporates-the-body-first
  (let ((f (fluent 1)) (failure nil))
    (is (equal '((:init 0) (:body 1) (:evaporating 3) (:recover 4) (:clean-up 7))
               (tale (setf failure
                           (plan-failure-of
                             (rpl:with-named-policy told-policy (f)
                               (tell :body)
                               (rpl:evap-protect
                                   (rpl:seq (rpl:wait-time 2)
                                            (rpl:set-value f 4)
                                            (tell :not-reached))
                                 (rpl:seq (tell :evaporating) (rpl:wait-time 1)))))))))
    (is (typep failure 'rpl:policy-check-condition-met))
    (is (eq told-policy (rpl:failed-policy failure)))
    (is (search "TOLD-POLICY" (string-upcase (princ-to-string failure))))
    (is (null (fluents::fluent-first-link f)))))

(test with-named-policy.that-cannot-begin-does-nothing-else
  (let ((f (fluent 1)) (failure nil))
    (is (equal '((:init 0))
               (tale (setf failure (plan-failure-of
                                     (rpl:with-named-policy 'told-policy (f :ready nil)
                                       (tell :body)))))))
    (is (typep failure 'rpl:policy-init-failed))))

(test with-named-policy.met-from-the-start-keeps-the-body-from-starting
  (let ((f (fluent 9)))
    (is (equal '((:init 0) (:recover 1) (:clean-up 4))
               (tale (plan-failure-of (rpl:with-named-policy 'told-policy (f) (tell :body))))))))

(test with-named-policy.cleans-up-after-failure-return-and-evaporation
  (let ((f (fluent 1)))
    (is (equal '((:init 0) (:clean-up 2))
               (tale (is (eq :of-body
                             (rpl:failure-class
                              (plan-failure-of (rpl:with-named-policy 'told-policy (f)
                                                 (rpl:fail :class :of-body)))))))))
    (is (equal '((:init 0) (:clean-up 2))
               (tale (is (eq :left (plan-value
                                     (block out
                                       (rpl:with-named-policy 'told-policy (f)
                                         (return-from out :left)))))))))
    (is (equal '((:init 0) (:clean-up 6))
               (tale (plan-value (rpl:pursue (rpl:with-named-policy 'told-policy (f)
                                               (rpl:wait-time 100))
                                             (rpl:wait-time 5))))))))

(test with-named-policy.a-return-in-its-body-is-the-body's-own
  (is (eq :mine (plan-value (dolist (x '(1 2))
                              (rpl:with-named-policy (rpl:make-policy ()) ()
                                (rpl:wait-time 1)
                                (return :mine)))))))

(test with-named-policy.wrong-arguments-fail
  (is (typep (plan-failure-of (rpl:with-named-policy 'told-policy () (rpl:wait-time 1)))
             'rpl:lisp-failure)))

(test make-policy.what-is-no-fluent-is-tested-at-each-tick
  (let* ((level 5)
         (policy (rpl:make-policy (least) (:check (< level least)))))
    (is (typep (plan-failure-of
                 (rpl:with-named-policy policy (3)
                   (loop (rpl:wait-time 1) (decf level))))
               'rpl:policy-check-condition-met))
    (is (= 2 level))))

(test make-policy.a-check-may-wait-and-remember
  "Three looks, one a tick; what is remembered is fresh for each use."
  (let ((policy (rpl:make-policy ()
                  (:init (rpl:policy-setf 'looks 0) t)
                  (:check (rpl:wait-time 4)
                          (= 3 (rpl:policy-setf 'looks (1+ (rpl:policy-get 'looks)))))
                  (:clean-up (tell (rpl:policy-get 'looks))))))
    (dotimes (i 2)
      (is (equal '((3 14))
                 (tale (plan-failure-of (rpl:with-named-policy policy ()
                                          (rpl:wait-time 100)))))))
    (is (equal '((2 11))
               (tale (plan-value (rpl:with-named-policy policy () (rpl:wait-time 11))))))))

(test with-policies.the-first-comes-first
  (let ((f (fluent 1)) (g (fluent 1)))
    (is (equal '((:init 0) (:init 1) (:body 2) (:recover 2) (:clean-up 5) (:clean-up 6))
               (tale (plan-failure-of
                       (rpl:with-policies ((told-policy (f)) ('told-policy (g)))
                         (tell :body)
                         (rpl:set-value g 7)
                         (tell :not-reached))))))
    (rpl:set-value g 1)
    (is (equal '((:init 0) (:init 1) (:body 2) (:clean-up 3) (:recover 3) (:clean-up 6))
               (tale (plan-failure-of
                       (rpl:with-named-policies ((told-policy (f)) ('told-policy (g)))
                         (tell :body)
                         (rpl:set-value f 7)
                         (tell :not-reached))))))))

(test define-policy.what-makes-no-sense-is-said-at-once
  (dolist (form '((rpl:define-policy bad () (:chek t))
                  (rpl:define-policy bad () (:check t) (:check nil))
                  (rpl:define-policy bad () check)
                  (rpl:define-policy :bad () (:check t))
                  (rpl:define-policy bad)
                  (rpl:make-policy () (:initially t))))
    (signals base:malformed-definition (macroexpand-1 form)))
  (signals base:malformed-definition (macroexpand-1 '(rpl:policy-get 'x)))
  (dolist (form '((rpl:with-policies (told-policy) 1)
                  (rpl:with-policies 5 1)
                  (rpl:with-named-policy)))
    (signals base:malformed-definition (rpl:make-plan form))))

(defun define-quietly (form)
  "Evaluate FORM, which defines anew what this file defines."
  (handler-bind ((base:definition-warning #'muffle-warning))
    (eval form)))

(test define-policy.anew-and-undefined
  (base:with-own-definitions ()
    (let ((old (rpl:find-policy 'told-policy)))
      (define-quietly '(rpl:define-policy told-policy () (:check t)))
      (is (not (eq old (rpl:find-policy 'told-policy))))
      (is (typep (plan-failure-of (rpl:with-named-policy 'told-policy () 1))
                 'rpl:policy-check-condition-met))
      (base:undefine 'policy 'told-policy)
      (signals base:unknown-name (rpl:find-policy 'told-policy))))
  (is (equal '(fluent &key (ready t)) (rpl:policy-lambda-list (rpl:find-policy 'told-policy)))))

;;; Waiting for what is no fluent.

(test wait-until.fluents-wake-and-others-are-looked-at
  (let ((f (fluent)) (x 0))
    (is (equal '((:value 3) (t 7))
               (with-log (note)
                 (plan-value
                   (rpl:par (note (rpl:wait-until f))
                            (note (rpl:wait-until (= x 6))) ; looks first, at each tick
                            (rpl:seq (rpl:wait-time 3) (rpl:set-value f :value))
                            (rpl:n-times 6 (rpl:wait-time 1) (incf x)))))))
    (is (eq :now (plan-value (rpl:wait-until :now))))))

;;; Counters.

(test counters.are-read-and-set-back
  (is (equal '(2 1 0 2 1 2)
             (let ((seen '()))
               (plan-failure-of
                 (rpl:with-retry-counters ((tries 2) (rounds 1))
                   (rpl:handle-failure ((:hard () (rpl:do-retry rounds
                                                    (rpl:reset-counter tries)
                                                    (rpl:retry))))
                     (rpl:handle-failure ((:soft () (rpl:do-retry tries (rpl:retry))
                                                 (rpl:fail :class :hard)))
                       (rpl:wait-time 1)
                       (push (rpl:get-counter tries) seen)
                       (rpl:fail :class (if (= 2 (length (remove 1 (remove 0 seen))))
                                            (if (= 1 (first seen)) :over :soft)
                                            :soft))))))
               (append (reverse seen)
                       (list (rpl:with-retry-counters ((c 2)) (decf c) (rpl:reset-counter c))))))))

(test counters.are-variables-too
  (is (equal '(1 1 3) (plan-value (rpl:with-retry-counters ((c 3))
                                    (rpl:wait-time 1)
                                    (setf c 1)
                                    (list c (rpl:get-counter c) (rpl:reset-counter c)))))))

(test counters.must-be-there
  (signals base:malformed-definition (rpl:make-plan '(let ((c 1)) (rpl:get-counter c))))
  (signals base:malformed-definition (macroexpand-1 '(rpl:reset-counter c)))
  (signals base:malformed-definition (macroexpand-1 '(rpl:with-retry-counters (c) 1))))

;;; Calling with a list.

(test apply-plan.takes-a-list-and-passes-values-on
  (is (equal '(3 4) (plan-value (multiple-value-bind (a b)
                                    (rpl:apply-plan 'two-of (list 1 2))
                                  (list a b)))))
  (is (= 3 (plan-value (rpl:apply-plan (progn (rpl:wait-time 1) 'two-of)
                                       (list (two-of 1 2) 2))))))

(rpl:def-interp-proc two-of (a b)
  (rpl:wait-time 1)
  (values (max a 3) (* 2 b)))
