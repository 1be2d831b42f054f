;;;; soundness.lisp -- checks of an agenda and requests that were loaded from a file.

(in-package :ars-magna.time)

(export '(fill-agenda check-pending-event check-request))

(defun restore-event (agenda event)
  "Enter EVENT into AGENDA. The slots of EVENT say that it is pending. Signals CONTRADICTION."
  (let ((resource (event-resource event)))
    (must-hold (and (event-pending-p event)
                    (< (agenda-tick agenda) (event-time event)
                       (+ (agenda-tick agenda) +longest-delay+ 2)))
               "~A does not wait for a future tick" event)
    (must-hold (not (event-queued-p event)) "~A waits twice" event)
    (must-hold (or (null resource)
                   (eq (if (resource-p resource) event nil) (pending-event agenda resource)))
               "~A is not the pending event of its resource" event)
    (mark-event-pending agenda event)
    (set-pending-event agenda event resource)
    (put-in-bucket agenda event)))

(defun fill-agenda (agenda tick events)
  "Set the new AGENDA to TICK, and enter EVENTS, a list in the order of PENDING-EVENTS. The
resources of EVENTS must already refer to them. Signals CONTRADICTION."
  (must-hold (typep tick `(integer 0 ,(expt 10 15))) "~A is not the number of a tick" tick)
  (must-hold (proper-list-of-p #'event-p events) "the agenda contains objects that are not events")
  (setf (agenda-tick agenda) tick)
  (dolist (event events) (restore-event agenda event)))

(defun check-pending-event (resource)
  "Signal CONTRADICTION unless the pending event of RESOURCE, if any, is in the agenda."
  (let ((event (resource-event resource)))
    (must-hold (or (null event)
                   (and (event-p event)
                        (event-queued-p event)
                        (eq resource (event-resource event))))
               "~A has a pending event that does not wait in the agenda" resource)))

(defgeneric check-request (request)
  (:documentation "Signal CONTRADICTION unless REQUEST, loaded from a file, can be performed. A
layer that adds a kind of request adds a method.")
  (:method (request)
    (signal-contradiction "~A is not a kind of request" (type-of request))))

(defmethod check-request ((grab grab))
  (must-hold (typep (request-arguments grab) '(cons t null)) "a resource to be taken is missing")
  (must-hold (eq 'grab (request-operator grab)) "a request has a wrong operator"))
