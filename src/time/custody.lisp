;;;; custody.lisp -- which thread may touch a world, and how others have it do so.

(in-package :ars-magna.time)

(export '(answer-questions call-with-custody mine-p answer-meanwhile))

;;; A world and the successive timelines of its runs are in the custody of one thread at a time: the
;;; one that paces the world, or one that passes ticks or changes the world, while it does. A thread
;;; takes custody if no other has it, and gives it up; it may hand it over to another thread. A
;;; thread that cannot get custody leaves a question, a function. The thread in custody calls that
;;; between two ticks, or before it gives custody up.

(define-record (custody (:constructor make-custody ()))
  "Which thread may touch a world."
  (thread nil t :writable)
  (questions '() t
             "questions of other threads to the one in custody, newest first" :writable :export)
  (wake-up (make-semaphore "custody") t)
  (asleep-p nil t :writable)
  (pacing nil t "how the thread that has it paces the world, or NIL if it does not" :writable)
  (starter nil t "the thread that is starting the world, or NIL. Can be set" :writable :export))

(defvar *held* '()
  "The custodies that this thread has and has not handed over.")

(declaim (inline mine-p))
(defun mine-p (custody)
  "True if this thread has CUSTODY."
  (eq (custody-thread custody) (current-thread)))

(defun take-custody (custody)
  "Take CUSTODY for this thread, if no other has it. True if it was taken."
  (swap-if (custody-thread custody) nil (current-thread)))

(defun answer-questions (custody)
  "Call the functions that other threads have left for CUSTODY, in order."
  (loop for questions = (custody-questions custody)
        while questions
        when (swap-if (custody-questions custody) questions '())
          do (call-each #'funcall (reverse questions))))

(defun give-up-custody (custody)
  "Give CUSTODY up. Pending questions are answered first."
  (in-any-case
    (when (mine-p custody) (answer-questions custody))
    (swap-if (custody-thread custody) (current-thread) nil)
    (progn (memory-barrier)
           ;; A question may have come just now.
           (when (and (custody-questions custody) (take-custody custody))
             (give-up-custody custody)))))

(defun call-with-custody (custody function otherwise)
  "Call FUNCTION with CUSTODY, OTHERWISE if another thread has it. Return the values. These can be
interrupted if this thread could before."
  (if (mine-p custody)
      (funcall function)
      (let ((open-p (not (interrupts-deferred-p))))
        (deferring-interrupts
          (if (take-custody custody)
              (let* ((held (cons custody *held*)) (*held* held))
                (declare (dynamic-extent held))
                (in-any-case
                  (call-interruptible open-p function)
                  (give-up-custody custody)))
              (call-interruptible open-p otherwise))))))

(defun hand-over (custody thread)
  (setf (custody-thread custody) thread))

;;; Waiting.

(defun wake-holder (custody)
  "Wake the thread that has CUSTODY if it sleeps: there may be something to do."
  (when (custody-asleep-p custody)
    (signal-semaphore (custody-wake-up custody))))

(defun release-if-dead (custody)
  "Take CUSTODY from a thread that has ended without giving it up."
  (let ((thread (custody-thread custody)))
    (when (and thread (not (thread-alive-p thread)))
      (swap-if (custody-thread custody) thread nil))))

(defun answer-meanwhile ()
  "Answer what others have asked of the worlds that this thread has in custody: they may be waiting
for it while it waits for them."
  (dolist (custody *held*)
    (when (mine-p custody) (answer-questions custody))))

(defun wait-for-other (semaphore &optional (seconds 0.2))
  "Wait for SEMAPHORE for a moment, of SECONDS at most. True if it came."
  (answer-meanwhile)
  (yield-foreground)
  ;; A thread in custody must check for questions often.
  (wait-on-semaphore semaphore (if *held* (min seconds 0.002) seconds)))
