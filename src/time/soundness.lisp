;;;; soundness.lisp -- an agenda and requests that were put together from a file.

(in-package :ars-magna.time)

(export '(fill-agenda check-occupant check-request))

(defun put-in-place (agenda event)
  "Make EVENT, whose slots say that it is pending, pending in AGENDA. Signals CONTRADICTION."
  (let ((resource (event-resource event)))
    (must-hold (and (event-pending-p event)
                    (< (agenda-tick agenda) (event-time event)
                       (+ (agenda-tick agenda) +longest-delay+ 2)))
               "~A does not wait for a tick to come" event)
    (must-hold (not (event-queued-p event)) "~A waits twice" event)
    (must-hold (or (null resource)
                   (eq (if (resource-p resource) event nil) (pending-event agenda resource)))
               "~A is not what its resource is busy with" event)
    (activate agenda event)
    (claim agenda event resource)
    (shelve agenda event)))

(defun fill-agenda (agenda tick events)
  "Set AGENDA, which is new, to TICK, with EVENTS, a list in the order of PENDING-EVENTS, waiting in
it. The slots of their resources must agree with that already. Signals CONTRADICTION."
  (must-hold (typep tick `(integer 0 ,(expt 10 15))) "~A is no tick" tick)
  (must-hold (proper-list-of-p #'event-p events) "what waits in the agenda are no events")
  (setf (agenda-tick agenda) tick)
  (dolist (event events) (put-in-place agenda event)))

(defun check-occupant (resource)
  "Signal CONTRADICTION unless what RESOURCE is busy with waits for its tick."
  (let ((event (resource-event resource)))
    (must-hold (or (null event)
                   (and (event-p event)
                        (event-queued-p event)
                        (eq resource (event-resource event))))
               "~A is busy with what does not wait" resource)))

(defgeneric check-request (request)
  (:documentation "Signal CONTRADICTION unless REQUEST, which was put together from a file, can be
performed. A layer that adds a kind of request adds a method.")
  (:method (request)
    (contradict "~A is nothing that could be asked for" (type-of request))))

(defmethod check-request ((grab grab))
  (must-hold (typep (request-arguments grab) '(cons t null)) "a resource to be taken is missing")
  (must-hold (eq 'grab (request-operator grab)) "a request does not say what it is"))
