;;;; asking.lisp -- calling a function between two ticks of a world, from any thread.

(in-package :ars-magna.time)

(export '(ask-later call-in-run-of call-when-free-answering))

(defgeneric call-in-run-of (object function)
  (:documentation "Call FUNCTION, with the run of OBJECT as the current one if OBJECT has a run.")
  (:method (object function)
    (declare (ignore object))
    (funcall function)))

(addition ask)
(defun ask (object function)
  "Call FUNCTION, without arguments, while the world of OBJECT, a simulation or robot, stands still.
The run of OBJECT is the current one meanwhile, also for run variables and measures. If this thread
or no thread owns the world, call FUNCTION at once; else the owning thread calls FUNCTION between
two ticks. Return the values of FUNCTION. Errors of FUNCTION are signalled in this thread. If a time
limit ends the wait in this thread, FUNCTION goes on in the owning thread. Signals MISUSE inside a
tick of another world, and if FUNCTION is aborted."
  (let ((custody (timeline-custody (timeline-of object))))
    (flet ((answer () (call-in-run-of object function)))
      (call-with-custody custody #'answer (lambda () (ask-owner custody #'answer))))))

(addition asking)
(defmacro asking ((object) &body body)
  "Run BODY while the world of OBJECT, a simulation or robot, stands still, with its run as the
current one, as ASK calls a function. Return the values of BODY."
  `(ask ,object (lambda () ,@body)))

;;; Questions of other threads.

(defstruct (question (:constructor make-question (function)) (:copier nil))
  "A question: a function that another thread has sent to be called, and its result."
  (function nil :type function :read-only t)
  (answered (make-semaphore "answer") :type t :read-only t)
  (values '() :type list)
  (trouble nil :type t)
  ;; True if the asking thread no longer waits.
  (given-up-p nil :type t))

(defun note-question-trouble (question condition)
  (setf (question-trouble question)
        (if (typep condition 'serious-condition) condition :aborted)))

;; An answering user thread may itself have a time limit, which does not apply to the question.
(defun condition-for-asker-p (condition)
  "True if CONDITION, signalled while this thread answers a question, belongs to the asking thread."
  (or (own-thread-p) (not (typep condition 'time-limit))))

(defun compute-answer (question)
  (setf (question-trouble question) :aborted)
  (restart-case
      (handler-case
          (answering-debugger ((lambda (condition somebody-p)
                                 (unless somebody-p
                                   (note-question-trouble question condition)
                                   (throw 'no-answer nil))))
            (catch 'no-answer
              (setf (question-values question)
                    (multiple-value-list (as-users-code ("what another thread has asked for")
                                           (funcall (question-function question))))
                    (question-trouble question) nil)))
        ((and serious-condition (satisfies condition-for-asker-p)) (condition)
          (note-question-trouble question condition)))
    (abort () :report "Tell the asking thread that it was aborted.")))

(defun answer-question (question)
  (unless (question-given-up-p question)
    (in-any-case
      (compute-answer question)
      (signal-semaphore (question-answered question)))))

(defun answer-values (question)
  (let ((trouble (question-trouble question)))
    (cond ((null trouble) (values-list (question-values question)))
          ((eq trouble :aborted)
           (reject-use "The function called in the simulator's thread was aborted."))
          (t (error trouble)))))

(defun changing-in-tick-p ()
  "True if this thread is inside a tick of the current run and its world changes, phases 1 to 7."
  (and *simulation*
       (timeline-ticking-p (timeline-of *simulation*))
       (owner-p *simulation*)))

(defun check-outside-ticks ()
  "Signal MISUSE inside a tick, where a thread answers no questions and so must not ask any."
  (when (changing-in-tick-p)
    (reject-use "A tick of ~A is under way here. Another live world can be asked or changed only ~
                 between ticks, for example in a continuation."
                (timeline-name (timeline-of *simulation*)))))

(defun await-answer (question custody)
  (loop until (wait-while-answering (question-answered question))
        ;; The function may break in the owner's thread; only this thread may read the answer.
        do (serve-while-waiting *front-end*)
           (release-custody-if-dead custody)
           ;; If no thread owns the world any more, this one answers the pending questions.
           (call-with-custody custody (constantly nil) (constantly nil))))

(defun function-as-of-here (function)
  "Return a function that calls FUNCTION, in any thread, with the seclusion of the current code. If
forks repeat what the current code does, they repeat what FUNCTION does."
  (let ((seclusion *seclusion*) (by-itself-p (continues-in-forks-p)))
    (lambda ()
      (let ((*seclusion* seclusion) (*continues-in-forks-p* by-itself-p)) (funcall function)))))

(defun ask-owner (custody function)
  (check-outside-ticks)
  (let ((question (make-question (function-as-of-here function))))
    (leave-question custody (lambda () (answer-question question)))
    (wake-if-asleep custody)
    (in-any-case
      (await-answer question custody)
      (setf (question-given-up-p question) t))
    (answer-values question)))

(defun ask-later (object function)
  "Make the thread that owns the world of OBJECT call FUNCTION between two ticks, as by ASK, but do
not wait for the result. FUNCTION is called with interrupts deferred, except within
ALLOWING-INTERRUPTS. Return nothing."
  (let ((custody (timeline-custody (timeline-of object)))
        (question (make-question (function-as-of-here function))))
    (deferring-interrupts
      (leave-question custody (lambda () (deferring-interrupts (answer-question question))))
      ;; If this thread gets custody, it answers when it gives that up.
      (call-with-custody custody (constantly nil) (lambda () (wake-if-asleep custody))))
    (values)))

;;; Plans have a lock. The thread that holds it may ask the owner of the world, for example because
;;; a plan sets a run variable; and the owner may wait for the lock, for example to print plans.

(defun answer-holders ()
  "Answer the urgent questions about this thread's worlds. Signals MISUSE if there is one inside a
tick in phases 1 to 7, where no question can be answered."
  (if (changing-in-tick-p)
      (when (some #'urgent-question-p *held-custodies*)
        (allowing-interrupts
          (reject-use "The plans of ~A wait for the end of this tick, so code in the tick cannot ~
                       wait for the plans. Begin and look at plans between ticks, for example in ~
                       a continuation." (timeline-name (timeline-of *simulation*)))))
      (dolist (custody *held-custodies*)
        (when (has-custody-p custody) (answer-questions custody t)))))

(defun call-when-free-answering (lock function)
  "Wait until no other thread holds LOCK. Then call FUNCTION while holding LOCK, and return its
values. While this thread waits, it answers the urgent questions about its worlds. FUNCTION must
bind *URGENT-P* to true if it may ask."
  (call-when-free lock function #'answer-holders (if *held-custodies* 0.002 0.2)))
