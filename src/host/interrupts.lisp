;;;; interrupts.lisp -- where a thread may be interrupted from outside.

(in-package :ars-magna.host)

;;; Tried with SBCL 2.2.9, 2.5.2 and 2.6.4.

;;; What interrupts a thread is a time limit, Ctrl-C, another thread, or that it is to end. It may
;;; leave what it interrupts. Where that would lock others out for ever, it waits for a moment. Not
;;; for longer, though: SBCL's runtime dies if a timer strikes while memory is collected in a thread
;;; that holds interrupts off.

(defmacro deferring-interrupts (&body body)
  "Run BODY. What interrupts this thread waits, but for the extent of ALLOWING-INTERRUPTS."
  `(internal (:sb-sys #:without-interrupts)
     (internal (:sb-sys #:allow-with-interrupts) ,@body)))

(defmacro allowing-interrupts (&body body)
  "Run BODY, in which this thread can be interrupted."
  `(internal (:sb-sys #:with-interrupts) ,@body))

;;; A deadline, unlike a time limit, interrupts only where a thread waits.

(deftype deadline-passed ()
  "The condition that a thread still waits for a stream, lock or other thread at its deadline."
  (internal-name :sb-sys '#:deadline-timeout))

(defmacro with-deadline ((seconds) &body body)
  "Run BODY. Signals DEADLINE-PASSED if it waits for something when SECONDS have passed."
  `(internal (:sb-sys #:with-deadline) (:seconds ,seconds) ,@body))

;;; Interrupts held off for functions, strictly: what is called in between cannot let any in.

(defvar *open-to-interrupts* #'funcall
  "A function that calls another, in which this thread takes interrupts.")

(defun call-holding-interrupts (function)
  "Call FUNCTION. Until it returns, interrupts wait, but in what CALL-OPEN-TO-INTERRUPTS calls."
  (internal (:sb-sys #:without-interrupts)
    (let ((*open-to-interrupts* (lambda (function)
                                  (internal (:sb-sys #:with-local-interrupts)
                                    (funcall function)))))
      (funcall function))))

(defun call-open-to-interrupts (function)
  "Call FUNCTION, in which this thread takes interrupts, those too that wait."
  (funcall *open-to-interrupts* function))
