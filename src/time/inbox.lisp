;;;; inbox.lisp -- how other threads, and user code, reach a simulation.

(in-package :ars-magna.time)

;;; POST leaves a function to be called at the start of the next tick and returns at once; it is
;;; how commands are issued, from wherever. ASK has a function called between two ticks by the
;;; owner and waits for its values; it is how others read or change a live world.

(defun wake (simulation)
  (when (simulation-asleep-p simulation)
    (signal-semaphore (simulation-wake-up simulation))))

(defun post (simulation function)
  "Have FUNCTION called, with no arguments, at the start of the next tick of SIMULATION, after
those posted before. Any thread may post. Return nothing. Signals MISUSE if the run is over."
  (check-not-over simulation)
  (sb-ext:atomic-push function (simulation-inbox simulation))
  ;; It may have ended just now, and its inbox may have been emptied for the last time.
  (when (and (simulation-over simulation) (withdraw simulation function))
    (check-not-over simulation))
  (wake simulation)
  (values))

(defun withdraw (simulation function)
  "Take FUNCTION out of the inbox of SIMULATION again. True unless somebody else has taken it."
  (loop for inbox = (simulation-inbox simulation)
        unless (member function inbox) return nil
        when (eq inbox (sb-ext:compare-and-swap (simulation-inbox simulation)
                                                inbox (remove function inbox)))
          return t))

(defun take-inbox (simulation)
  (loop for inbox = (simulation-inbox simulation)
        when (eq inbox (sb-ext:compare-and-swap (simulation-inbox simulation) inbox '()))
          return (reverse inbox)))

(defun open-inbox (simulation)
  (mapc #'funcall (take-inbox simulation)))

(defun owner-p (simulation)
  "True if the calling thread may touch the world of SIMULATION."
  (let ((thread (simulation-thread simulation)))
    (or (null thread) (eq thread (current-thread)))))

(defun answer-questions (simulation)
  (loop for questions = (simulation-questions simulation)
        while questions
        when (eq questions (sb-ext:compare-and-swap (simulation-questions simulation)
                                                    questions '()))
          do (mapc #'funcall (reverse questions))))

(addition ask)
(defun ask (simulation function)
  "Call FUNCTION, with no arguments, where the world of SIMULATION stands still: at once if this
thread owns it, else between two ticks in the thread that does. Return its values; what it
signals is signalled here."
  (if (owner-p simulation)
      (funcall function)
      (ask-thread simulation function)))

(defun ask-thread (simulation function)
  (let ((answered (make-semaphore "answer"))
        (values '())
        (trouble nil))
    (sb-ext:atomic-push
     (lambda ()
       (handler-case (setf values (multiple-value-list (funcall function)))
         (error (condition) (setf trouble condition)))
       (signal-semaphore answered))
     (simulation-questions simulation))
    (wake simulation)
    (loop until (wait-on-semaphore answered 0.2)
          ;; A clock that has stopped meanwhile leaves its questions to whoever waits.
          unless (simulation-thread simulation)
            do (answer-questions simulation))
    (if trouble (error trouble) (values-list values))))

(addition asking)
(defmacro asking ((simulation) &body body)
  "Run BODY as ASK would a function."
  `(ask ,simulation (lambda () ,@body)))

(defun change-from-outside (simulation function entry)
  "Call FUNCTION, which changes the world, as ASK would. If that happens between ticks, ENTRY
is noted in the journal; inside a tick it is the run's own doing."
  (if (and (owner-p simulation) (simulation-ticking-p simulation))
      (funcall function)
      (asking (simulation)
        (when (simulation-journal simulation)
          (apply #'note simulation entry))
        (funcall function))))
