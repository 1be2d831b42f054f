;;;; schedule.lisp -- the manual's access to the scheduler (3.8).

(in-package :ars-magna.time)

;;; Events of SCHEDULE meet on a resource by priority: the higher stays, of equals the one that
;;; was there. Whichever loses is interrupted. Commands do not go this way, they take over.

(defun conditional (agenda function test deadline)
  "Return an event function that calls FUNCTION in the first tick in which TEST is true, and
gives up after the tick DEADLINE (NIL: never)."
  (lambda (event)
    (cond ((call-user-code test "a scheduled event's :when") (funcall function event))
          ((and deadline (>= (agenda-tick agenda) deadline)))
          (t (queue-again agenda event 1)))))

(defun lose (interrupt)
  (when interrupt (call-user-code interrupt "an event's interrupt handler")))

(defun enter (simulation function resource priority interrupt test timeout timer)
  (let* ((agenda (simulation-agenda simulation))
         (rival (and resource (pending-event agenda resource))))
    (cond ((and rival (>= (event-priority rival) priority)) (lose interrupt))
          (t (when rival (interrupt-event agenda rival))
             (queue-event agenda timer
                          (if test
                              (conditional agenda function test
                                           (and timeout (+ (agenda-tick agenda) timeout)))
                              function)
                          :resource resource :priority priority :interrupt interrupt)))))

(defun call-scheduled (function resource
                       &key (priority 0) interrupt when timeout (timer 1)
                            (simulation (current-simulation)))
  "Queue an event that calls FUNCTION. See SCHEDULE, of which this is the function. Returns
nothing. Signals WRONG-ARGUMENT for a priority, timer or timeout that is not an integer."
  (check-argument schedule priority (typep priority 'fixnum) "an integer")
  (check-argument schedule timer (typep timer '(integer 0)) "a number of ticks, 0 or more")
  (check-argument schedule timeout (typep timeout '(or null (integer 0))) "a number of ticks")
  (flet ((run (event)
           (declare (ignore event))
           (call-user-code function "a scheduled event")))
    (let ((enter (lambda ()
                   (enter simulation #'run resource priority interrupt when timeout timer))))
      (if (and (owner-p simulation) (simulation-ticking-p simulation))
          (funcall enter)
          (asking (simulation)
            (when (simulation-journal simulation)
              (note simulation :schedule enter))
            (funcall enter)))))
  (values))

(public schedule)
(defmacro schedule ((resource &key priority interrupt (when t when-p) timeout timer)
                    &body body)
  "Queue an event that runs BODY on RESOURCE (NIL: none) in the next tick, or TIMER ticks from
now. On a resource that has an event, the one with the higher :PRIORITY (an integer, default 0)
stays, of equal ones the first; the form INTERRUPT is evaluated if this event loses. With the
form WHEN, the event happens in the first tick from then on in which WHEN is true, at most
TIMEOUT ticks from now; then it evaporates. Both forms, like BODY, run inside ticks. Returns
nothing (manual 3.8)."
  `(call-scheduled (lambda () ,@body) ,resource
                   :priority ,(or priority 0)
                   :timer ,(or timer 1)
                   ,@(when timeout `(:timeout ,timeout))
                   ,@(when interrupt `(:interrupt (lambda () ,interrupt)))
                   ,@(when when-p `(:when (lambda () ,when)))))

(defgeneric release-resource (resource simulation)
  (:documentation
   "Interrupt whatever is pending on RESOURCE, or goes on in the background of it. Called inside
a tick, by the owner. A layer that adds background activities adds a method.")
  (:method (resource simulation)
    (let* ((agenda (simulation-agenda simulation))
           (event (pending-event agenda resource)))
      (when event (interrupt-event agenda event)))))

(public grab-resource)
(defun grab-resource (resource &optional (simulation (current-simulation)))
  "Interrupt the command or event that occupies RESOURCE, and a track that it keeps, at the
start of the next tick. Returns nothing (manual, figure D.3)."
  (post simulation (lambda ()
                     (note simulation :grab resource)
                     (release-resource resource simulation))))

(defun abandon (simulation resources)
  "Interrupt all that occupies RESOURCES, in order, and let those know who asked for it. Called by
the owner of SIMULATION, between ticks."
  (dolist (resource resources) (release-resource resource simulation))
  (deliver-notifications simulation))

(defmethod apply-entry ((operation (eql :schedule)) arguments simulation)
  (declare (ignore simulation))
  (funcall (first arguments)))

(defmethod apply-entry ((operation (eql :grab)) arguments simulation)
  (grab-resource (first arguments) simulation))
