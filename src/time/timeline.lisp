;;;; timeline.lisp -- the events of a run, what waits to be done in it, and who may do it.

(in-package :ars-magna.time)

;;; A timeline belongs to one thread at a time, its owner: the thread that paces it, or while none
;;; does, whoever passes its ticks. Others reach it in two ways. POST leaves a request, which is
;;; performed at the start of the next tick, and returns at once; it is how commands are issued,
;;; from wherever. ASK has a function called between two ticks by the owner and waits for its
;;; values; it is how others read or change what is live. A timeline that nobody runs yet keeps
;;; what was posted.

(define-kind (timeline :constructor (make-timeline (name)))
    "The events of a run, what was asked of it, and who owns it."
  (:fixed
   (name "" (or symbol string) "what the timeline is called, for messages"))
  (:state
   (agenda (make-agenda) agenda "the events that wait for their ticks" :part))
  ;; What is asked of a run is no part of its state before it is taken.
  (:scratch
   (inbox '() t "the requests that wait for the next tick, newest first")
   (notifications '() list "functions to call at the end of the tick, newest first"))
  (:link
   (ticking-p nil boolean "a tick is under way")
   (passing-p nil boolean "somebody passes ticks without a clock")
   (run nil t "the run that the timeline is of, NIL as long as there is none")
   (over nil (or null string) "why the run is over, a sentence without its full stop, or NIL")
   (questions '() t "what ASK has been called with, newest first")
   (thread nil t "the thread that paces the timeline, or NIL")
   (wake-up (make-semaphore "timeline") t "what that thread waits on while it sleeps")
   (asleep-p nil boolean "that thread sleeps")
   (lock (make-lock "timeline") t "held by whoever changes what no thread paces")
   (pacing nil t "how the timeline is paced, or NIL")))

(document-functions
  timeline-p "True of timelines."
  make-timeline "Return a timeline called NAME, at tick 0, without events and requests.")

(declaim (inline timeline-tick))
(defun timeline-tick (timeline)
  "Return how many ticks of TIMELINE have passed; inside a tick, its number."
  (agenda-tick (timeline-agenda timeline)))

(defmethod print-object ((timeline timeline) stream)
  (print-unreadable-object (timeline stream :type t)
    (format stream "~A at tick ~D" (timeline-name timeline) (timeline-tick timeline))))

(defgeneric timeline-of (object)
  (:documentation "Return the timeline of OBJECT: a run, a world with robots in it, a robot or a
part of one. A timeline is its own. Signals WRONG-ARGUMENT for what has none.")
  (:method ((timeline timeline)) timeline)
  (:method (object)
    (error 'wrong-argument :operator "ask" :name "simulation" :value object
                           :expected "a simulation, or a robot in one")))

(addition *simulation*)
(defvar *simulation* nil
  "The simulation that code runs for: the one of WITH-SIMULATION, of the thread, or the one last
given to SIMULATOR.")

(addition current-simulation)
(defun current-simulation ()
  "Return *SIMULATION*. Signals MISUSE when there is none."
  (or *simulation*
      (reject-use "There is no simulation here. Use (simulator ROBOT) or ~
                   (with-simulation (ROBOT) ...).")))

(defun check-not-over (object &optional operator)
  "Signal MISUSE, by OPERATOR if that is one that users call, if the run of OBJECT is over."
  (let ((timeline (timeline-of object)))
    (when (timeline-over timeline)
      (reject-use "~@[~(~A~): ~]The run in ~(~A~) is over, at tick ~D: ~A. (simulator ROBOT) ~
                   starts another."
                  operator (timeline-name timeline) (timeline-tick timeline)
                  (timeline-over timeline)))))

(defun wake-owner (timeline)
  "Wake the thread that paces TIMELINE if it sleeps: there may be something to do."
  (when (timeline-asleep-p timeline)
    (signal-semaphore (timeline-wake-up timeline))))

(defun owner-p (object)
  "True if the calling thread may touch what the timeline of OBJECT owns."
  (let ((thread (timeline-thread (timeline-of object))))
    (or (null thread) (eq thread (current-thread)))))

;;; Requests.

(defun post (request object)
  "Have REQUEST performed at the start of the next tick of the timeline of OBJECT, after those
posted before. Any thread may post. Return nothing. Signals MISUSE if the run is over.
See reading 219."
  (let ((timeline (timeline-of object)))
    (check-not-over timeline)
    (setf (request-asker request) (note-of-asker))
    (atomic-push request (timeline-inbox timeline))
    ;; It may have ended just now, and its inbox may have been emptied for the last time.
    (when (and (timeline-over timeline) (withdraw request timeline))
      (check-not-over timeline))
    (wake-owner timeline))
  (values))

(defun withdraw (request timeline)
  "Take REQUEST out of the inbox of TIMELINE again. True unless somebody else has taken it."
  (loop for inbox = (timeline-inbox timeline)
        unless (member request inbox) return nil
        when (swap-if (timeline-inbox timeline) inbox (remove request inbox))
          return t))

(defun take-requests (timeline)
  "Empty the inbox of TIMELINE; return its requests, oldest first."
  (loop for inbox = (timeline-inbox timeline)
        when (swap-if (timeline-inbox timeline) inbox '())
          return (reverse inbox)))

(defun put-back (requests timeline)
  "Leave REQUESTS, oldest first, for the next tick of TIMELINE, before those posted meanwhile."
  (let ((newest-first (reverse requests)))
    (loop for inbox = (timeline-inbox timeline)
          until (swap-if (timeline-inbox timeline) inbox (append inbox newest-first)))))

;;; Questions.

(defun answer-questions (timeline)
  "Answer what others have asked of TIMELINE. Called by its owner between ticks."
  (loop for questions = (timeline-questions timeline)
        while questions
        when (swap-if (timeline-questions timeline) questions '())
          do (mapc #'funcall (reverse questions))))

(addition ask)
(defun ask (object function)
  "Call FUNCTION, with no arguments, where the world of OBJECT, a simulation or robot, stands still:
at once if this thread owns it, else between two ticks in the thread that does. Return its values;
what it signals is signalled here."
  (let ((timeline (timeline-of object)))
    (if (owner-p timeline)
        (funcall function)
        (ask-thread timeline function))))

(defun ask-thread (timeline function)
  (let ((answered (make-semaphore "answer"))
        (values '())
        (trouble nil))
    (atomic-push
     (lambda ()
       (handler-case (setf values (multiple-value-list (funcall function)))
         (error (condition) (setf trouble condition)))
       (signal-semaphore answered))
     (timeline-questions timeline))
    (wake-owner timeline)
    (loop until (wait-on-semaphore answered 0.2)
          ;; A clock that has stopped meanwhile leaves its questions to whoever waits.
          unless (timeline-thread timeline)
            do (answer-questions timeline))
    (if trouble (error trouble) (values-list values))))

(addition asking)
(defmacro asking ((object) &body body)
  "Run BODY as ASK would a function."
  `(ask ,object (lambda () ,@body)))

;;; Notifications.

(defun notify-later (timeline function)
  "Call FUNCTION at the end of this tick, after those already to be called then."
  (push function (timeline-notifications timeline)))

(defun deliver-notifications (timeline)
  "Call what is to be called at the end of this tick, in order."
  (loop while (timeline-notifications timeline)
        do (mapc #'funcall (reverse (shiftf (timeline-notifications timeline) '())))))
