;;;; forking-unforkable.lisp -- objects that cannot be copied, and users' own rules for theirs.

(in-package :ars-magna.tests)
(in-suite forking)

(defun outside-things ()
  "Return a list of things that no fork can have of its own."
  (list (make-broadcast-stream) *standard-output* (base:current-thread) (base:make-lock "lock")
        (base:make-semaphore "semaphore") (base:make-weak-reference (list 1))))

(test unforkable.is-named-with-where-it-was-found
  (run:with-simulation (rover :seed 1)
    (let ((log (make-broadcast-stream)))
      (driver:begin-plan (rpl:interp-lambda (record)
                           (rpl:par (rpl:wait-time 5)
                                    (let ((notes (list 1 (vector record))))
                                      (rpl:wait-time 5)
                                      notes)))
                         log)
      (run:run-ticks 1)
      (handler-case (progn (run:fork-simulation) (fail "forked"))
        (base:cannot-fork (condition)
          (is (eq log (base:cannot-fork-value condition)))
          (is (search "the variable record of the task 1" (base:cannot-fork-place condition))
              "~A" (base:cannot-fork-place condition))
          (is (search "COPY-PLAN-VALUE" (princ-to-string condition))))))))

(defun forked-with (restart value)
  "Return what a plan in a fork, made by choosing RESTART, has for a list of VALUE twice; NIL
if there is no fork. And how often somebody was asked."
  (let ((asked 0))
    (handler-bind ((base:cannot-fork (lambda (condition)
                                       (incf asked)
                                       (is (eq value (base:cannot-fork-value condition)))
                                       (invoke-restart (find-restart restart condition)))))
      (values (with-forked (copy (list value value)) copy) asked))))

