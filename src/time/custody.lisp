;;;; custody.lisp -- which thread may touch a world, and how others have it do so.

(in-package :ars-magna.time)

(export '(answer-questions call-with-custody mine-p answer-meanwhile))

;;; A world, with the timelines of its runs, which follow one another, is in the custody of one
;;; thread at a time: the one that paces it, or one that passes its ticks or changes it, for as long
;;; as that takes. Custody is taken if nobody has it, and given up; it may be handed over to another
;;; thread meanwhile. Who does not get it leaves a question, a function, which the thread that has
;;; it calls between two ticks, or before it gives custody up.

(define-record (custody (:constructor make-custody ()))
  "Which thread may touch a world."
  (thread nil t :writable)
  (questions '() t
             "what others have asked those who have the custody, newest first" :writable :export)
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
  "Let this thread have CUSTODY, if nobody has it. True if so."
  (swap-if (custody-thread custody) nil (current-thread)))

(defun answer-questions (custody)
  "Call what others have asked those who have CUSTODY to call, in order."
  (loop for questions = (custody-questions custody)
        while questions
        when (swap-if (custody-questions custody) questions '())
          do (call-each #'funcall (reverse questions))))

(defun give-up-custody (custody)
  "Let others have CUSTODY. Whatever has been asked is answered before."
  (in-any-case
    (when (mine-p custody) (answer-questions custody))
    (swap-if (custody-thread custody) (current-thread) nil)
    (progn (memory-barrier)
           ;; Somebody may have asked just now.
           (when (and (custody-questions custody) (take-custody custody))
             (give-up-custody custody)))))

(defun call-with-custody (custody function otherwise)
  "Call FUNCTION with CUSTODY, OTHERWISE if another thread has it. Return the values. These can be
interrupted if this thread could before."
  (if (mine-p custody)
      (funcall function)
      (let ((open-p (not (held-off-p))))
        (deferring-interrupts
          (if (take-custody custody)
              (let* ((held (cons custody *held*)) (*held* held))
                (declare (dynamic-extent held))
                (in-any-case
                  (call-opening open-p function)
                  (give-up-custody custody)))
              (call-opening open-p otherwise))))))

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
  ;; Who has a world in custody must look often who asks for that.
  (wait-on-semaphore semaphore (if *held* (min seconds 0.002) seconds)))
