;;;; rpl-telling.lisp -- what plans print of circular, endless and unprintable data.

(in-package :ars-magna.tests)
(in-suite rpl)

(defstruct speechless)

(defmethod print-object ((object speechless) stream)
  (declare (ignore stream))
  (error "This cannot be printed."))

(defun list-without-end ()
  "Return a list without an end."
  (let ((list (list 1 2 3)))
    (setf (cdddr list) list)))

(defun told-of (plan)
  "Run PLAN. Return its value as PRIN1 and as PRINC write it, all messages, and how it ended."
  (let ((base:*message-queue* (base:make-message-queue)))
    (multiple-value-bind (value state) (rpl:run-plan-alone plan)
      (values (list (prin1-to-string value)
                    (princ-to-string value)
                    (with-output-to-string (out) (base:error-display out)))
              state))))

(defun tells-p (words plan)
  "True if PLAN fails, and each of what it tells has WORDS and is no book."
  (multiple-value-bind (texts state) (told-of plan)
    (and (eq :failed state)
         (every (lambda (text) (and (search words text) (< (length text) 6000))) texts))))

(test telling.an-error-about-a-list-without-end
  (is-true (tells-p "no place for #1=(1 2 3 . #1#)"
                    (rpl:interp-lambda () (error "no place for ~A" (list-without-end)))))
  (is-true (tells-p "1 2 3" (rpl:interp-lambda () (rpl:fail :class :full :of (list-without-end)))))
  (is-true (tells-p "xxx" (rpl:interp-lambda ()
                            (error "no ~A" (make-string 100000 :initial-element #\x))))))

(test telling.what-cannot-be-printed
  (is-true (tells-p "an object that cannot be printed"
                    (rpl:interp-lambda () (rpl:fail :class :full :of (make-speechless)))))
  (is-true (tells-p "whose report fails"
                    (rpl:interp-lambda () (error "no ~A" (make-speechless)))))
  (multiple-value-bind (texts state)
      (told-of (rpl:interp-lambda () (rpl:wait-for (fluent* (make-speechless)))))
    (is (eq :deadlock state))
    (is-true (search "waits for an object that cannot be printed" (third texts))))
  (is (stringp (prin1-to-string (rpl:make-valve (make-speechless))))))

(defun fluent* (name &optional value) (rpl:create-fluent name value))

(test telling.a-fluent-whose-value-has-itself-in-it
  (let ((a (fluent* 'loop)) (b (fluent* 'back)))
    (rpl:set-value a (list a))
    (is (string= "#<fluent loop = (#<fluent loop>)>" (prin1-to-string a)))
    (rpl:set-value a b)
    (rpl:set-value b a)
    (is (string= "#<fluent loop = #<fluent back>>" (prin1-to-string a)))
    (is-true (tells-p "loop" (rpl:interp-lambda () (rpl:wait-for (> a 2)))))
    (rpl:set-value a (list-without-end))
    (is (< (length (prin1-to-string a)) 1000))))

(test telling.a-network-that-is-large
  (let ((network (fluent* 'base 1)))
    (loop repeat 50 do (setf network (rpl:fl-funcall 'list network network)))
    (is (< (length (fluents::fluent-text network)) 2000))))

;;; Too much of all.

(rpl:def-interp-proc splitting ()
  (rpl:par (splitting) (splitting)))

(test limit.plans-that-split-without-end-fail
  (let ((rpl:*plan-task-limit* 5000))
    (with-runner (runner)
      (let ((task (rpl:start-plan runner 'splitting)))
        (rpl:react-to-all runner)
        (is (eq :failed (rpl:task-state task)))
        (is (eq :too-many-tasks (rpl:failure-class (rpl:task-result task))))
        (is (null (rpl:plan-runner-tasks runner)))
        (is (= 0 (tasks::runner-alive runner))))
      (is (eq :saved (rpl:run-plan-alone
                      (rpl:interp-lambda ()
                        (rpl:handle-failure ((:too-many-tasks () (return :saved)))
                          (splitting)))
                      :runner runner))))))

(test limit.a-plan-that-starts-itself-lets-time-pass
  (with-runner (runner)
    (let ((plan nil) (started 0))
      (setf plan (rpl:interp-lambda ()
                   (incf started)
                   (rpl:start-plan runner plan)))
      (rpl:start-plan runner plan)
      (is (eq :budget (rpl:react-to-all runner)))
      (is (<= 100 started (/ tasks::*runaway-limit* 100))))))
