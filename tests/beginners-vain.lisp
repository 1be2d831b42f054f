;;;; beginners-vain.lisp -- policies, handlers, commands and fluents that do nothing as written.

(in-package :ars-magna.tests)

(in-suite beginners)

;;; Fluents.

(defvar *herd* (rpl:create-fluent 'herd 1))

(test set-value.refuses-networks-of-the-fluent-itself
  (dolist (form '((rpl:set-value *herd* (+ *herd* 1))
                  (rpl:pulse *herd* (not (> *herd* 3)))
                  (setf (rpl:fluent-value *herd*) (* 2 *herd*))))
    (let ((failure (driver-failure form)))
      (is-true (has-words-p failure "not a network of herd itself" "(fluent-value ...)")
               "~A" failure)))
  (is (= 2 (rpl:run-plan-alone (plan-of (rpl:set-value *herd*
                                                       (+ 1 (rpl:fluent-value *herd*)))))))
  (let ((other (rpl:create-fluent 'other)))
    (is (rpl:fluent-p (rpl:run-plan-alone (plan-of (rpl:set-value other (+ *herd* 1))))))))

(defun driver-failure (form)
  "Return the text of the failure of a plan that does FORM."
  (princ-to-string (rpl:run-plan-alone (rpl:make-plan form))))
