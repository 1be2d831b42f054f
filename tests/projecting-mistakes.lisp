;;;; projecting-mistakes.lisp -- wrong calls of projections, and what plans write in them.

(in-package :ars-test-projecting)
(in-readtable :nisp)

(in-suite projecting)

(defun refusal (function)
  "Return the text of the error that FUNCTION signals, in lower case, or NIL."
  (handler-case (progn (funcall function) nil)
    (error (condition) (string-downcase (princ-to-string condition)))))

(defmacro refused ((&rest words) form)
  "Check that FORM is refused in a text with WORDS."
  `(let ((text (refusal (lambda () ,form))))
     (is-true text "~S is not refused" ',form)
     (dolist (word ',words)
       (is-true (search word text) "~S is not in ~S" word text))))

(defun told-error (plan)
  "Return the error with which PLAN fails, in lower case."
  (string-downcase (princ-to-string (lisp-failure-condition (first (told plan))))))

;;; Mistakes.

(test project.says-what-it-does-not-take
  (on-court ()
    (signals wrong-argument (project '(toss 1) :trials 0))
    (signals wrong-argument (project '(toss 1) :horizon -1))
    (signals wrong-argument (project '(toss 1) :arguments '(1)))
    (signals wrong-argument (project '(toss 1) :cost 7))
    (signals wrong-argument (project '(toss 1) :seed "one"))
    (signals unknown-name (project 'no-such-plan))
    (signals wrong-argument (save-projection-picture 1 "/tmp/none.svg"))
    (destructuring-bind (failure state) (told-of (mapcar #'project-plan '(toss)))
      (is (eq :failed state))
      (is (typep (lisp-failure-condition failure) 'misuse)))
    (is (typep (lisp-failure-condition
                (run-plan-alone (interp-lambda () (project '(toss 1)))))
               'misuse))))

(test project.of-a-run-that-cannot-be-forked-fails
  (on-court ()
    (destructuring-bind (failure state)
        (told-of (let ((stream (make-string-output-stream)))
                   (project '(toss 1))
                   stream))
      (is (eq :failed state))
      (is (typep (lisp-failure-condition failure) 'cannot-fork)))
    (is (equal '(:else :succeeded)
               (told-of (let ((stream (make-string-output-stream)))
                          (handle-failure ((cannot-fork () (return :else)))
                            (try-best () (toss 1) (toss 1))
                            stream)))))))

(test project.says-what-a-plan-can-be
  (on-court ()
    (refused ("project: plan is 5" "the name of a plan") (project 5))
    (refused ("project: plan is nil") (project nil))
    (refused ("project: plan is (toss . 1)") (project '(toss . 1)))
    (refused ("project" "expected (project plan &key") (project '(toss 1) :trails 7))))

(test try-best.checks-its-options
  (refused ("not :trails" "did you mean :trials?") (make-plan '(try-best (:trails 7) 1 2)))
  (on-court ()
    (is (search "try-best: trials is 0" (told-error (interp-lambda () (try-best (:trials 0) 1)))))
    (is (search "try-best: horizon is :far"
                (told-error (interp-lambda () (try-best (:horizon :far) 1)))))
    (is (search "try-best: trials is 0"
                (told-error (interp-lambda () (try-best (:trials 0) 1 2))))))
  (is (search "try-best: seed is a"
              (string-downcase
               (princ-to-string
                (lisp-failure-condition
                 (run-plan-alone (interp-lambda () (try-best (:seed 'a) 1)))))))))

(defkicker ask-ahead (thing) (:prob 1)
  (project '(toss 1)))

(test refusals.say-what-was-called
  (on-court ()
    (refused ("fork-simulation: simulation is 7") (fork-simulation 7))
    (refused ("with-fork: seed is") (with-fork (:seed "one") 1))
    (refused ("set-thinking: simulation is nil" "a robot in a simulation") (set-thinking :free nil))
    (is (eq :free (set-thinking :free runner)))
    (refused ("rewind: simulation is 7") (rewind 1 7))
    (is (search "with-fork: a plan is at work"
                (told-error (interp-lambda () (mapcar (lambda (n) (with-fork () n)) '(1)))))))
  (on-court ()
    (make-new-thing 'bell (cons *world* '(5 5)) '() :kickers '(ask-ahead))
    (run-ticks 1)
    (let ((texts (mapcar #'message-text (take-messages))))
      (is (= 1 (length texts)))
      (is (search "project: a tick is under way" (first texts)) "~S" texts))))

(test picture.counts-rollouts-as-its-subtitle-does
  (on-court ()
    (let ((projection (project '(toss 1) :trials 3)))
      (uiop:with-temporary-file (:pathname file :type "svg")
        (save-projection-picture projection file :layers '(:legend :title))
        (let ((text (uiop:read-file-string file)))
          (is (search "of 3 rollouts" text))
          (is (null (search " trial" text))))))))

(test picture.needs-a-directory
  (on-court ()
    (let ((projection (project '(toss 1) :trials 1)))
      (refused ("save-projection-picture: file is" "make" "no-such-place/ first")
               (save-projection-picture projection "/tmp/no-such-place/ways.svg"))
      (refused ("save-projection-picture: file is 7") (save-projection-picture projection 7)))))

;;; Errors in what is given besides the plan: one message for all rollouts.

(defun texts-of-messages ()
  (mapcar (lambda (message) (string-downcase (message-text message))) (take-messages)))

(test project.tells-once-of-errors-in-its-functions
  (on-court ()
    (let ((projection (project '(toss 1) :trials 5 :cost (lambda () (error "No price")))))
      (is (equal '((lisp-failure . 5)) (projection-failures projection)))
      (is (search "first error: No price" (prin1-to-string projection))))
    (let ((texts (texts-of-messages)))
      (is (= 1 (length texts)))
      (is (search "the function :cost of project, in 5 of 5 rollouts" (first texts)))
      (is (search "no price" (first texts))))
    (project '(toss 1) :trials 4 :world (lambda (run seed) (list run seed)))
    (let ((texts (texts-of-messages)))
      (is (= 1 (length texts)))
      (is (search "the function :world of project, in 4 of 4 rollouts" (first texts))))
    (told-of (try-best (:trials 3 :cost (lambda () :dear)) (toss 1) (toss 1)))
    (let ((texts (texts-of-messages)))
      (is (= 1 (length texts)))
      (is (search "the function :cost of try-best, in 6 of 6 rollouts" (first texts)))
      (is (search "try-best: cost is :dear" (first texts))))))

(test projection.shows-the-first-error-of-its-plan
  (on-court ()
    (let ((projection (project (interp-lambda () (wait-time 1) (error "Too~%bad")) :trials 2)))
      (is (search "first error: Too bad" (prin1-to-string projection)))
      (is (null (texts-of-messages))))))

;;; What plans write.

(def-interp-proc sing (&optional (song "la"))
  (format t "~A" song)
  (wait-time 1)
  (format *error-output* "~A" song)
  :sung)

(defmacro written (&body body)
  "Return what BODY writes."
  `(with-output-to-string (*standard-output*)
     (let ((*error-output* *standard-output*)) ,@body)))

(test rollouts.are-quiet-unless-asked
  (on-court ()
    (is (string= "" (written (project 'sing :trials 3))))
    (is (string= "lalala" (written (project 'sing :trials 1 :print t)
                                   (format t "la"))))
    (is (string= "mimi" (written (told-of (try-best (:trials 2) (seq (sing "do") (fail))
                                            (sing "mi"))))))
    (is (string= "dodomimi"
                 (written (told-of (try-best (:trials 1 :until :branch :print t)
                                     (seq (sing "do") (fail))
                                     (format t "mi"))))))
    (is (string= "" (written (project 'sing :trials 2 :world #'believed-court))))))

(test with-rollout.lets-its-forms-write
  (on-court ()
    (let ((rollout (first (projection-rollouts (project 'sing :trials 1)))))
      (is (string= "end" (written (with-rollout (rollout) (format t "end")))))
      (is (string= "lalaend" (written (with-rollout (rollout :print t) (format t "end"))))))))
