;;;; interrupts.lisp -- deferring interrupts, time limits and signals; certain cleanup.

(in-package :ars-magna.host)

(export '(deferring-interrupts allowing-interrupts with-interruptible-wait
          interrupts-deferred-p protecting-strictly
          call-holding-interrupts call-open-to-interrupts waiting-at-most deadline-passed
          in-any-case call-interruptible call-each time-limit let-callers-handle call-with-limit
          user-interrupt signal-user-interrupt call-on-interrupt call-on-continuing
          die-of-interrupts die-of-termination))

;;; A thread is interrupted by a time limit, Ctrl-C, another thread, or a request to end. An
;;; interrupt may exit from the code that it hits. It is deferred where that would leave a lock held
;;; for ever.

;;; SBCL's WITHOUT-INTERRUPTS with ALLOW-WITH-INTERRUPTS inside cannot be used: the runtime dies if
;;; an interrupt comes during a garbage collection in that thread, and each lock that is taken
;;; allows interrupts. So interrupts are deferred strictly. To allow them, code calls a function
;;; that was made outside.

(defvar *holding* nil
  "What defers the interrupts of this thread: NIL for nothing; :STRICTLY; or a function that calls
another with interrupts allowed, if its second argument is true only where SBCL waits.")

(declaim (inline interrupts-deferred-p))
(defun interrupts-deferred-p ()
  "True if interrupts of this thread are deferred here."
  (and *holding* t))

(defun call-deferring-interrupts (function)
  (if *holding*
      (funcall function)
      (internal (:sb-sys #:without-interrupts)
        (flet ((let-in (function waiting-p)
                 (if waiting-p
                     (internal (:sb-sys #:allow-with-interrupts) (funcall function))
                     (internal (:sb-sys #:with-local-interrupts) (funcall function)))))
          (declare (dynamic-extent #'let-in))
          (let ((*holding* #'let-in))
            (funcall function))))))

(defun call-allowing-interrupts (function)
  "Do what ALLOWING-INTERRUPTS does."
  (let ((holding *holding*))
    (etypecase holding
      (null (internal (:sb-sys #:with-interrupts) (funcall function)))
      (function (let ((*holding* nil)) (funcall holding function nil)))
      ((eql :strictly) (funcall function)))))

(defun call-with-interruptible-wait (function)
  (let ((holding *holding*))
    (if (functionp holding)
        (funcall holding function t)
        (funcall function))))

(defmacro deferring-interrupts (&body body)
  "Run BODY with interrupts deferred, except within ALLOWING-INTERRUPTS and
WITH-INTERRUPTIBLE-WAIT."
  (form-calling 'call-deferring-interrupts body))

(defmacro allowing-interrupts (&body body)
  "Run BODY with interrupts allowed."
  (form-calling 'call-allowing-interrupts body))

(defmacro with-interruptible-wait (&body body)
  "Run BODY, which waits for a semaphore, with interrupts allowed during the wait."
  (form-calling 'call-with-interruptible-wait body))

;; SBCL allows interrupts at the end of a protected form. That could skip what is to follow.
(defmacro protecting-strictly (form &body cleanup)
  "Do as UNWIND-PROTECT, with no interrupt between FORM and CLEANUP or in CLEANUP. In FORM
interrupts are as outside."
  `(internal (:sb-sys #:without-interrupts)
     (unwind-protect (internal (:sb-sys #:with-local-interrupts) ,form)
       ,@cleanup)))

;;; Strict deferral for functions: code in between cannot allow interrupts.

(defvar *open-to-interrupts* #'funcall
  "A function that calls another with interrupts allowed.")

(defun call-holding-interrupts (function)
  "Call FUNCTION with interrupts deferred, except in what CALL-OPEN-TO-INTERRUPTS calls."
  (internal (:sb-sys #:without-interrupts)
    (let* ((holding *holding*)
           (*open-to-interrupts* (lambda (function)
                                   (let ((*holding* holding))
                                     (internal (:sb-sys #:with-local-interrupts)
                                       (funcall function)))))
           (*holding* :strictly))
      (funcall function))))

(defun call-open-to-interrupts (function)
  "Call FUNCTION with interrupts allowed, including those that were deferred."
  (funcall *open-to-interrupts* function))

;;; A deadline, unlike a time limit, interrupts only where a thread waits.

(deftype deadline-passed ()
  "The condition that a thread still waits for a stream, lock or other thread at its deadline."
  (internal-name :sb-sys '#:deadline-timeout))

(defmacro waiting-at-most ((seconds) &body body)
  "Run BODY. Signals DEADLINE-PASSED where it still waits after SECONDS."
  `(internal (:sb-sys #:with-deadline) (:seconds ,seconds) ,@body))

;;; Cleanup that always completes.

(declaim (inline call-interruptible))
(defun call-interruptible (open-p function)
  "Call FUNCTION, with interrupts allowed if OPEN-P."
  (if open-p
      (call-allowing-interrupts function)
      (funcall (the function function))))

(defun call-in-any-case (first &rest others)
  (declare (dynamic-extent others))
  (let ((open-p (not (interrupts-deferred-p))))
    (labels ((call-rest (functions)
               (when functions
                 (unwind-protect (funcall (the function (first functions)))
                   (call-rest (rest functions))))))
      (deferring-interrupts
        (unwind-protect (call-interruptible open-p first)
          (call-rest others))))))

;; PROTECTING-STRICTLY is for little work that is done often; it allows no interrupts.
(defmacro in-any-case (&body forms)
  "Run FORMS in order, the later ones even after a non-local exit such as THROW. Interrupts are
deferred until all are done, except at waits and in users' code. Return the values of the first."
  (let ((names (loop for nil in forms collect (gensym "PART"))))
    `(flet ,(loop for name in names
                  for form in forms
                  collect `(,name () ,form))
       (declare (dynamic-extent ,@(loop for name in names collect `(function ,name))))
       (call-in-any-case ,@(loop for name in names collect `(function ,name))))))

(defun call-each (function list)
  "Call FUNCTION with each element of LIST in order, also with the rest after a non-local exit."
  (unwind-protect (loop while list do (funcall function (pop list)))
    (when list (call-each function list))))

;;;; Time limits, and other conditions that are for callers

(deftype time-limit ()
  "The condition that the time for a form is up, as by WITH-TIMEOUT."
  'sb-ext:timeout)

;;; FiveAM signals failed checks and continues the test by the restart IGNORE-FAILURE. The caller of
;;; the test handles this, also where the check is in a plan.

(defun failed-check-p (condition)
  (and (typep condition 'error)
       (find "IGNORE-FAILURE" (compute-restarts condition)
             :key #'restart-name :test #'string=)
       t))

(defun let-callers-handle (condition)
  "Let callers of the run handle CONDITION first, if it is for them. True if it is a time limit of
theirs."
  (let ((limit-p (typep condition 'time-limit)))
    (when (or limit-p (failed-check-p condition)) (signal condition))
    limit-p))

(defun call-with-limit (function seconds give-up)
  "Call FUNCTION. Each time SECONDS have passed without its return, call GIVE-UP in this thread,
which may exit from it."
  ;; The timer may have interrupted this thread already when the call ends.
  (let* ((over nil)
         (timer (sb-ext:make-timer (lambda () (unless over (funcall give-up))))))
    (sb-ext:schedule-timer timer seconds :repeat-interval seconds)
    (unwind-protect (funcall function)
      (setf over t)
      (sb-ext:unschedule-timer timer))))

;;;; Signals from the system

(deftype user-interrupt ()
  "The condition that the user has pressed Ctrl-C."
  (internal-name :sb-sys '#:interactive-interrupt))

(defun signal-user-interrupt ()
  "Signal the error USER-INTERRUPT."
  (error (internal-name :sb-sys '#:interactive-interrupt)))

(defun handle-signal (signal handler)
  (internal (:sb-sys #:enable-interrupt) signal handler))

(defun call-on-signal (signal function)
  (handle-signal signal (lambda (&rest arguments)
                          (declare (ignore arguments))
                          (funcall function))))

(defun call-on-interrupt (function)
  "Call FUNCTION, in any thread, when Ctrl-C is pressed."
  (call-on-signal sb-posix:sigint function))

(defun call-on-continuing (function)
  "Call FUNCTION, in any thread, when this process continues after a stop, as by Ctrl-Z."
  (call-on-signal sb-posix:sigcont function))

;;; In some states Lisp can no longer handle a signal, so the system itself ends the process. (It
;;; also does when the terminal closes, unless NOHUP is in effect.)

(defun die-of-interrupts ()
  "Let Ctrl-C end this process at once, as while its memory is being saved."
  (handle-signal sb-posix:sigint :default))

(defun die-of-termination ()
  "Let SIGTERM, or Ctrl-\\, end this process at once."
  (handle-signal sb-posix:sigterm :default)
  (handle-signal sb-posix:sigquit :default))
