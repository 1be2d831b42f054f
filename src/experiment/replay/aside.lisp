;;;; aside.lisp -- a trial run again in this thread, and who looks at it while it stands still.

(in-package :ars-magna.experiment)

(export '(run-again call-aside))

;;; Workers run trials unseen, in threads of their own. Here a trial is run where people see what it
;;; says and can stop it between two ticks. It goes the same way, as it finds what it would find in
;;; a worker: values as they are at top level, where this thread has others bound. Whoever looks at
;;; it does so aside: with the reader, printer and dice that he had outside, and the debugger.

(defparameter *surroundings*
  (list *lisps-dice*
        '*package* '*readtable* '*read-default-float-format* '*read-base* '*print-base*
        '*print-radix* '*print-case* '*print-pretty* '*print-readably* '*print-escape*
        '*print-circle* '*print-length* '*print-level* '*print-array* '*print-gensym* '*asker*)
  "Variables that are one thing for a trial and another for who looks at it.")

(defstruct (outside (:constructor make-outside (values hook)) (:copier nil))
  "What *SURROUNDINGS* and the debugger's hook are outside of a trial."
  (values '() :type list)
  (hook nil :read-only t))

(defvar *outside* nil "That of the trial that is run again here, or NIL.")

(defun call-aside (function)
  "Call FUNCTION, of who looks at the trial that is run again here. What it sets of *SURROUNDINGS*
stays so for him. What goes wrong in it is no error of the trial's."
  (let ((outside *outside*))
    (progv *surroundings* (outside-values outside)
      (let ((*aside-p* t))
        (with-debugger-hook ((outside-hook outside))
          (unwind-protect (call-allowing-exits function)
            (drop-unsignalled *message-queue*)
            (setf (outside-values outside) (mapcar #'symbol-value *surroundings*))))))))

(defun call-from-outside (function)
  "Call FUNCTION, which runs a trial, and may call others aside."
  (let ((*outside* (make-outside (mapcar #'symbol-value *surroundings*) (debugger-hook))))
    (unwind-protect (funcall function)
      (mapc #'set *surroundings* (outside-values *outside*)))))

(defun call-as-in-worker (function)
  "Call FUNCTION with the variables of simulations as threads find them. What enters a debugger
where nobody is to answer it is an error of the trial."
  (progv *simulation-variables* (mapcar #'global-value *simulation-variables*)
    (let ((*asker* nil))
      (answering-debugger ((lambda (condition somebody-p)
                             (unless somebody-p (throw 'broken-off condition))))
        (funcall function)))))

(defun run-to-end (experiment result then)
  (keep-history)
  (conduct-to-end experiment result)
  (setf (simulation-gate (current-simulation))
        (lambda (simulation)
          (reject-use "The trial is over, at tick ~D; no more ticks of it pass."
                      (simulation-tick simulation))))
  (funcall then result))

(defun run-again (experiment condition trial &key gate (then #'identity) journal)
  "Run TRIAL of CONDITION of EXPERIMENT as RUN-TRIAL does, but in the open. Call THEN with the
result where the trial has ended, before its simulation is gone. Return the result."
  (let ((result (make-result condition trial (trial-seed experiment trial)))
        (begun-p nil))
    (flet ((run ()
             (call-in-trial (lambda ()
                              (setf begun-p t)
                              (run-to-end experiment result then))
                            experiment condition trial :gate gate :journal journal)))
      (call-from-outside
       (lambda ()
         (call-as-in-worker
          (lambda ()
            (block nil
              (handler-bind ((error (lambda (condition)
                                      (unless begun-p
                                        (note-error result (text-of-condition condition))
                                        (return)))))
                (prepare-trials experiment condition)
                (run))))))))
    result))
