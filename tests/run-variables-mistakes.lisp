;;;; run-variables-mistakes.lisp -- run variables: wrong init forms, wrong names, wrong order.

(in-package :ars-magna.tests)

(def-suite* run-variables-mistakes :in ars-magna)

(run:define-run-variable *wrong-init* (make-hash-table))
(run:define-run-variable *selfish* (1+ *selfish*))
(run:define-run-variable *broken* (error "Broken."))
(run:define-run-variable *leaning* (list *broken*))
(run:define-run-variable *mover* (progn (run:set-seed 3) 1))
(run:define-run-variable *driver* (command:robot-turn (robot:find-robot 'otter) 1))
(run:define-run-variable *planner* (driver:begin-plan (rpl:interp-lambda () (rpl:wait-time 1))))
(run:define-run-variable *symbol-set* 1)

(test init-form.that-is-wrong-says-so-at-the-first-use
  (in-lagoon ()
    (is (search "*wrong-init* is #<HASH-TABLE" (text-of-error (lambda () *wrong-init*))))
    (is (search "of the run variable *selfish* failed: It uses *selfish*, which has no value yet."
                (text-of-error (lambda () *selfish*))))
    (is (search "of the run variable *broken* failed: Broken. Correct the form"
                (text-of-error (lambda () *broken*))))
    (is (search "of the run variable *leaning* failed: The init form of the run variable *broken* "
                (text-of-error (lambda () *leaning*))))
    (setf *wrong-init* 3)
    (is (= 3 *wrong-init*))))

(test init-form.acts-before-the-robots-of-the-run-may-act
  (run:with-simulation (otter)
    (loop for (name . function) in `(("*mover*" . ,(lambda () *mover*))
                                     ("*driver*" . ,(lambda () *driver*))
                                     ("*planner*" . ,(lambda () *planner*)))
          do (is-true (has-words-p (text-of-error function) name "It cannot command robots"
                                   "before the robots of the run may act. Correct the form")))))

(test init-form.that-was-wrong-is-corrected-in-the-run
  (base:with-own-definitions ()
    (in-lagoon ()
      (eval '(run:define-run-variable *brief* (error "Not yet.")))
      (is (search "failed: Not yet." (text-of-error (lambda () (eval '*brief*)))))
      (eval '(run:define-run-variable *brief* 5))
      (is (= 5 (eval '*brief*))))))

(test define-run-variable.refuses-other-variables
  (loop for (form text) in '(((run:define-run-variable *tallies* 0) "(unintern '*tallies*)")
                             ((run:define-run-variable pi 0) "belongs to COMMON-LISP")
                             ((run:define-run-variable :key 0) "a symbol as the name")
                             ((run:define-run-variable everywhere-later 0) "is a symbol macro")
                             ((run:define-run-variable *new-tally*) "name init")
                             ((run:define-run-variable *new-tally* 0 :doc) "[string]"))
        do (is (search text (text-of-error (lambda () (eval form)))))))

(defun text-of-lisp-error (function)
  (handler-case (progn (funcall function) nil)
    (error (condition) (base:text-of-condition condition))))

(test defvar.of-a-run-variable-says-what-to-do
  (dolist (form '((defvar *catch* 1) (defparameter *catch* 1)))
    (is-true (has-words-p (text-of-lisp-error (lambda () (eval form)))
                          "*catch* is a run variable" "remove its DEFVAR or DEFPARAMETER"
                          "(undefine 'run-variable '*catch*)"))))

(test set.of-the-symbol-is-seen-at-the-next-use
  (in-lagoon ()
    (unwind-protect
         (progn
           (setf *symbol-set* 2)
           (set '*symbol-set* 3)
           (dolist (use (list (lambda () *symbol-set*) (lambda () (incf *symbol-set*))))
             (is (search "(makunbound '*symbol-set*), use SETF" (text-of-error use)))))
      (makunbound '*symbol-set*))
    (is (= 2 *symbol-set*))))

(defun compile-without-warnings (form)
  (let ((*error-output* (make-broadcast-stream)))
    (handler-bind ((warning #'muffle-warning)) (compile nil form))))

(test code.compiled-before-the-definition-is-told-so
  (base:with-own-definitions ()
    (let ((use (compile-without-warnings '(lambda () (incf *late*)))))
      (eval '(run:define-run-variable *late* 1))
      (in-lagoon ()
        (is (search "Define a run variable before the code that uses it"
                    (text-of-lisp-error use))))))
  (base:with-own-definitions ()
    (funcall (compile-without-warnings '(lambda () (setq *later* 1))))
    (unwind-protect
         (is (search "evaluate (makunbound '*later*)"
                     (text-of-error (lambda () (eval '(run:define-run-variable *later* 1))))))
      (makunbound '*later*))))

(test define-run-variable.of-a-name-of-the-simulator-says-so
  (flet ((text (name)
           (princ-to-string
            (nth-value 1 (ignore-errors
                          (macroexpand-1 `(run:define-run-variable ,name 1)))))))
    (is-false (has-words-p (text 'base:motion-noise*) "DEFVAR") "~A" (text 'base:motion-noise*))
    (is-true (has-words-p (text 'base:motion-noise*) "a name that is free"))))

;;; Definitions that change.

(test run-variable.that-is-defined-otherwise-makes-replays-differ
  (base:with-own-definitions ()
    (eval '(run:define-run-variable *fee* 1))
    (flet ((recorded ()
             (in-lagoon (:journal t)
               (run:run-ticks 1)
               (eval '*fee*)
               (run:journal-up-to-now time:*simulation*))))
      (let ((journal (recorded)))
        (eval '(run:define-run-variable *fee* 1 "The same form but for a docstring."))
        (signals run:different-definitions (run:replay journal))
        (eval '(run:define-run-variable *fee* 1))
        (is (integerp (nth-value 1 (run:replay journal))))
        (eval '(run:define-run-variable *fee* 50))
        (signals run:different-definitions (run:replay journal))))))

(test run-variable.with-the-name-of-a-measure-is-told-of
  (base:with-own-definitions ()
    (flet ((told (form) (format nil "~{~A~}" (warnings-of (lambda () (eval form))))))
      (eval '(run:define-run-variable *weighed* 0))
      (is (search "*weighed* is a run variable and a measure" (told '(run:defmeasure *weighed* 1))))
      (eval '(run:defmeasure *measured* 1))
      (is (search "*measured* is a run variable and a measure"
                  (told '(run:define-run-variable *measured* 0)))))))

;;; Asking a run makes it the current one.

(defun in-new-thread (function)
  "Return the value of FUNCTION, called in a new thread."
  (let ((value nil))
    (base:join-thread (base:start-thread (lambda () (setf value (funcall function))) "asker"))
    value))

(test asking.a-headless-run-from-another-thread-sets-its-variables
  (in-lagoon ()
    (let ((robot otter) (run time:*simulation*))
      (setf *catch* 1)
      (is (equalp '(2 5d0) (in-new-thread (lambda ()
                                         (time:asking (robot)
                                           (list (incf *catch*) (robot:robot-x otter)))))))
      (is (eq run (in-new-thread (lambda () (time:asking (run) (time:current-simulation))))))
      (in-new-thread (lambda () (time:asking (run) (incf *catch* 10))))
      (is (= 12 *catch*)))))

(test asking.an-outer-run-sets-its-variables
  (in-lagoon (:seed 1)
    (let ((outer time:*simulation*) (robot otter))
      (in-lagoon (:seed 2)
        (setf *catch* 5)
        (is (= 1 (time:asking (robot) (run:simulation-seed (time:current-simulation)))))
        (time:asking (outer) (setf *catch* 7))
        (is (= 5 *catch*)))
      (is (= 7 *catch*)))))

(test asking.an-ended-run-changes-no-other
  (let ((ended nil))
    (in-lagoon () (setf *catch* 3 ended otter))
    (in-lagoon ()
      (setf *catch* 4)
      (is (= 3 (time:asking (ended) *catch*)))
      (is (search "is over" (text-of-error (lambda () (time:asking (ended) (setf *catch* 9))))))
      (is (= 4 *catch*)))))
