;;;; failing.lisp -- fail.

(in-package :ars-magna.rpl.constructs)

(define-expression failing
  "Fail as FAIL would with the list that ARGUMENTS of the environment returns."
  (:parts (arguments function))
  (:step
   (let ((failure (make-failure (funcall arguments environment))))
     (unwind task frame (failure-of failure task frame)))))

(defun check-fail (form)
  "Warn if the word that FORM, a FAIL, begins with may be a slip for :CLASS."
  (when (and (cddr form) (keywordp (second form)) (resembles-p (second form) :class))
    (doubt-form form "fail takes ~(~S~) for the class of the failure. Did you mean :class?"
                (second form))))

(defun check-class (form scope)
  "Warn if the class that FORM, a FAIL in SCOPE, gives is a name and no variable."
  (let ((class (and (eq :class (second form)) (third form))))
    (when (name-without-quote-p class scope)
      (doubt-own-form form "~(~A~) is no variable. The class of a failure is a keyword: (fail ~
                            :class :~:*~(~A~))." class))))

(define-plan-form "FAIL" :may (&rest arguments) (form scope)
  (check-fail form)
  (check-class form scope)
  (if (some (lambda (argument) (suspends-p argument scope)) arguments)
      (hoisted-code form scope)
      `(make-failing :form ',(form-as-written form)
                      :arguments ,(value-lambda `(list ,@arguments) scope))))
