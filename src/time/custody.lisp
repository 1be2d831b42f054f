;;;; custody.lisp -- which thread owns a world, and how other threads send it functions to call.

(in-package :ars-magna.time)

(export '(answer-questions call-with-custody has-custody-p answer-own-questions leave-question
          *urgent-p*))

;;; One thread at a time owns a world and the timelines of its runs: it has custody. It paces the
;;; world, or has custody while it passes ticks or changes it. A thread takes custody if no other
;;; has it, and gives it up or hands it over to another. A thread that cannot get custody leaves a
;;; question, a function that the owner calls between two ticks or before it gives custody up.

(define-record (custody (:constructor make-custody ()))
  "The record of the thread that owns a world."
  (thread nil t :writable)
  (questions '() t "questions of other threads to the owner, newest first: conses of a function and
whether it is urgent" :writable :export)
  (wake-up (make-semaphore "custody") t)
  (asleep-p nil t :writable)
  (pacing nil t "the pacing by which the owner passes ticks, or NIL if it does not pace the world"
                :writable)
  (starter nil t "the thread that is starting the world, or NIL. Can be set" :writable :export))

(defvar *held-custodies* '()
  "The list of custodies that this thread has taken and not given up.")

(declaim (inline has-custody-p))
(defun has-custody-p (custody)
  "True if this thread has CUSTODY."
  (eq (custody-thread custody) (current-thread)))

(defun take-custody (custody)
  "Take CUSTODY for this thread, if no thread has it. Return true if this thread has taken it."
  (swap-if-eq (custody-thread custody) nil (current-thread)))

(defvar *urgent-p* nil
  "True if this thread holds something that owners of worlds may wait for, such as plans. Then its
questions are urgent: an owner that waits for such a thing answers them meanwhile.")

(defun leave-question (custody function)
  "Leave FUNCTION, without arguments, for the owner of CUSTODY to call."
  (atomic-push (cons function *urgent-p*) (custody-questions custody)))

(defun urgent-question-p (custody)
  (find-if #'cdr (custody-questions custody)))

(defun take-question (custody urgent-p)
  "Remove the oldest question left for the owner of CUSTODY, an urgent one if URGENT-P is true, and
return its function; NIL if there is none."
  (loop for questions = (custody-questions custody)
        for question = (find-if (if urgent-p #'cdr #'car) questions :from-end t)
        while question
        when (swap-if-eq (custody-questions custody) questions
                         (remove question questions :test #'eq))
          return (car question)))

;; One at a time: a function may wait for a thread whose question is left, and then answers that.
(defun answer-questions (custody &optional urgent-p)
  "Call the functions that other threads have left for the owner of CUSTODY, in order; only the
urgent ones if URGENT-P is true."
  (loop for function = (take-question custody urgent-p)
        while function
        do (funcall function)))

(defun give-up-custody (custody)
  "Give up CUSTODY, after answering pending questions."
  (in-any-case
    (when (has-custody-p custody) (answer-questions custody))
    (swap-if-eq (custody-thread custody) (current-thread) nil)
    (progn (memory-barrier)
           ;; A question may have come just now.
           (when (and (custody-questions custody) (take-custody custody))
             (give-up-custody custody)))))

(defun call-with-custody (custody function otherwise)
  "Take CUSTODY and call FUNCTION. If another thread has CUSTODY, call OTHERWISE instead. Return the
values of the call. FUNCTION and OTHERWISE are interruptible if this thread was before."
  (if (has-custody-p custody)
      (funcall function)
      (let ((open-p (not (interrupts-deferred-p))))
        (deferring-interrupts
          (if (take-custody custody)
              (let* ((held (cons custody *held-custodies*)) (*held-custodies* held))
                (declare (dynamic-extent held))
                (in-any-case
                  (call-allowing-interrupts-if open-p function)
                  (give-up-custody custody)))
              (call-allowing-interrupts-if open-p otherwise))))))

(defun hand-over-custody (custody thread)
  (setf (custody-thread custody) thread))

;;; Waiting.

(defun wake-if-asleep (custody)
  (when (custody-asleep-p custody)
    (signal-semaphore (custody-wake-up custody))))

(defun release-custody-if-dead (custody)
  (let ((thread (custody-thread custody)))
    (when (and thread (not (thread-alive-p thread)))
      (swap-if-eq (custody-thread custody) thread nil))))

(defun answer-own-questions ()
  "Answer the questions about this thread's worlds, so that waiting threads do not deadlock."
  (dolist (custody *held-custodies*)
    (when (has-custody-p custody) (answer-questions custody))))

(defun wait-while-answering (semaphore &optional (seconds 0.2))
  "Answer questions, then wait at most SECONDS for SEMAPHORE. Return true if it was signalled."
  (answer-own-questions)
  (yield-foreground)
  ;; A thread that owns a world must check for questions often.
  (wait-on-semaphore semaphore (if *held-custodies* (min seconds 0.002) seconds)))
