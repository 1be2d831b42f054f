;;;; interrupts.lisp -- where a thread may be interrupted; what is begun is finished all the same.

(in-package :ars-magna.host)

(export '(deferring-interrupts allowing-interrupts waiting held-off-p protecting-strictly
          call-allowing-interrupts call-holding-interrupts call-open-to-interrupts waiting-at-most
          deadline-passed in-any-case call-opening call-each))

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
