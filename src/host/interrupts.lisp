;;;; interrupts.lisp -- when a thread is interrupted, and by what; how what is begun is finished.

(in-package :ars-magna.host)

(export '(deferring-interrupts allowing-interrupts waiting held-off-p protecting-strictly
          call-holding-interrupts call-open-to-interrupts waiting-at-most deadline-passed
          in-any-case call-opening call-each time-limit let-callers-handle call-with-limit
          user-interrupt signal-user-interrupt call-on-interrupt call-on-continuing
          die-of-interrupts die-of-termination))

;;; What interrupts a thread is a time limit, Ctrl-C, another thread, or that it is to end. It may
;;; leave what it interrupts. Where that would lock others out for ever, it waits for a moment.

;;; SBCL's own way to hold interrupts off and still let them in where something waits is of no use:
;;; its runtime dies if one comes while memory is collected in a thread that does so
;;; (WITHOUT-INTERRUPTS with ALLOW-WITH-INTERRUPTS in it); and each lock that is taken lets them in.
;;; So they are held off strictly, and where they are let in, a function is called that was made
;;; outside.

(defvar *holding* nil
  "What holds off the interrupts of this thread: NIL if nothing does, :STRICTLY, or a function of
another that calls that, open to interrupts, or if its second argument is true open to them where
SBCL waits.")

(declaim (inline held-off-p))
(defun held-off-p ()
  "True if interrupts of this thread are held off here."
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

(defun call-waiting (function)
  (let ((holding *holding*))
    (if (functionp holding)
        (funcall holding function t)
        (funcall function))))

(defmacro deferring-interrupts (&body body)
  "Run BODY. What interrupts this thread waits, but for the extents of ALLOWING-INTERRUPTS and
WAITING."
  (form-calling 'call-deferring-interrupts body))

(defmacro allowing-interrupts (&body body)
  "Run BODY, in which this thread can be interrupted."
  (form-calling 'call-allowing-interrupts body))

(defmacro waiting (&body body)
  "Run BODY, which waits for a semaphore, and can be interrupted while it does."
  (form-calling 'call-waiting body))

;; SBCL lets interrupts in where a protected form has just ended; what is to follow would be
;; skipped.
(defmacro protecting-strictly (form &body cleanup)
  "Do what UNWIND-PROTECT does; but no interrupt comes between FORM, in which it comes as outside,
and CLEANUP, nor in that."
  `(internal (:sb-sys #:without-interrupts)
     (unwind-protect (internal (:sb-sys #:with-local-interrupts) ,form)
       ,@cleanup)))

;;; Interrupts held off for functions, strictly: what is called in between cannot let any in.

(defvar *open-to-interrupts* #'funcall
  "A function that calls another, in which this thread takes interrupts.")

(defun call-holding-interrupts (function)
  "Call FUNCTION. Until it returns, interrupts wait, but in what CALL-OPEN-TO-INTERRUPTS calls."
  (internal (:sb-sys #:without-interrupts)
    (let* ((holding *holding*)
           (*open-to-interrupts* (lambda (function)
                                   (let ((*holding* holding))
                                     (internal (:sb-sys #:with-local-interrupts)
                                       (funcall function)))))
           (*holding* :strictly))
      (funcall function))))

(defun call-open-to-interrupts (function)
  "Call FUNCTION, in which this thread takes interrupts, those too that wait."
  (funcall *open-to-interrupts* function))

;;; A deadline, unlike a time limit, interrupts only where a thread waits.

(deftype deadline-passed ()
  "The condition that a thread still waits for a stream, lock or other thread at its deadline."
  (internal-name :sb-sys '#:deadline-timeout))

(defmacro waiting-at-most ((seconds) &body body)
  "Run BODY; signal DEADLINE-PASSED where it still waits for something after SECONDS."
  `(internal (:sb-sys #:with-deadline) (:seconds ,seconds) ,@body))

;;; What has been begun is finished, however that is left.

(declaim (inline call-opening))
(defun call-opening (open-p function)
  "Call FUNCTION, in which this thread can be interrupted if OPEN-P."
  (if open-p
      (call-allowing-interrupts function)
      (funcall (the function function))))

(defun call-in-any-case (first &rest others)
  (declare (dynamic-extent others))
  (let ((open-p (not (held-off-p))))
    (labels ((call-rest (functions)
               (when functions
                 (unwind-protect (funcall (the function (first functions)))
                   (call-rest (rest functions))))))
      (deferring-interrupts
        (unwind-protect (call-opening open-p first)
          (call-rest others))))))

;; See PROTECTING-STRICTLY. That is for little work that is done often, and lets nothing in.
(defmacro in-any-case (&body forms)
  "Run FORMS in order, those that follow also if one is left, as by THROW; interrupts of this thread
wait for the end of these, but at waits and in users' code. Return the values of the first."
  (let ((names (loop for nil in forms collect (gensym "PART"))))
    `(flet ,(loop for name in names
                  for form in forms
                  collect `(,name () ,form))
       (declare (dynamic-extent ,@(loop for name in names collect `(function ,name))))
       (call-in-any-case ,@(loop for name in names collect `(function ,name))))))

(defun call-each (function list)
  "Call FUNCTION with each element of LIST in order, with the rest also if a call is left."
  (unwind-protect (loop while list do (funcall function (pop list)))
    (when list (call-each function list))))

;;;; Time limits, and other conditions that are for callers

(deftype time-limit ()
  "The condition that is signalled when the time for a form is up, as by WITH-TIMEOUT."
  'sb-ext:timeout)

;;; FiveAM signals that a check has failed, and its restart IGNORE-FAILURE lets the test go on after
;;; it has counted that. Whoever runs the test handles this, also where the check is in a plan.

(defun failed-check-p (condition)
  (and (typep condition 'error)
       (find "IGNORE-FAILURE" (compute-restarts condition)
             :key #'restart-name :test #'string=)
       t))

(defun let-callers-handle (condition)
  "Let those who have called the run handle CONDITION first, if it is for them. True if it is a
limit to their time."
  (let ((limit-p (typep condition 'time-limit)))
    (when (or limit-p (failed-check-p condition)) (signal condition))
    limit-p))

(defun call-with-limit (function seconds give-up)
  "Call FUNCTION. Should it not have returned after SECONDS, call GIVE-UP in this thread, which may
leave it; and so again and again."
  (let ((timer (sb-ext:make-timer give-up)))
    (sb-ext:schedule-timer timer seconds :repeat-interval seconds)
    (unwind-protect (funcall function)
      (sb-ext:unschedule-timer timer))))

;;;; Signals from the system

(deftype user-interrupt ()
  "The condition that the user has pressed control C."
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
  "Call FUNCTION, in any thread, whenever control C is pressed."
  (call-on-signal sb-posix:sigint function))

(defun call-on-continuing (function)
  "Call FUNCTION, in any thread, whenever this process goes on that was stopped, as by control Z."
  (call-on-signal sb-posix:sigcont function))

;;; There are states in which no Lisp runs any more that would handle a signal, so the system itself
;;; ends the process. (With a terminal that goes away it does so anyway, unless it was told NOHUP.)

(defun die-of-interrupts ()
  "Let control C end this process at once, as when its memory is being saved."
  (handle-signal sb-posix:sigint :default))

(defun die-of-termination ()
  "Let this process end at once when it is told to terminate, as by control \\."
  (handle-signal sb-posix:sigterm :default)
  (handle-signal sb-posix:sigquit :default))
