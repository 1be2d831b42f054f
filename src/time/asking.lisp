;;;; asking.lisp -- having something done where a world stands still.

(in-package :ars-magna.time)

(export '(have-done))

(addition ask)
(defun ask (object function)
  "Call FUNCTION, without arguments, while the world of OBJECT, a simulation or robot, stands still.
If this thread owns the world or no thread does, call it at once; else the owning thread calls it
between two ticks. Return its values; its errors are signalled here. Signals MISUSE inside a tick of
another world, and if FUNCTION is aborted."
  (let ((custody (timeline-custody (timeline-of object))))
    (call-with-custody custody function (lambda () (ask-holder custody function)))))

(addition asking)
(defmacro asking ((object) &body body)
  "Run BODY as ASK would a function."
  `(ask ,object (lambda () ,@body)))

;;; Of another thread.

(defstruct (question (:constructor make-question (function)) (:copier nil))
  "A question of another thread, and the answer."
  (function nil :type function :read-only t)
  (answered (make-semaphore "answer") :type t :read-only t)
  (values '() :type list)
  (trouble nil :type t)
  ;; The asking thread has left.
  (given-up-p nil :type t))

(defun note-trouble (question condition)
  (setf (question-trouble question)
        (if (typep condition 'serious-condition) condition :aborted)))

;; The answering user thread may itself be under a time limit, which must not apply to the question.
(defun for-asker-p (condition)
  "True if CONDITION, signalled while this thread answers a question, belongs to the asking thread."
  (or (own-thread-p) (not (typep condition 'time-limit))))

(defun call-for-other (question)
  (setf (question-trouble question) :aborted)
  (restart-case
      (handler-case
          (answering-debugger ((lambda (condition somebody-p)
                                 (unless somebody-p
                                   (note-trouble question condition)
                                   (throw 'no-answer nil))))
            (catch 'no-answer
              (setf (question-values question)
                    (multiple-value-list (as-users-code ("what another thread has asked for")
                                           (funcall (question-function question))))
                    (question-trouble question) nil)))
        ((and serious-condition (satisfies for-asker-p)) (condition)
          (note-trouble question condition)))
    (abort () :report "Tell who asked that it was aborted.")))

(defun answer (question)
  (unless (question-given-up-p question)
    (in-any-case
      (call-for-other question)
      (signal-semaphore (question-answered question)))))

(defun result-of (question)
  (let ((trouble (question-trouble question)))
    (cond ((null trouble) (values-list (question-values question)))
          ((eq trouble :aborted)
           (reject-use "What was to be done in the simulator's thread was aborted."))
          (t (error trouble)))))

(defun check-outside-ticks ()
  "Signal MISUSE inside a tick: a thread in a tick answers no questions, so it may ask none."
  (when (and *simulation* (timeline-ticking-p (timeline-of *simulation*))
             (owner-p *simulation*))
    (reject-use "A tick of ~A is under way here. Another world that is live can be asked or ~
                 changed between ticks, as in a continuation."
                (timeline-name (timeline-of *simulation*)))))

(defun await-answer (question custody)
  (loop until (wait-for-other (question-answered question))
        do (release-if-dead custody)
           ;; A thread that gives up the world leaves pending questions to a waiting thread.
           (call-with-custody custody (constantly nil) (constantly nil))))

(defun keeping-seclusion (function)
  "Return a function that calls FUNCTION as secluded as this code is, in whichever thread."
  (let ((seclusion *seclusion*))
    (lambda () (let ((*seclusion* seclusion)) (funcall function)))))

(defun ask-holder (custody function)
  (check-outside-ticks)
  (let ((question (make-question (keeping-seclusion function))))
    (atomic-push (lambda () (answer question)) (custody-questions custody))
    (wake-holder custody)
    (in-any-case
      (await-answer question custody)
      (setf (question-given-up-p question) t))
    (result-of question)))

(defun have-done (object function)
  "Have FUNCTION called where the world of OBJECT stands still, as ASK does, but do not wait for
that. Interrupts wait, but for the extent of ALLOWING-INTERRUPTS. Return nothing."
  (let ((custody (timeline-custody (timeline-of object)))
        (question (make-question (keeping-seclusion function))))
    (deferring-interrupts
      (atomic-push (lambda () (deferring-interrupts (answer question)))
                   (custody-questions custody))
      ;; A thread that has custody answers before it gives that up.
      (call-with-custody custody (constantly nil) (lambda () (wake-holder custody))))
    (values)))
