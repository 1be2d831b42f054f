;;;; interrupts.lisp -- deferring interrupts, time limits and signals; certain cleanup.

(in-package :ars-magna.host)

(export '(deferring-interrupts allowing-interrupts with-interruptible-wait
          interrupts-deferred-p unwind-protect-strictly
          call-holding-interrupts call-releasing-interrupts waiting-at-most deadline-passed
          in-any-case call-allowing-interrupts-if call-each time-limit signal-to-callers-first
          call-with-time-limit
          user-interrupt signal-user-interrupt call-on-interrupt call-on-continuing
          end-on-interrupt end-on-termination))

;;; A thread is interrupted by a time limit, Ctrl-C, another thread, or a request to end. An
;;; interrupt may exit from the code it hits. It is deferred where that would leave a lock held.

;;; SBCL's WITHOUT-INTERRUPTS with ALLOW-WITH-INTERRUPTS inside cannot be used: the runtime dies if
;;; an interrupt comes during a garbage collection there, and taking a lock allows interrupts. So
;;; interrupts are deferred strictly. To allow them, code calls a function made outside.

(defvar *interrupt-deferral* nil
  "How this thread defers interrupts: NIL, not at all; :STRICTLY, everywhere; or a function
with the arguments FUNCTION and WAITING-P. The function calls FUNCTION with interrupts allowed; if
WAITING-P is true, only while SBCL waits.")

(declaim (inline interrupts-deferred-p))
(defun interrupts-deferred-p ()
  "True if this thread defers interrupts now."
  (and *interrupt-deferral* t))

(defun call-deferring-interrupts (function)
  (if *interrupt-deferral*
      (funcall function)
      (internal (:sb-sys #:without-interrupts)
        (flet ((let-in (function waiting-p)
                 (if waiting-p
                     (internal (:sb-sys #:allow-with-interrupts) (funcall function))
                     (internal (:sb-sys #:with-local-interrupts) (funcall function)))))
          (declare (dynamic-extent #'let-in))
          (let ((*interrupt-deferral* #'let-in))
            (funcall function))))))

(defun call-allowing-interrupts (function)
  "Call FUNCTION with interrupts allowed, unless they are strictly deferred."
  (let ((holding *interrupt-deferral*))
    (etypecase holding
      (null (internal (:sb-sys #:with-interrupts) (funcall function)))
      (function (let ((*interrupt-deferral* nil)) (funcall holding function nil)))
      ((eql :strictly) (funcall function)))))

(defun call-with-interruptible-wait (function)
  (let ((holding *interrupt-deferral*))
    (if (functionp holding)
        (funcall holding function t)
        (funcall function))))

(defmacro deferring-interrupts (&body body)
  "Run BODY with interrupts deferred except in ALLOWING-INTERRUPTS and WITH-INTERRUPTIBLE-WAIT."
  (form-calling 'call-deferring-interrupts body))

(defmacro allowing-interrupts (&body body)
  "Run BODY with interrupts allowed."
  (form-calling 'call-allowing-interrupts body))

(defmacro with-interruptible-wait (&body body)
  "Run BODY, which waits for a semaphore, with interrupts allowed during the wait."
  (form-calling 'call-with-interruptible-wait body))

;; SBCL allows interrupts at the end of a protected form. That could skip what is to follow.
(defmacro unwind-protect-strictly (form &body cleanup)
  "Evaluate FORM and then CLEANUP, as UNWIND-PROTECT does. No interrupt can occur between FORM and
CLEANUP, or in CLEANUP. In FORM, interrupts are allowed if they are allowed outside."
  `(internal (:sb-sys #:without-interrupts)
     (unwind-protect (internal (:sb-sys #:with-local-interrupts) ,form)
       ,@cleanup)))

;;; Strict deferral for functions: code in between cannot allow interrupts.

(defvar *call-releasing-interrupts* #'funcall
  "A function that calls its argument, a function, with interrupts allowed.")

(defun call-holding-interrupts (function)
  "Call FUNCTION with interrupts deferred, except within CALL-RELEASING-INTERRUPTS."
  (internal (:sb-sys #:without-interrupts)
    (let* ((holding *interrupt-deferral*)
           (*call-releasing-interrupts* (lambda (function)
                                          (let ((*interrupt-deferral* holding))
                                            (internal (:sb-sys #:with-local-interrupts)
                                              (funcall function)))))
           (*interrupt-deferral* :strictly))
      (funcall function))))

(defun call-releasing-interrupts (function)
  "Call FUNCTION with interrupts allowed, including those that were deferred."
  (funcall *call-releasing-interrupts* function))

;;; A deadline, unlike a time limit, interrupts only where a thread waits.

(deftype deadline-passed ()
  "The type of the condition signalled if a wait for a stream, lock or thread reaches its deadline."
  (internal-name :sb-sys '#:deadline-timeout))

(defmacro waiting-at-most ((seconds) &body body)
  "Run BODY. Signals DEADLINE-PASSED if BODY waits for something after SECONDS have passed."
  `(internal (:sb-sys #:with-deadline) (:seconds ,seconds) ,@body))

;;; Cleanup that always completes.

(declaim (inline call-allowing-interrupts-if))
(defun call-allowing-interrupts-if (open-p function)
  "Call FUNCTION, with interrupts allowed if OPEN-P is true."
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
        (unwind-protect (call-allowing-interrupts-if open-p first)
          (call-rest others))))))

;; UNWIND-PROTECT-STRICTLY is for little work that is done often; it allows no interrupts.
(defmacro in-any-case (&body forms)
  "Evaluate FORMS in order and return the values of the first. After a non-local exit from one,
still evaluate the others. Interrupts are deferred until the end, except in waits and users' code."
  (let ((names (loop for nil in forms collect (gensym "PART"))))
    `(flet ,(loop for name in names
                  for form in forms
                  collect `(,name () ,form))
       (declare (dynamic-extent ,@(loop for name in names collect `(function ,name))))
       (call-in-any-case ,@(loop for name in names collect `(function ,name))))))

(defun call-each (function list)
  "Call FUNCTION with each element of LIST in order, even after a non-local exit from a call."
  (unwind-protect (loop while list do (funcall function (pop list)))
    (when list (call-each function list))))

;;;; Time limits, and other conditions that are for callers

(deftype time-limit ()
  "The type of the condition signalled when a form such as WITH-TIMEOUT exceeds its time limit."
  'sb-ext:timeout)

;;; FiveAM signals failed checks and continues the test by the restart IGNORE-FAILURE. The caller of
;;; the test handles this, also where the check is in a plan.

(defun failed-test-check-p (condition)
  (and (typep condition 'error)
       (find "IGNORE-FAILURE" (compute-restarts condition)
             :key #'restart-name :test #'string=)
       t))

(defun signal-to-callers-first (condition)
  "If CONDITION is a time limit or a failed check of a test, signal it to the callers of the run
first. Return true if CONDITION is a time limit."
  (let ((limit-p (typep condition 'time-limit)))
    (when (or limit-p (failed-test-check-p condition)) (signal condition))
    limit-p))

(defun call-with-time-limit (function seconds give-up)
  "Call FUNCTION. Whenever SECONDS have passed and FUNCTION has not returned, call GIVE-UP in this
thread. GIVE-UP may make a non-local exit."
  ;; The timer may have interrupted this thread already when the call ends.
  (let* ((over nil)
         (timer (sb-ext:make-timer (lambda () (unless over (funcall give-up))))))
    (sb-ext:schedule-timer timer seconds :repeat-interval seconds)
    (unwind-protect (funcall function)
      (setf over t)
      (sb-ext:unschedule-timer timer))))

;;;; Signals from the system

(deftype user-interrupt ()
  "The type of the condition signalled when the user presses Ctrl-C."
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
  "Call FUNCTION, in an arbitrary thread, when the user presses Ctrl-C."
  (call-on-signal sb-posix:sigint function))

(defun call-on-continuing (function)
  "Call FUNCTION, in an arbitrary thread, when this process continues after a stop, as by Ctrl-Z."
  (call-on-signal sb-posix:sigcont function))

;;; In some states Lisp can no longer handle a signal, so the system itself ends the process. (It
;;; also does when the terminal closes, unless NOHUP is in effect.)

(defun end-on-interrupt ()
  "Make Ctrl-C end this process at once, for example while its memory is being saved."
  (handle-signal sb-posix:sigint :default))

(defun end-on-termination ()
  "Make SIGTERM and Ctrl-\\ end this process at once."
  (handle-signal sb-posix:sigterm :default)
  (handle-signal sb-posix:sigquit :default))
