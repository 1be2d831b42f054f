;;;; rpl-failures.lisp -- failing, handling, cleaning up, leaving.

(in-package :ars-magna.tests)
(in-suite rpl)

(define-condition blocked-way (rpl:plan-failure)
  ((where :initarg :where :reader blocked-where)))

(declaim (notinline itself))
(defun itself (object) object)

(rpl:def-interp-proc count-up (n)
  "Return the tick after N turns of a tick each."
  (rpl:n-times n (rpl:wait-time 1))
  (rpl:plan-time))

(defmacro reported (&body body)
  "Run BODY; return the texts of the messages that it queues."
  `(let ((base:*message-queue* (base:make-message-queue)))
     ,@body
     (mapcar #'base:message-text (base:take-messages))))

;;; Failing.

(test fail.carries-class-data-and-place
  (let ((failure (plan-failure-of (rpl:wait-time 3) (rpl:fail :class :lost :near 'door))))
    (is (eq :lost (rpl:failure-class failure)))
    (is (equal '(:near door) (rpl:failure-data failure)))
    (is (= 3 (rpl:failure-tick failure)))
    (is (equal '(rpl:fail :class :lost :near 'door) (rpl:failure-form failure)))
    (is (= 1 (length (rpl:failure-task-path failure))))))

(test fail.with-a-condition-class-of-ones-own
  (let ((failure (plan-failure-of (rpl:fail 'blocked-way :where :door))))
    (is (typep failure 'blocked-way))
    (is (eq :door (blocked-where failure))))
  (is (typep (plan-failure-of (rpl:fail :class 'blocked-way)) 'blocked-way)))

(test fail.in-lisp-code-of-a-leaf
  "IGNORE-ERRORS must not swallow a failure."
  (is (eq :deep (rpl:failure-class
                 (plan-failure-of (mapc (lambda (x) (ignore-errors (rpl:fail :class x)))
                                        '(:deep :deeper)))))))

(test fail.spreads-through-the-tree-of-tasks
  (let ((failure (plan-failure-of (rpl:par (rpl:wait-time 5)
                                           (rpl:pursue (rpl:par (rpl:wait-time 9)
                                                                (rpl:seq (rpl:wait-time 1)
                                                                         (rpl:fail))))))))
    (is (= 4 (length (rpl:failure-task-path failure))))
    (is (equal '(rpl:fail) (first (rpl:failure-plan-backtrace failure))))
    (is (> (length (rpl:failure-plan-backtrace failure)) 3))))

(test lisp-error.becomes-a-failure-with-both-backtraces
  (let ((failure (plan-failure-of (rpl:wait-time 1) (car (itself 3)))))
    (is (typep failure 'rpl:lisp-failure))
    (is (typep (rpl:lisp-failure-condition failure) 'type-error))
    (is (plusp (length (rpl:lisp-failure-backtrace failure))))
    (is (null (search "RUN-STEPS" (rpl:lisp-failure-backtrace failure))))
    (is (equal '(car (itself 3)) (rpl:failure-form failure)))))

(test failure.unhandled-is-reported-whole
  (let ((text (first (reported (rpl:run-plan-alone
                                (rpl:interp-lambda ()
                                  (rpl:par (rpl:seq (rpl:wait-time 2) (car (itself 3))))))))))
    (is (search "at tick 2 in (car (itself 3))" text))
    (is (search "par" text))
    (is (search "Lisp:" text))))

(test failure.an-unknown-procedure-names-the-nearest
  (let ((failure (plan-failure-of
                   (rpl:call-plan (handler-bind ((warning #'muffle-warning))
                                    (eval '(rpl:interp-lambda () (count-upp 3))))))))
    (is (typep (rpl:lisp-failure-condition failure) 'base:unknown-name))
    (is (search "count-up" (princ-to-string failure)))))

;;; Handling.

(test handle-failure.by-class-condition-and-anything
  (flet ((handled (arguments)
           (plan-value
             (rpl:handle-failure ((:lost (f) (return (list :lost (rpl:failure-data f))))
                                  (blocked-way (f) (return (list :way (blocked-where f))))
                                  ((or type-error division-by-zero) (e)
                                   (return (list :lisp (type-of e))))
                                  (t () (return :other)))
               (rpl:wait-time 1)
               (apply #'rpl:fail arguments)))))
    (is (equal '(:lost (:x 1)) (handled '(:class :lost :x 1))))
    (is (equal '(:way :door) (handled '(blocked-way :where :door))))
    (is (equal :other (handled '(:class :found))))
    (is (equal :other (handled '()))))
  (is (eq 'division-by-zero
          (plan-value (rpl:with-failure-handling ((division-by-zero (e) (return (type-of e))))
                        (rpl:par (rpl:wait-time 9)
                                 (rpl:par (rpl:seq (rpl:wait-time 1) (/ 1 (itself 0))))))))))

(test handle-failure.lisp-errors-are-no-plan-failures-and-the-other-way-round
  (is (eq :lost (rpl:failure-class
                 (plan-failure-of (rpl:handle-failure ((error () (return :caught)))
                                    (rpl:fail :class :lost))))))
  (is (eq :caught (plan-value (rpl:handle-failure ((error () (return :caught)))
                                (error "Lisp's"))))))

(test handle-failure.a-handler-that-ends-passes-the-failure-on
  (is (equal '((:inner 0) (:outer 2))
             (with-log (note)
               (is (eq :done
                       (plan-value
                         (rpl:handle-failure ((t (f) (note :outer) (return :done)))
                           (rpl:handle-failure ((:lost (f) (note :inner) (rpl:wait-time 2)))
                             (rpl:fail :class :lost))))))))))

(test handle-failure.success-is-left-alone
  (is (eq :fine (plan-value (rpl:handle-failure ((t () (return :caught))) :fine)))))

(test handle-failure.no-clause-fits
  (is (eq :lost (rpl:failure-class
                 (plan-failure-of (rpl:handle-failure ((:found () (return 1)))
                                    (rpl:fail :class :lost)))))))

(test retry.runs-the-body-anew
  (is (equal '((1 1) (2 2) (3 3))
             (with-log (note)
               (let ((n 0))
                 (is (eq :third (plan-value
                                  (rpl:handle-failure ((t (f) (rpl:retry)))
                                    (rpl:wait-time 1)
                                    (note (incf n))
                                    (if (< n 3) (rpl:fail) :third)))))))))
  (is (eq :gave-up (plan-value
                     (rpl:with-retry-counters ((tries 3))
                       (rpl:with-failure-handling
                           ((:lost (f)
                             (rpl:do-retry tries (rpl:wait-time 1) (rpl:retry))
                             (return :gave-up)))
                         (rpl:fail :class :lost)))))))

(test handle-failure.a-failure-in-a-handler-knows-its-cause
  (let ((failure (plan-failure-of (rpl:handle-failure ((:first () (rpl:fail :class :second)))
                                    (rpl:fail :class :first)))))
    (is (eq :second (rpl:failure-class failure)))
    (is (eq :first (rpl:failure-class (rpl:failure-cause failure))))))

;;; Protection.

(test evap-protect.cleans-up-after-success-failure-and-evaporation
  (is (equal '((:ok 3) (:failed 6) (:gone 9))
             (with-log (note)
               (is (= 1 (plan-value
                          (prog1 (rpl:evap-protect (rpl:seq (rpl:wait-time 1) 1)
                                                   (rpl:seq (rpl:wait-time 2) (note :ok)))
                            (rpl:handle-failure ((t () (return)))
                              (rpl:evap-protect (rpl:seq (rpl:wait-time 1) (rpl:fail))
                                                (rpl:seq (rpl:wait-time 2) (note :failed))))
                            (rpl:pursue (rpl:wait-time 1)
                                        (rpl:evap-protect
                                            (rpl:wait-time 10)
                                          (rpl:seq (rpl:wait-time 2) (note :gone))))))))))))

(test evap-protect.innermost-first-and-children-before-their-parents
  (is (equal '((:child 2) (:inner 3) (:outer 4) (:end 4))
             (with-log (note)
               (plan-value
                 (rpl:pursue
                  (rpl:wait-time 1)
                  (rpl:evap-protect
                      (rpl:evap-protect
                          (rpl:par (rpl:evap-protect (rpl:wait-time 9)
                                                     (rpl:seq (rpl:wait-time 1) (note :child))))
                        (rpl:seq (rpl:wait-time 1) (note :inner)))
                    (rpl:seq (rpl:wait-time 1) (note :outer))))
                 (note :end))))))

(test evap-protect.children-evaporate-newest-first
  (is (equal '((3 1) (2 1) (1 1))
             (with-log (note)
               (plan-value (rpl:pursue (rpl:evap-protect (rpl:wait-time 9) (note 1))
                                       (rpl:evap-protect (rpl:wait-time 9) (note 2))
                                       (rpl:wait-time 1)
                                       (rpl:evap-protect (rpl:wait-time 9) (note 3))))))))

(test evap-protect.a-cleanup-is-not-cut-short
  "Evaporating a task that cleans up changes nothing until it has."
  (is (equal '((:cleaned 6) (:end 6))
             (with-log (note)
               (plan-value
                 (rpl:pursue (rpl:wait-time 3)
                             (rpl:seq (rpl:evap-protect (rpl:wait-time 1)
                                                        (rpl:seq (rpl:wait-time 5)
                                                                 (note :cleaned)))
                                      (note :never)))
                 (note :end))))))

(test evap-protect.a-cleanup-can-be-limited
  (is (equal '((:end 4))
             (with-log (note)
               (plan-value (rpl:pursue (rpl:wait-time 1)
                                       (rpl:evap-protect (rpl:wait-time 9)
                                                         (rpl:seq (rpl:wait-time 50)
                                                                  (note :never))
                                                         :limit 3))
                           (note :end))))))

(test evap-protect.a-failing-cleanup-does-not-hide-the-first-failure
  (let ((failure (plan-failure-of (rpl:evap-protect (rpl:fail :class :first)
                                                    (rpl:fail :class :second)))))
    (is (eq :first (rpl:failure-class failure)))
    (is (equal '(:second) (mapcar #'rpl:failure-class (rpl:failure-suppressed failure)))))
  (is (eq :second (rpl:failure-class
                   (plan-failure-of (rpl:evap-protect :fine (rpl:fail :class :second)))))))

(test evap-protect.a-cleanup-that-fails-or-leaves-cannot-save-an-evaporating-task
  (is (equal '((:end 1))
             (with-log (note)
               (plan-value
                 (rpl:pursue (rpl:wait-time 1)
                             (rpl:seq (block nil
                                        (rpl:evap-protect (rpl:wait-time 9) (return :saved)))
                                      (note :never)))
                 (note :end)))))
  (is (= 1 (length (reported
                     (rpl:run-plan-alone
                      (rpl:interp-lambda ()
                        (rpl:pursue (rpl:wait-time 1)
                                    (rpl:evap-protect (rpl:wait-time 9) (rpl:fail))))))))))

(test evap-protect.protects-against-being-left
  (is (equal '((:cleaned 3))
             (with-log (note)
               (is (eq :left
                       (plan-value
                         (block around
                           (rpl:par (rpl:evap-protect (rpl:seq (rpl:wait-time 1)
                                                               (return-from around :left))
                                                      (rpl:seq (rpl:wait-time 2)
                                                               (note :cleaned)))
                                    (rpl:wait-time 9))))))))))

;;; Leaving.

(test return-from.out-of-parallel-branches
  (is (equal '(:out 2)
             (plan-value (list (block around
                                 (rpl:par (rpl:wait-time 9)
                                          (rpl:par (rpl:seq (rpl:wait-time 2)
                                                            (return-from around :out)))
                                          (rpl:wait-time 5)))
                               (rpl:plan-time))))))

(test return-from.a-local-plan-or-a-recursive-one
  (is (equal '(:deep 4)
             (plan-value
               (labels ((dig (n)
                          (rpl:wait-time 1)
                          (if (= n 3) (return-from dig :deep) (dig (+ n 1)))
                          (values :no 0)))
                 (list (block nil (return (dig 3))) (+ 3 (rpl:plan-time))))))))

(test go.again-and-out-of-branches
  (is (equal '(3 3)
             (plan-value (let ((n 0))
                           (tagbody
                            again
                              (rpl:par (rpl:seq (rpl:wait-time 1)
                                                (when (< (incf n) 3) (go again)))
                                       (rpl:wait-time 1)))
                           (list n (rpl:plan-time)))))))

(test evap-protect.a-cleanup-that-went-well-is-not-complained-about
  (is (null (reported
              (is (eq :handled
                      (plan-value
                        (rpl:handle-failure ((t () (return :handled)))
                          (rpl:evap-protect (rpl:fail) (rpl:wait-time 1))))))))))
