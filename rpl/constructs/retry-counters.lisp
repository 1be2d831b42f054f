;;;; retry-counters.lisp -- how often a handler may retry.

(in-package :ars-magna.rpl.constructs)

;;; A counter is a variable; another one, that only macros know, holds what it started with.

(defun start-variable (counter)
  "Return the variable that holds what COUNTER, a symbol, started with."
  (or (get counter 'start-variable)
      (setf (get counter 'start-variable)
            (make-symbol (format nil "START-OF-~A" counter)))))

(defun check-counters (counters)
  (dolist (counter counters)
    (unless (typep counter '(cons (and symbol (not null)) (cons t null)))
      (reject-clause "with-retry-counters" counter "(name number)"))))

(define-construct with-retry-counters (counters &body body)
  "Run BODY in a plan with COUNTERS, each (name number), for DO-RETRY, GET-COUNTER and
RESET-COUNTER. A counter is a variable, too. (CRAM's, where it is none.)"
  (:in-lisp (progn
              (check-counters counters)
              `(let ,(loop for (name number) in counters
                           collect `(,(start-variable name) ,number))
                 (let ,(loop for (name) in counters collect `(,name ,(start-variable name)))
                   (declare (ignorable ,@(mapcar #'first counters)))
                   ,@body)))))

(define-construct do-retry (counter &body body)
  "In a handler: run BODY, most likely (retry), if COUNTER is positive, and count it
down. (CRAM's.)"
  (:in-lisp `(when (plusp ,counter)
               (decf ,counter)
               ,@body)))

(defun check-counter (operator counter environment)
  (unless (and counter (symbolp counter) (local-variable-p (start-variable counter) environment))
    (reject-clause operator counter "the name of a counter of the with-retry-counters around it")))

(addition get-counter)
(defmacro get-counter (counter &environment environment)
  "Return how often DO-RETRY will still run for COUNTER, of WITH-RETRY-COUNTERS. (CRAM's.)"
  (check-counter "get-counter" counter environment)
  counter)

(addition reset-counter)
(defmacro reset-counter (counter &environment environment)
  "Let COUNTER, of WITH-RETRY-COUNTERS, be what it was at first. Return that. (CRAM's.)"
  (check-counter "reset-counter" counter environment)
  `(setq ,counter ,(start-variable counter)))