(test unforkable.can-be-shared-or-left-out-or-there-is-no-fork
  (dolist (thing (outside-things))
    (flet ((check (restart expected)
             (multiple-value-bind (forked asked) (forked-with restart thing)
               (is (equal expected forked) "~A of ~A" restart thing)
               (is (= 1 asked)))))
      (check 'base:share-value (list thing thing))
      (check 'base:leave-out-value (list nil nil))
      (check 'base:make-no-fork nil))))

(test unforkable.several-are-asked-about-in-turn
  (let ((things (outside-things)) (asked '()))
    (handler-bind ((base:cannot-fork (lambda (condition)
                                       (push (base:cannot-fork-value condition) asked)
                                       (invoke-restart 'base:leave-out-value))))
      (with-forked (copy things)
        (is (equal '(nil nil nil nil nil nil) copy))))
    (is (null (set-exclusive-or asked things)))))

(test unforkable.that-was-given-up-leaves-the-run-as-it-was
  (run:with-simulation (rover :seed 1)
    (driver:begin-plan (rpl:interp-lambda (log) (rpl:wait-time 3) log) *standard-output*)
    (run:run-ticks 1)
    (let ((digest (run:state-digest time:*simulation* t)))
      (handler-bind ((base:cannot-fork (lambda (condition)
                                         (declare (ignore condition))
                                         (invoke-restart 'base:make-no-fork))))
        (is (null (run:fork-simulation :seed 3)))
        (is (null (run:with-fork () (fail "run in no fork")))))
      (is (= digest (run:state-digest time:*simulation* t))))))

;;; What users say.

(defstruct (ledger (:constructor make-ledger (entries))) "Notes that all forks share." entries)

(defmethod base:copy-plan-value ((ledger ledger) fork)
  (declare (ignore fork))
  ledger)

(defstruct (record-file (:constructor make-record-file (stream name)))
  "A file, and who writes to it."
  stream name)

(defmethod base:copy-plan-value ((file record-file) fork)
  (make-record-file (make-broadcast-stream) (base:forked (record-file-name file) fork)))

(defclass account () ((owner :initarg :owner :reader account-owner))
  (:documentation "What belongs to somebody."))

(defmethod base:copy-plan-value ((account account) fork)
  (base:record-copy account
                    (make-instance 'account :owner (base:forked (account-owner account) fork))
                    fork))

(test copies.as-users-say
  (let* ((owner (list "me")) (ledger (make-ledger owner))
         (file (make-record-file *standard-output* owner))
         (account (make-instance 'account :owner owner)))
    (with-forked (copy (list ledger ledger file account account owner))
      (destructuring-bind (ledger-copy same file-copy account-copy same-account owner-copy) copy
        (is (eq ledger ledger-copy))
        (is (eq ledger same))
        (is (eq owner (ledger-entries ledger-copy)))
        (is (eq owner-copy (record-file-name file-copy)))
        (is (not (eq *standard-output* (record-file-stream file-copy))))
        (is (eq account-copy same-account))
        (is (not (eq account account-copy)))
        (is (eq owner-copy (account-owner account-copy)))))))

(test copies.of-what-a-method-replaces-are-one
  "A method need not say what it has copied to what: it is asked once."
  (let ((file (make-record-file *standard-output* (list "me"))))
    (with-forked (copy (list file file))
      (is (eq (first copy) (second copy))))))

(defstruct (latecomer (:constructor make-latecomer (part)))
  "What a method is defined for later."
  part)

(test copies.follow-a-method-defined-later
  (let ((value (make-latecomer (list 1))))
    (is (not (eq value (with-forked (copy value) copy))))
    (let ((method (defmethod base:copy-plan-value ((value latecomer) fork)
                    (declare (ignore fork))
                    value)))
      (unwind-protect (is (eq value (with-forked (copy value) copy)))
        (remove-method #'base:copy-plan-value method)))
    (is (not (eq value (with-forked (copy value) copy))))))

;;; Other runs.

(test copies.of-other-runs-are-what-they-are
  (run:with-simulation (rover :seed 2)
    (let* ((other time:*simulation*) (others-rover rover)
           (ball (world:make-new-thing 'ball (list world:*world* 5.5 9.5) '((:size 1))))
           (others (list other others-rover (robot:robot-hand rover 0) world:*world* ball)))
      (driver:rpl-init-robot rover)
      (let ((task (driver:begin-plan (rpl:interp-lambda () (rpl:wait-time 9))))
            (fluent (fluent nil 'others)))
        (with-forked (copy (append others (list task)))
          (is (every #'eq (append others (list task)) copy)))
        (is (null (rpl:fluent-value fluent)))))))

(test copies.of-a-fork-in-a-variable
  "A plan may keep a fork of its own run: it is another run, which forks share."
  (run:with-simulation (rover :seed 1)
    (let ((task (driver:begin-plan (rpl:interp-lambda (box)
                                     (rpl:wait-time 4)
                                     (run:simulation-tick (first box)))
                                   (list nil))))
      (run:run-ticks 1)
      (let ((fork (run:fork-simulation)))
        (setf (first (first (mapcar #'second (rpl:task-variables task)))) fork)
        (run:with-fork ()
          (let ((task (first (driver:plans))))
            (is (eq fork (first (first (mapcar #'second (rpl:task-variables task))))))
            (run:run-ticks 3 fork)
            (run:run-ticks 5)
            (is (= 4 (rpl:task-result task)))))
        (is (= 4 (run:simulation-tick fork)))
        (run:release-fork fork)))))

;;; A user's method may fail.

(defstruct grudge "What the method for it does not like.")

(defmethod base:copy-plan-value ((value grudge) fork)
  (declare (ignore fork))
  (error "I will not."))

(rpl:def-interp-proc bear-a-grudge ()
  (let ((held (make-grudge)))
    (rpl:wait-time 50)
    held))

(test forking.a-method-that-fails-is-named-with-its-value
  (run:with-simulation (ars-worlds:dot)
    (driver:begin-plan 'bear-a-grudge)
    (run:run-ticks 2)
    (let ((seen nil))
      (handler-bind ((base:cannot-fork (lambda (condition)
                                         (setf seen condition)
                                         (invoke-restart 'base:share-value))))
        (is-true (run:fork-simulation)))
      (is (has-words-p (princ-to-string seen) "the variable held" "I will not")))))
