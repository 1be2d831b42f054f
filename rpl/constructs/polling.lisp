;;;; polling.lisp -- wait-until: waiting for what need be no fluent.

(in-package :ars-magna.rpl.constructs)

(defun wait-until-text (condition)
  "Return plan text that waits until CONDITION, a form, is true, and has its value."
  (with-gensyms (met again value)
    `(block ,met
       (tagbody
          ,again
          (let ((,value ,condition))
            (if (fluent-p ,value) (return-from ,met (wait-for ,value)))
            (if ,value (return-from ,met ,value)))
          (wait-time 1)
          (go ,again)))))

(defun doubt-polled (condition form)
  "Warn if CONDITION, which FORM, a WAIT-UNTIL, tests, is known to be true at once."
  (let ((advice (if (realp condition)
                    (format nil "~S is a number, which counts as true. To let time pass, write ~
                                 (wait-time ~:*~S)." condition)
                    (test-advice condition))))
    (when advice (doubt-own-form form "wait-until: ~A" advice))))

(define-construct wait-until (condition)
  "Wait in a plan until the form CONDITION is true; return its value. If it gives a fluent or a
network, as (< level 46) does of a fluent, that is waited for; anything else is tested anew at each
tick. CONDITION may itself wait. (Ours: what policies and AT-LOCATION watch is watched so.)"
  (:code (progn (doubt-polled condition form)
                (plan-code (note-expansion (wait-until-text condition) form) scope))))
